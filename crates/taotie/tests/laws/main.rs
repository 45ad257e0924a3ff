//! Laws that hold for all meshes: what a bake preserves, and what its figures and its proof must find.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print their findings")]

#[path = "../../../../tests/common/cart.rs"]
mod cart;
#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/distance.rs"]
mod distance;
#[path = "../../../../tests/common/files.rs"]
mod files;
#[path = "../../../../tests/common/hostile.rs"]
mod hostile;
#[path = "../../../../tests/common/modelled.rs"]
mod modelled;
#[path = "../../../../tests/common/random.rs"]
mod random;

mod bake;
mod bake_alpha;
mod bake_color;
mod bake_material;
mod bake_scan;
mod coarse;
mod figures;
mod fooled;
mod given_low;
mod known_distances;
mod levels;
mod looks;
mod low_faults;
mod made_meshes;
mod map_proofs;
mod mismatches;
mod names;
mod pairs;
mod scan_creases;
mod scan_faults;
mod seams;
mod simplify;
mod skew;
mod sound;
mod spoiled;
mod unwrap;
