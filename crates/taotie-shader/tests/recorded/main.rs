//! Recorded formulas match the formulas themselves bit for bit.

#[path = "../../../../tests/common/random.rs"]
mod random;

mod models;
mod numbers;
mod parts;
mod recorder;
