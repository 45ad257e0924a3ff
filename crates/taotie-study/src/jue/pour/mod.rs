//! The pouring vessel: the feet stay on the ground, the cup tips over its spout and back, and the legs bend.
//!
//! A skin with two joints animates it. The joint of the feet is fixed; that of the cup turns about a point between
//! the roots of the legs. How far a point follows the cup is a smooth function of only its height, so that the low
//! mesh and the displaced one, whose vertices differ, move alike.

mod errors;
mod pouring;
mod rig;
mod truth;

pub use errors::{Eye, RULE, angular_errors};
pub use pouring::Pouring;
pub use rig::{POURED, TIP_DEG, rig};
pub use truth::Truth;
