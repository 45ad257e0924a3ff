//! Files as bytes: reading from regular files only, since a model may refer to any path; their sizes and hashes; and a cache
//! of files in the user's cache folder.

use crate::write::write_bytes;
use directories::ProjectDirs;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::SystemTime;
use taotie_engine::error::{Error, Result};

/// Size of the largest file read, in bytes.
const MAX_BYTES: u64 = 1 << 34;

/// File size in bytes from which several threads read. Allocations of this size come zeroed from the system.
const LARGE: usize = 1 << 25;

/// Reads a whole regular file.
///
/// # Errors
/// [`Error::Io`] if it cannot be read or is a device or a pipe, [`Error::Limit`] above 16 GiB.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let (file, length) = open(path)?;
    if length as usize > LARGE
        && let Some(bytes) = read_pieces(&file, length as usize)
    {
        return Ok(bytes);
    }
    let mut bytes = Vec::with_capacity(length as usize);
    file.take(MAX_BYTES).read_to_end(&mut bytes).map_err(|e| Error::io(path, e))?;
    Ok(bytes)
}

/// Reads a file of `length` bytes in parallel; returns `None` if that fails, leaving the read position unchanged.
#[cfg(unix)]
fn read_pieces(file: &File, length: usize) -> Option<Vec<u8>> {
    use std::os::unix::fs::FileExt;
    use std::sync::atomic::{AtomicBool, Ordering};
    use taotie_engine::parallel;
    const PIECE: usize = 1 << 22;
    let mut bytes = vec![0; length];
    let failed = AtomicBool::new(false);
    parallel::pieces(&mut bytes, PIECE, &|i, piece| {
        if !failed.load(Ordering::Relaxed) && file.read_exact_at(piece, (i * PIECE) as u64).is_err() {
            failed.store(true, Ordering::Relaxed);
        }
    });
    (!failed.into_inner()).then_some(bytes)
}

#[cfg(not(unix))]
fn read_pieces(_file: &File, _length: usize) -> Option<Vec<u8>> {
    None
}

/// Returns the first bytes of the file, at most `count`.
pub(super) fn read_start(path: &Path, count: u64) -> Result<Vec<u8>> {
    let (file, _) = open(path)?;
    let mut bytes = Vec::new();
    file.take(count).read_to_end(&mut bytes).map_err(|e| Error::io(path, e))?;
    Ok(bytes)
}

/// Returns the length of a regular file in bytes.
///
/// # Errors
/// [`Error::Io`] if there is no such file.
pub fn file_size(path: &Path) -> Result<u64> {
    std::fs::metadata(path).map(|about| about.len()).map_err(|e| Error::io(path, e))
}

/// Returns the SHA-256 of a file's bytes, in hexadecimal.
///
/// # Errors
/// As [`read`].
pub fn sha256(path: &Path) -> Result<String> {
    let (mut file, _) = open(path)?;
    let (mut hash, mut block) = (Sha256::new(), vec![0; 1 << 20]);
    loop {
        match file.read(&mut block).map_err(|e| Error::io(path, e))? {
            0 => break,
            read => hash.update(&block[..read]),
        }
    }
    Ok(hexadecimal(hash))
}

/// The SHA-256 of a file, being computed in the background.
#[derive(Debug)]
pub struct FileHash {
    path: PathBuf,
    thread: Mutex<Option<JoinHandle<Result<String>>>>,
    /// The process that has the thread; a child made by `fork` does not.
    process: u32,
    known: OnceLock<String>,
}

impl FileHash {
    /// Starts reading the file.
    pub fn begin(path: &Path) -> Self {
        let path = path.to_path_buf();
        let read = path.clone();
        // If the system cannot start a thread, the file is read on demand.
        let thread = std::thread::Builder::new().spawn(move || sha256(&read)).ok();
        Self { path, thread: Mutex::new(thread), process: process(), known: OnceLock::new() }
    }

    /// Returns the hash, hexadecimal, waiting for it if necessary.
    ///
    /// # Errors
    /// As [`sha256`].
    pub fn get(&self) -> Result<String> {
        if let Some(known) = self.known.get() {
            return Ok(known.clone());
        }
        let hash = self.joined().unwrap_or_else(|| sha256(&self.path))?;
        Ok(self.known.get_or_init(|| hash).clone())
    }

