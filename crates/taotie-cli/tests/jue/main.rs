//! The demo's bronze vessel: baked at a million triangles, poured, polished.
#![allow(clippy::print_stdout, reason = "tests print their findings")]

mod bake;
mod moving;
mod specular_aa;
