//! A hidden folder next to the files to be written: it holds them until all are complete, and moves them into place
//! together.
//!
//! Its name is `.taotie-XXXXXX.part`. Its file `lock` is locked as long as the process lives, so that the next
//! process can recognise what a dead one left behind, even if its process ID has been reused. `new` holds the files
//! under their names, `old` the files that they replace. `whole` marks both as complete: from then on, the renaming
//! is finished even if the process dies in the middle.

use same_file::is_same_file;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use taotie_engine::error::{Error, Result};

const PREFIX: &str = ".taotie-";
const SUFFIX: &str = ".part";
const LOCK: &str = "lock";
const NEW: &str = "new";
const OLD: &str = "old";
const WHOLE: &str = "whole";

/// A hidden folder that holds files until they are complete. It is removed when this is dropped.
#[derive(Debug)]
pub(super) struct Staging {
    folder: PathBuf,
    place: PathBuf,
    /// Open, and thus locked, as long as the folder is in use.
    lock: File,
    /// The files that are complete.
    names: Vec<OsString>,
    /// The number of them, counted from the last, that are in place.
    put: usize,
    /// `true` if this folder holds the only copy of a replaced file, in which case it is kept.
    keeps: bool,
}

impl Staging {
    /// Creates one in a folder, and removes those left there by dead processes.
    ///
    /// # Errors
    /// Those of the system, if the folder is not writable.
    pub fn new(folder: &Path) -> io::Result<Self> {
        /// Another process may mistake a folder for a leftover while it is created, but not repeatedly.
        const MOST: usize = 16;
        sweep(folder);
        for _ in 0..MOST {
            if let Some(made) = Self::attempt(folder)? {
                return Ok(made);
            }
        }
        Err(io::Error::other("temporary folders vanish while being created"))
    }

