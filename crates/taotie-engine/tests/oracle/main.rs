//! Values compared with others' arithmetic: NumPy in double precision from the papers' formulas (`tests/oracle`),
//! published vectors and constants.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print their findings")]

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod animation;
mod compare;
mod film;
mod light;
mod mikktspace;
mod shade;
