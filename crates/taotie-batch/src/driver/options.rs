//! The options of the work on a collection.

use crate::manifest::Shard;
use std::time::Duration;
use taotie::asset::Bytes;

/// How to run the work on a collection. `None` means: as the collection's file states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DriveOptions {
    /// The largest number of concurrent processes; defaults to the number of hardware threads.
    pub jobs: Option<usize>,
    /// The most memory for all processes together; defaults to the free memory.
    pub memory: Option<Bytes>,
    /// The longest time per asset; defaults to a limit that depends on the scan's size.
    pub time_limit: Option<Duration>,
    /// The part of the collection to work on; `None` for all.
    pub shard: Option<Shard>,
    /// `true` to retry assets that failed or were refused.
    pub retry_failed: bool,
    /// `true` to allow reading files outside the folders of models.
    pub allow_outside: bool,
}
