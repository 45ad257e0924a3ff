//! Whole pixel shaders: valid, translatable, bound as their interface says; and their stages, which play back what the
//! pixel program computes.

#[path = "../../../taotie/tests/common/random.rs"]
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
