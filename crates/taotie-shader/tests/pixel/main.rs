//! Whole pixel shaders: valid, translatable, bound as their interface specifies; and their stages, which match the
//! pixel program bit for bit.

#[path = "../../../../tests/common/random.rs"]
mod random;

#[path = "../shared/bodies.rs"]
mod bodies;

mod direct;
mod interface;
mod lookups;
mod stages;
mod text;
mod valid;
mod variants;
