//! The hash of a file, computed in the background.

use crate::error::Result;
use crate::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;

/// The SHA-256 of a file, being computed.
#[derive(Debug)]
pub(super) struct FileHash {
    path: PathBuf,
    thread: Mutex<Option<JoinHandle<Result<String>>>>,
    known: OnceLock<String>,
}

impl FileHash {
    /// Starts reading the file.
    pub fn begin(path: &Path) -> Self {
        let path = path.to_path_buf();
        let read = path.clone();
        // If the system cannot start a thread, the file is read on demand.
        let thread = std::thread::Builder::new().spawn(move || io::sha256(&read)).ok();
        Self { path, thread: Mutex::new(thread), known: OnceLock::new() }
    }

    /// Returns the hash, hexadecimal, waiting for it if necessary.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) if the file cannot be read.
    pub fn get(&self) -> Result<String> {
        let mut thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = self.known.get() {
            return Ok(known.clone());
        }
        let begun = thread.take().and_then(|thread| thread.join().ok());
        let hash = begun.unwrap_or_else(|| io::sha256(&self.path))?;
        Ok(self.known.get_or_init(|| hash).clone())
    }
}
