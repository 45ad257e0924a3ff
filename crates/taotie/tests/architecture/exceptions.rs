//! What breaks a rule today, by name. Both lists are empty; the tests ask that what is mended be struck.

/// Files that import one another in a circle, sorted, and why they may.
pub const CIRCLES: [(&[&str], &str); 0] = [];

/// Functions that take more arguments than they should: file and name.
pub const LONG_FUNCTIONS: [(&str, &str); 0] = [];
