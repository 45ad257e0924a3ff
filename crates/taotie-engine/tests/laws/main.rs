//! Laws that hold for all values: reciprocity, energy, normalisation, derivatives, frames.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print their findings")]

#[path = "../../../../tests/common/angle.rs"]
mod angle;
#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/files.rs"]
mod files;
#[path = "../../../../tests/common/random.rs"]
mod random;
#[path = "../../../../tests/common/skies.rs"]
mod skies;

mod energy;
mod environment;
mod error_maps;
mod exact;
mod facets;
mod film;
mod gradients;
mod lane;
mod map_errors;
mod maps;
mod noise;
mod pixel_gradients;
mod ray_device;
mod rays;
mod remesh;
mod sampling;
mod shade;
mod surface;