    /// Waits for the thread; `None` if there is none, or another thread has waited for it.
    fn joined(&self) -> Option<Result<String>> {
        if self.is_inherited() {
            return None;
        }
        let mut thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        // A caller that waited for the lock finds the result of the one before.
        self.known.get().map(|known| Ok(known.clone())).or_else(|| {
            let hash = thread.take()?.join().ok()?;
            Some(hash.inspect(|hash| drop(self.known.set(hash.clone()))))
        })
    }

    fn is_inherited(&self) -> bool {
        self.process != process()
    }
}

impl Drop for FileHash {
    /// Forgets a thread that does not exist in this process.
    fn drop(&mut self) {
        if self.is_inherited() {
            std::mem::forget(self.thread.get_mut().map(Option::take));
        }
    }
}

/// Returns the SHA-256 of bytes, in hexadecimal.
pub fn sha256_of(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new().chain_update(bytes))
}

/// Returns the process's number; 0 for WebAssembly, which has none.
fn process() -> u32 {
    if cfg!(target_family = "wasm") { 0 } else { std::process::id() }
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Opens a regular file and returns it with its length. Devices and pipes are rejected first: opening them can block.
pub(super) fn open(path: &Path) -> Result<(File, u64)> {
    let about = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    if !about.is_file() {
        return Err(Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, "not a regular file")));
    }
    if about.len() > MAX_BYTES {
        return Err(Error::limit(
            path.display().to_string(),
            format!("the maximum is {} GiB", MAX_BYTES >> 30),
        ));
    }
    Ok((File::open(path).map_err(|e| Error::io(path, e))?, about.len()))
}

/// Maximum number of bytes in the cache; the least recently used files are removed first.
const MOST_CACHED: u64 = 512 << 20;

/// Opens the file `name` in the cache, a folder of files that are expensive to make; `None` if it does not exist. Opening
/// counts as use.
pub fn cached_file(name: &str) -> Option<File> {
    let path = cache_folder()?.join(name);
    let file = File::open(&path).ok()?;
    if let Ok(file) = File::options().append(true).open(&path) {
        let _ = file.set_modified(SystemTime::now());
    }
    Some(file)
}

/// Writes the file `name` to the cache, completely or not at all; if that fails, it is made again later.
pub fn cache_file(name: &str, bytes: &[u8]) {
    if let Some(folder) = cache_folder() {
        let _ = write_in(&folder, name, bytes);
        make_room(&folder, MOST_CACHED);
    }
}

/// Returns the folder of cached files, such as filtered environments: the one in the environment variable
/// `TAOTIE_CACHE_DIR` if set, otherwise one in the user's cache folder; `None` if the system has no such folder. It
/// may not exist, and can be removed at any time.
fn cache_folder() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os("TAOTIE_CACHE_DIR") {
        return Some(PathBuf::from(folder));
    }
    ProjectDirs::from("", "", "taotie").map(|dirs| dirs.cache_dir().to_owned())
}

fn write_in(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    write_bytes(&folder.join(name), bytes)
}

/// Removes the least recently used files until at most `most` bytes are left.
fn make_room(folder: &Path, most: u64) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let ours = entries.flatten().filter(|entry| entry.path().extension().is_some_and(|e| e == "env"));
    let known = ours.filter_map(|entry| {
        let metadata = entry.metadata().ok()?;
        Some((metadata.modified().ok()?, metadata.len(), entry.path()))
    });
    let mut files: Vec<(SystemTime, u64, PathBuf)> = known.collect();
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, size, path) in files {
        if bytes <= most {
            return;
        }
        if fs::remove_file(path).is_ok() {
            bytes -= size;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn what_was_used_longest_ago_makes_room() {
        let folder = tempfile::tempdir().unwrap();
        for (age, name) in [(30, "old.env"), (10, "young.env"), (20, "middle.env"), (99, "foreign.txt")] {
            write_in(folder.path(), name, &[0; 100]).unwrap();
            let file = File::options().append(true).open(folder.path().join(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
        }
        make_room(folder.path(), 250);
        let left = |name: &str| folder.path().join(name).exists();
        assert_eq!(
            ["old.env", "young.env", "middle.env", "foreign.txt"].map(left),
            [false, true, true, true]
        );
    }
}
