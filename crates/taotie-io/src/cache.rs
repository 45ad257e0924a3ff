//! A size-limited cache in the user's cache folder, for files that are expensive to make.
//!
//! Nothing here can fail: anything that cannot be read or written is recomputed.

use super::write::write_bytes;
use directories::ProjectDirs;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use taotie_engine::error::{Error, Result};

/// Maximum number of bytes in the folder; the least recently used files are removed first.
const MOST_BYTES: u64 = 512 << 20;

/// Opens the file `name` if it exists. Opening counts as use.
pub fn open(name: &str) -> Option<File> {
    let path = cache_folder()?.join(name);
    let file = File::open(&path).ok()?;
    if let Ok(file) = File::options().append(true).open(&path) {
        let _ = file.set_modified(SystemTime::now());
    }
    Some(file)
}

/// Writes the file `name`, completely or not at all.
pub fn write(name: &str, bytes: &[u8]) {
    if let Some(folder) = cache_folder() {
        let _ = write_in(&folder, name, bytes);
        make_room(&folder, MOST_BYTES);
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
