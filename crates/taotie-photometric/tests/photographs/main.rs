//! The whole way from photographs to normals: accuracy on generated photographs, and files that are wrong.

mod accuracy;
mod studio;
