//! A job in progress: its callbacks, its store and its limits.

use crate::job::{Go, Job, Message};
use crate::store::Store;
use std::path::Path;
use taotie::asset::Bytes;
use taotie_engine::Progress;
use taotie_io::FileSet;

/// The callbacks of a process: to its driver, and to signal handling.
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// Creates a set of files that signals can stop.
    pub files: &'a (dyn Fn() -> FileSet + Sync),
    /// Sends a message to the driver.
    pub send: &'a (dyn Fn(Message) + Sync),
    /// Waits for the driver's permission to begin.
    pub go: &'a (dyn Fn() -> Go + Sync),
}

/// A job in progress.
pub struct Work<'a> {
    /// The job.
    pub job: &'a Job,
    /// The callbacks of its process.
    pub host: Host<'a>,
    /// The files that it writes.
    pub store: Store,
    /// Its stages.
    pub progress: Progress<'a>,
}

impl Work<'_> {
    /// Returns the name of the scan's file without its extension, the stem of all file names.
    pub fn stem(&self) -> String {
        let stem = self.job.scan.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if stem.is_empty() { "asset".into() } else { stem }
    }

    /// Returns the memory limit for presenting an asset.
    pub fn limit(&self) -> Option<Bytes> {
        self.job.limits.memory
    }
}

/// A path to write, and the set of files it belongs to.
pub type Target<'a> = (&'a Path, &'a FileSet);
