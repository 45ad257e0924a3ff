//! The size of the tables.

/// Nodes along √(n·v).
pub const COLUMNS: usize = 64;

/// Nodes along the roughness.
pub const ROWS: usize = 48;
