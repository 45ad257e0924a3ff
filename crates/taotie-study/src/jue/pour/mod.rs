//! The vessel pours: feet on the ground, the cup tips over its spout and leans back, and the legs bend between.
//!
//! A skin of two joints does it. The foot's joint stands still; the cup's turns about a point between the roots of the
//! legs. How far a point follows the cup is a smooth function of its height alone, so that the low mesh and the
//! displaced one, whose vertices are elsewhere, move alike.

mod errors;
mod pouring;
mod rig;
mod truth;

pub use errors::{Eye, RULE, angular_errors};
pub use pouring::Pouring;
pub use rig::{POURED, TIP_DEG, rig};
pub use truth::Truth;
