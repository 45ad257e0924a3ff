//! Laws that hold for all values: reciprocity, energy, normalisation, frames, preservation by a bake.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print their findings")]

#[path = "../common/angle.rs"]
mod angle;
#[path = "../common/cart.rs"]
mod cart;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/distance.rs"]
mod distance;
#[path = "../common/files.rs"]
mod files;
#[path = "../common/hostile.rs"]
mod hostile;
#[path = "../common/modelled.rs"]
mod modelled;
#[path = "../common/random.rs"]
mod random;
#[path = "../common/skies.rs"]
mod skies;

mod bake;
mod bake_alpha;
mod bake_color;
mod bake_material;
mod bake_scan;
mod coarse;
mod energy;
mod environment;
mod error_maps;
mod exact;
mod facets;
mod figures;
mod film;
mod fooled;
mod gradients;
mod known_distances;
mod lane;
mod levels;
mod low_faults;
mod made_meshes;
mod maps;
mod mismatches;
mod names;
mod pairs;
mod pixel_gradients;
mod rays;
mod sampling;
mod scan_creases;
mod scan_faults;
mod seams;
mod shade;
mod simplify;
mod sound;
mod spoiled;
mod surface;
mod unwrap;
