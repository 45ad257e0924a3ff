//! A scan of a collection, and all that were found.

use std::path::PathBuf;
use taotie_engine::Warnings;

/// A scan of a collection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scan {
    /// Its id in the collection, with `/` between folders.
    pub id: String,
    /// Its file, relative to the folder of the collection's file.
    pub path: PathBuf,
    /// Its title, for people.
    pub title: Option<String>,
}

/// The scans of a collection, with warnings about its lists.
#[derive(Debug, Default)]
pub struct Found {
    /// The scans, by id.
    pub scans: Vec<Scan>,
    /// Parts of lists that were ignored.
    pub warnings: Warnings,
}
