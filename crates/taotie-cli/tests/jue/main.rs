//! The demo's bronze vessel: baked at a million triangles, poured, polished.
#![allow(clippy::print_stdout, reason = "tests say what they found")]

mod bake;
mod moving;
mod specular_aa;
