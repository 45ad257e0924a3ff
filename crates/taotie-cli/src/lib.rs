//! The taotie command.

pub mod jue;
