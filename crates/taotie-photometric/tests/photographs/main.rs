//! The whole way from photographs to normals: accuracy on generated photographs, and files that are wrong.
#![allow(clippy::print_stdout)]

mod accuracy;
mod balls;
mod lights;
mod malformed;
mod materials;
mod plane;
mod relight;
mod speed;
mod studio;
