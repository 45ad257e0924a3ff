//! A part of a surface seen in close-up.

/// A ball that contains a part of a surface, and the direction from which it is seen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Window {
    /// Its centre, in model units.
    pub center: [f64; 3],
    /// Its radius, in model units.
    pub radius: f64,
    /// The direction from which it is seen, unit.
    pub toward: [f64; 3],
}