    /// Returns `None` if another process mistook the folder for a leftover.
    fn attempt(folder: &Path) -> io::Result<Option<Self>> {
        let place = tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX).tempdir_in(folder)?;
        match furnished(place.path()) {
            Ok(lock) => {
                let (folder, place) = (folder.to_path_buf(), place.keep());
                Ok(Some(Self { folder, place, lock, names: Vec::new(), put: 0, keeps: false }))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Returns the folder that the files are for.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns `true` if the files are for a folder, however its path is written.
    pub fn is_of(&self, folder: &Path) -> bool {
        self.folder == folder || is_same_file(&self.folder, folder).unwrap_or(false)
    }

    /// Returns the temporary path of a file.
    pub fn new_path(&self, name: &OsStr) -> PathBuf {
        self.place.join(NEW).join(name)
    }

    /// Returns `true` if a file with this name is complete.
    pub fn holds(&self, name: &OsStr) -> bool {
        self.names.iter().any(|known| known == name)
    }

    /// Marks a file as complete.
    pub fn complete(&mut self, name: &OsStr) {
        self.names.push(name.to_owned());
    }

    /// Returns the final paths of the complete files.
    pub fn targets(&self) -> impl Iterator<Item = PathBuf> {
        self.names.iter().map(|name| self.folder.join(name))
    }

    /// Keeps the files to be replaced: with a second name, so that they also stay in place, or else by moving them.
    pub fn keep_old(&self) -> Result<()> {
        let keep = |name: &OsString| {
            let (target, old) = (self.folder.join(name), self.old_path(name));
            match fs::symlink_metadata(&target) {
                Err(_) => Ok(()),
                Ok(about) if about.is_dir() => Err(Error::io(&target, io::ErrorKind::IsADirectory.into())),
                Ok(_) => fs::hard_link(&target, &old)
                    .or_else(|_| fs::rename(&target, &old))
                    .map_err(|e| Error::io(&target, e)),
            }
        };
        self.names.iter().try_for_each(keep)
    }

    /// Marks the files as complete and those that they replace as kept: from now on, some process finishes the
    /// exchange.
    pub fn mark(&self) -> Result<()> {
        File::create_new(self.place.join(WHOLE)).map(drop).map_err(|e| Error::io(&self.folder, e))
    }

    /// Moves all files into place, the first last: a document appears after the files it refers to.
    pub fn put_new(&mut self) -> Result<()> {
        while let Some(name) = self.names.iter().rev().nth(self.put) {
            let target = self.folder.join(name);
            fs::rename(self.new_path(name), &target).map_err(|e| Error::io(&target, e))?;
            self.put += 1;
        }
        Ok(())
    }

    /// Restores the replaced files. Any that cannot be restored stay in the hidden folder, and the next run restores
    /// them.
    pub fn put_back(&mut self) {
        let _ = fs::remove_file(self.place.join(WHOLE));
        for (index, name) in self.names.iter().rev().enumerate() {
            let (target, old) = (self.folder.join(name), self.old_path(name));
            let was_put = index < self.put;
            let done = match fs::symlink_metadata(&old).is_ok() {
                true if was_put || fs::symlink_metadata(&target).is_err() => fs::rename(&old, &target),
                false if was_put => fs::remove_file(&target),
                _ => Ok(()),
            };
            self.keeps |= done.is_err();
        }
    }

    fn old_path(&self, name: &OsStr) -> PathBuf {
        self.place.join(OLD).join(name)
    }
}

/// Creates the contents of a hidden folder; returns its lock, already locked.
fn furnished(place: &Path) -> io::Result<File> {
    let path = place.join(LOCK);
    let lock = File::create_new(&path)?;
    // If the file system has no locks, nobody can lock this one, and nothing is ever swept.
    let _ = lock.lock();
    fs::metadata(&path)?;
    [NEW, OLD].iter().try_for_each(|part| fs::create_dir(place.join(part)))?;
    Ok(lock)
}

impl Drop for Staging {
    fn drop(&mut self) {
        if !self.keeps {
            remove(&self.place);
        }
        let _ = self.lock.unlock();
    }
}

/// Removes a hidden folder, its lock last: if this is interrupted, the next process recognises the leftovers.
fn remove(place: &Path) {
    [OLD, NEW].iter().for_each(|part| drop(fs::remove_dir_all(place.join(part))));
    [WHOLE, LOCK].iter().for_each(|name| drop(fs::remove_file(place.join(name))));
    let _ = fs::remove_dir(place);
}

/// Moves the files of several folders into place, or none of them. Processes that do so in one folder take turns.
pub(super) fn exchange(folders: &mut [Staging]) -> Result<()> {
    let mut places: Vec<&Path> = folders.iter().map(Staging::folder).collect();
    places.sort();
    let _turns: Vec<Option<File>> = places.into_iter().map(turn).collect();
    let kept = folders.iter().try_for_each(Staging::keep_old);
    let marked = kept.and_then(|()| folders.iter().try_for_each(Staging::mark));
    let put = marked.and_then(|()| folders.iter_mut().rev().try_for_each(Staging::put_new));
    if put.is_err() {
        folders.iter_mut().for_each(Staging::put_back);
    }
    put
}

/// Syncs the names in a folder to disk, if the system supports that for folders.
pub(super) fn sync(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// Waits until no other process renames files in a folder, for at most five seconds: renaming takes far less, and a
/// program that runs this one may itself hold a lock on the folder. Returns `None` if the system cannot lock folders.
fn turn(folder: &Path) -> Option<File> {
    const TRIES: u32 = 500;
    const PAUSE: Duration = Duration::from_millis(10);
    let file = File::open(folder).ok()?;
    for _ in 0..TRIES {
        match file.try_lock() {
            Ok(()) => return Some(file),
            Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
            Err(TryLockError::Error(_)) => return None,
        }
    }
    None
}

/// Removes the leftovers of processes that died while writing into a folder.
fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && name.starts_with(PREFIX) && name.ends_with(SUFFIX) {
            clear(folder, &entry.path());
        }
    }
}

/// Removes a hidden folder unless its process is alive; finishes an interrupted exchange.
fn clear(folder: &Path, place: &Path) {
    let Ok(lock) = File::options().write(true).open(place.join(LOCK)) else {
        // It was or still is being created; in the latter case, its creator retries.
        let _ = fs::remove_dir(place);
        return;
    };
    if lock.try_lock().is_err() {
        return;
    }
    let _turn = turn(folder);
    let is_whole = place.join(WHOLE).exists();
    let mut is_done = true;
    let (from, old) = (place.join(if is_whole { NEW } else { OLD }), place.join(OLD));
    for entry in fs::read_dir(&from).into_iter().flatten().flatten() {
        let target = folder.join(entry.file_name());
        let is_free = fs::symlink_metadata(&target).is_err();
        // Only the file to be replaced is, not one that has appeared there since.
        let is_replaced = is_whole && is_same_file(&target, old.join(entry.file_name())).unwrap_or(false);
        if is_free || is_replaced {
            is_done &= fs::rename(entry.path(), &target).is_ok();
        }
    }
    // Files that could not be moved are retried by the next run.
    if is_done {
        remove(place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    /// A folder with `a` and `b`, and a staging of new ones.
    fn begun() -> (TempDir, Staging) {
        let folder = tempfile::tempdir().unwrap();
        ["a", "b"].iter().for_each(|name| fs::write(folder.path().join(name), "before").unwrap());
        let mut staging = Staging::new(folder.path()).unwrap();
        for name in ["a", "b", "c"] {
            fs::write(staging.new_path(name.as_ref()), "after").unwrap();
            staging.complete(name.as_ref());
        }
        (folder, staging)
    }

    /// Returns the contents of `a`, `b` and `c`, after checking that nothing else exists.
    fn content(folder: &TempDir) -> [Option<String>; 3] {
        let content = ["a", "b", "c"].map(|name| fs::read_to_string(folder.path().join(name)).ok());
        let all = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(all, content.iter().flatten().count(), "something is left over");
        content
    }

    /// Simulates the death of the process.
    fn die(staging: Staging) {
        staging.lock.unlock().unwrap();
        std::mem::forget(staging);
    }

    fn all(text: &str) -> [Option<String>; 3] {
        [(); 3].map(|()| Some(text.to_owned()))
    }

    fn before() -> [Option<String>; 3] {
        [Some("before".into()), Some("before".into()), None]
    }

    #[test]
    fn all_are_put_in_their_places() {
        let (folder, staging) = begun();
        let mut folders = [staging];
        exchange(&mut folders).unwrap();
        drop(folders);
        assert_eq!(content(&folder), all("after"));
    }

    #[test]
    fn where_one_cannot_be_put_all_are_put_back() {
        for missing in ["a", "b", "c"] {
            let (folder, staging) = begun();
            fs::remove_file(staging.new_path(missing.as_ref())).unwrap();
            let mut folders = [staging];
            let error = exchange(&mut folders).unwrap_err().to_string();
            assert!(error.contains(missing), "{error}");
            drop(folders);
            assert_eq!(content(&folder), before(), "{missing}");
        }
    }

    #[test]
    fn what_a_dead_process_left_is_swept_and_a_live_one_keeps_its_own() {
        let (folder, dead) = begun();
        let live = Staging::new(folder.path()).unwrap();
        die(dead);
        drop(Staging::new(folder.path()).unwrap());
        assert!(live.new_path("x".as_ref()).parent().unwrap().is_dir(), "the live one still exists");
        drop(live);
        assert_eq!(content(&folder), before());
    }

    #[test]
    fn a_renaming_that_was_cut_off_is_finished() {
        for renamed in 0..=3 {
            let (folder, staging) = begun();
            staging.keep_old().unwrap();
            staging.mark().unwrap();
            for name in staging.names.iter().rev().take(renamed) {
                fs::rename(staging.new_path(name), folder.path().join(name)).unwrap();
            }
            die(staging);
            sweep(folder.path());
            assert_eq!(content(&folder), all("after"), "{renamed}");
        }
    }

    #[test]
    fn what_was_moved_away_and_not_replaced_comes_back() {
        let (folder, staging) = begun();
        fs::rename(folder.path().join("a"), staging.old_path("a".as_ref())).unwrap();
        die(staging);
        sweep(folder.path());
        assert_eq!(content(&folder), before());
    }

    #[test]
    fn a_file_that_came_since_is_not_replaced() {
        let (folder, staging) = begun();
        staging.keep_old().unwrap();
        staging.mark().unwrap();
        die(staging);
        fs::remove_file(folder.path().join("b")).unwrap();
        fs::write(folder.path().join("b"), "by the user").unwrap();
        sweep(folder.path());
        assert_eq!(fs::read_to_string(folder.path().join("b")).unwrap(), "by the user");
    }

    #[test]
    fn folders_of_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let others = [".taotie-mine", "taotie-x.part", ".taotie-full.part"];
        others.iter().for_each(|name| fs::create_dir(folder.path().join(name)).unwrap());
        fs::write(folder.path().join(".taotie-full.part/notes.txt"), "").unwrap();
        sweep(folder.path());
        assert!(others.iter().all(|name| folder.path().join(name).is_dir()));
    }
}
