//! Recorded formulas play back to the bit what the formulas themselves compute.

#[path = "../../../taotie/tests/common/random.rs"]
mod random;

mod models;
mod numbers;
mod parts;
mod recorder;
