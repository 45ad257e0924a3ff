//! A hidden folder beside the files that are to be written: it holds them until all are complete, and puts them in their
//! places together.
//!
//! Its name is `.taotie-XXXXXX.part`. `lock` in it is locked for as long as the process lives, so that the next process
//! tells what a dead one has left, whatever became of its number. `new` holds the files under their names, `old` what
//! stood in their places. `whole` says that all of both is there: from then on the renaming is finished even where the
//! process dies amid it.

use crate::error::{Error, Result};
use same_file::is_same_file;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

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
    /// Open, and so locked, as long as the folder is in use.
    lock: File,
    /// The files that are complete.
    names: Vec<OsString>,
    /// The number of them, from the last on, that are in their places.
    put: usize,
    /// `true` where a file that stood in a place before is here alone: then the folder stays.
    keeps: bool,
}

impl Staging {
    /// Makes one in a folder, and removes those of processes that have died there.
    ///
    /// # Errors
    /// Those of the system, where it lets nothing be written there.
    pub fn new(folder: &Path) -> io::Result<Self> {
        /// Another process may take a folder for left over while it is made, but not again and again.
        const MOST: usize = 16;
        sweep(folder);
        for _ in 0..MOST {
            if let Some(made) = Self::attempt(folder)? {
                return Ok(made);
            }
        }
        Err(io::Error::other("temporary folders vanish while they are made"))
    }

    /// Returns `None` where another process took the folder for left over.
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

    /// Says whether the files are for a folder, however it is spelled.
    pub fn is_of(&self, folder: &Path) -> bool {
        self.folder == folder || is_same_file(&self.folder, folder).unwrap_or(false)
    }

    /// Returns the place of a file that is not in its own yet.
    pub fn new_path(&self, name: &OsStr) -> PathBuf {
        self.place.join(NEW).join(name)
    }

    /// Says whether a file of this name is complete.
    pub fn holds(&self, name: &OsStr) -> bool {
        self.names.iter().any(|known| known == name)
    }

    /// Takes a file as complete.
    pub fn complete(&mut self, name: &OsStr) {
        self.names.push(name.to_owned());
    }

    /// Returns the files that are complete, under the paths that they will have.
    pub fn targets(&self) -> impl Iterator<Item = PathBuf> {
        self.names.iter().map(|name| self.folder.join(name))
    }

    /// Keeps what stands in the places of the files: by a second name, so that it stays there too, or else moved away.
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

    /// Marks the files as complete and what they replace as kept: what is begun now is finished, by whomever.
    pub fn mark(&self) -> Result<()> {
        File::create_new(self.place.join(WHOLE)).map(drop).map_err(|e| Error::io(&self.folder, e))
    }

    /// Puts all files in their places, the first last: a document comes after the files that it names.
    pub fn put_new(&mut self) -> Result<()> {
        while let Some(name) = self.names.iter().rev().nth(self.put) {
            let target = self.folder.join(name);
            fs::rename(self.new_path(name), &target).map_err(|e| Error::io(&target, e))?;
            self.put += 1;
        }
        Ok(())
    }

    /// Puts back what stood there before. What cannot be put back stays in the hidden folder, from which the next run
    /// puts it back.
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

/// Makes what a hidden folder holds; returns its lock, taken.
fn furnished(place: &Path) -> io::Result<File> {
    let path = place.join(LOCK);
    let lock = File::create_new(&path)?;
    // Where the file system has no locks, nobody can take this one, and nothing is ever swept.
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

/// Removes a hidden folder, its lock last: where that is cut off, the next process tells what is left over.
fn remove(place: &Path) {
    [OLD, NEW].iter().for_each(|part| drop(fs::remove_dir_all(place.join(part))));
    [WHOLE, LOCK].iter().for_each(|name| drop(fs::remove_file(place.join(name))));
    let _ = fs::remove_dir(place);
}

/// Puts the files of several folders in their places, or none of them. Processes that do so in one folder take turns.
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

/// Lets the names in a folder reach the disk, where the system can do that for folders.
pub(super) fn sync(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// Waits until no other process renames files in a folder, five seconds at most: renaming takes far less, and a program
/// that runs this one may hold a lock of the folder itself. `None` where the system cannot lock folders.
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

/// Removes what processes have left that died while they wrote into a folder.
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

/// Removes a hidden folder unless its process lives; ends what that was amid.
fn clear(folder: &Path, place: &Path) {
    let Ok(lock) = File::options().write(true).open(place.join(LOCK)) else {
        // It was being made, perhaps is still; then its maker begins anew.
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
        // Only what was to be replaced is: not a file that has come to stand there since.
        let is_replaced = is_whole && is_same_file(&target, old.join(entry.file_name())).unwrap_or(false);
        if is_free || is_replaced {
            is_done &= fs::rename(entry.path(), &target).is_ok();
        }
    }
    // What could not be moved is tried again by the next run.
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

    /// What `a`, `b` and `c` hold, once nothing else is there.
    fn content(folder: &TempDir) -> [Option<String>; 3] {
        let content = ["a", "b", "c"].map(|name| fs::read_to_string(folder.path().join(name)).ok());
        let all = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(all, content.iter().flatten().count(), "something is left over");
        content
    }

    /// The same as if the process had died.
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
        assert!(live.new_path("x".as_ref()).parent().unwrap().is_dir(), "the live one is there");
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
