//! Whole images by a graphics processor against those by the processor.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests say what they found")]

#[path = "../../../taotie/tests/common/mod.rs"]
mod common;
#[path = "../../../taotie/tests/common/files.rs"]
mod files;
#[path = "../../../taotie/tests/common/finishes.rs"]
mod finishes;
#[allow(dead_code, reason = "shared with tests that need more of it")]
#[path = "../../../taotie/tests/common/random.rs"]
mod random;
#[path = "../../../taotie/tests/common/scenes.rs"]
mod scenes;
#[allow(dead_code, reason = "shared with tests that need more of it")]
#[path = "../../../taotie/tests/common/skies.rs"]
mod skies;

mod compared;
mod made;
mod models;
mod sequence;
