//! Columns: one number of each of many points, so that neighbours load as one pack.

use super::pack::MOST_LANES;

/// How many points go through a stage together; small enough to stay in the nearest caches.
pub const BATCH: usize = 256;

/// As many entries as a column has: a pack may be stored from any point on.
pub const COLUMN: usize = BATCH + MOST_LANES;

/// One number of each point.
pub type Column = [f32; COLUMN];
