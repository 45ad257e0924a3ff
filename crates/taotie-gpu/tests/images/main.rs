//! Compares whole images, and baked maps, by a GPU with those by the CPU.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests report what they found")]

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/files.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod files;
#[path = "../../../../tests/common/finishes.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod finishes;
#[path = "../../../../tests/common/random.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod random;
#[path = "../../../../tests/common/scenes.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod scenes;
#[path = "../../../../tests/common/skies.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod skies;

mod bakes;
mod compared;
mod holes;
mod host;
mod made;
mod models;
mod sequence;
