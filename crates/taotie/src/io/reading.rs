//! The reading of one model or image: what it may take and reach, and what it has taken.

use super::file;
use super::limits::{Bytes, Limits};
use super::system::free_memory;
use crate::error::{Error, Result};
use std::path::{Component, Path, PathBuf, Prefix};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// The reading of one model or image. Every file that a model names is opened through it, and everything that is
/// decoded is counted by it before memory is taken.
pub(super) struct Reading {
    path: PathBuf,
    limits: Limits,
    /// Bytes wanted so far, those that were refused too, so that the sum does not depend on the order of threads.
    wanted: AtomicU64,
    /// What the machine has free, once it was asked.
    free: OnceLock<Option<Bytes>>,
}

impl Reading {
    /// Begins to read a file.
    pub fn new(path: &Path, limits: &Limits) -> Self {
        Self { path: path.to_path_buf(), limits: *limits, wanted: AtomicU64::new(0), free: OnceLock::new() }
    }

    /// The model or image.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder that names in it start from, and that nothing leaves.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Counts bytes that are about to be taken, and says whether they fit beside all others.
    pub fn take(&self, bytes: u64) -> bool {
        let before = self.wanted.fetch_add(bytes, Ordering::Relaxed);
        let wanted = Bytes(before.saturating_add(bytes));
        self.within(wanted).memory.is_none_or(|most| wanted <= most)
    }

    /// Returns the limits as they stand for so many bytes. The machine is asked for what it has free where that matters.
    fn within(&self, wanted: Bytes) -> Limits {
        /// Any machine has so much.
        const LITTLE: Bytes = Bytes(1 << 26);
        match self.limits.memory {
            None if wanted > LITTLE => {
                Limits { memory: *self.free.get_or_init(|| free_memory().map(Bytes)), ..self.limits }
            }
            _ => self.limits,
        }
    }

    /// Returns how many bytes may still be taken.
    pub fn left(&self) -> u64 {
        let most = self.within(Bytes(u64::MAX)).memory.map_or(u64::MAX, |most| most.0);
        most.saturating_sub(self.wanted.load(Ordering::Relaxed))
    }

    /// Refuses what has taken, or was denied, more than there may be.
    ///
    /// # Errors
    /// [`Error::Limit`] with both figures.
    pub fn check(&self) -> Result<()> {
        let wanted = Bytes(self.wanted.load(Ordering::Relaxed));
        self.within(wanted).check(self.path.display().to_string(), wanted)
    }

    /// Reads a file that the model names.
    ///
    /// # Errors
    /// [`Error::Invalid`] where it lies outside the model's folder, [`Error::Limit`] where it does not fit the memory;
    /// those of reading.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>> {
        if let Err(why) = self.allows(path) {
            return Err(Error::invalid(path.display().to_string(), why));
        }
        self.read_own(path)
    }

    /// Counts what a file of text or packed numbers takes: OBJ, MTL, PLY, STL. `unpacked` is the number of bytes for each of
    /// its bytes.
    ///
    /// # Errors
    /// [`Error::Limit`] where it does not fit the memory; [`Error::Io`] where it is not there.
    pub fn count_file(&self, path: &Path, unpacked: u64) -> Result<()> {
        match self.take(unpacked * file::file_size(path)?) {
            true => Ok(()),
            false => self.check(),
        }
    }

    /// Reads the model or image itself.
    ///
    /// # Errors
    /// [`Error::Limit`] where it does not fit the memory; those of reading.
    pub fn read_own(&self, path: &Path) -> Result<Vec<u8>> {
        if !self.take(file::file_size(path)?) {
            self.check()?;
        }
        file::read(path)
    }

    /// Says why a file may not be read, where it lies outside the model's folder. Links are followed first.
    pub fn allows(&self, path: &Path) -> std::result::Result<(), String> {
        if self.limits.allow_outside || !is_outside(path, self.folder()) {
            return Ok(());
        }
        Err(format!(
            "{} lies outside the model's folder and is not read; allow it by --allow-outside",
            path.display()
        ))
    }
}

/// Says whether a path, which starts with `folder` or is absolute, leaves it: by its words, or by links. Nothing is
/// asked of the system about a path that leaves it by its words.
fn is_outside(path: &Path, folder: &Path) -> bool {
    let inner = inside(path, folder);
    if names_network(path) && inner.is_none() || inner.is_some_and(leaves) {
        return true;
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (path.canonicalize(), here.canonicalize()) {
        (Ok(path), Ok(folder)) => !path.starts_with(folder),
        // What is not there cannot be read either, unless it is absolute and no business of the model's.
        _ => inner.is_none(),
    }
}

/// Returns the rest of a path that starts with a folder; an empty one stands for the current folder.
fn inside<'a>(path: &'a Path, folder: &Path) -> Option<&'a Path> {
    let is_elsewhere = folder.as_os_str().is_empty() && path.is_absolute();
    if is_elsewhere { None } else { path.strip_prefix(folder).ok() }
}

/// Says whether a path names a share of the network or a device, as paths of Windows can: asking for it would reach out.
fn names_network(path: &Path) -> bool {
    let Some(Component::Prefix(prefix)) = path.components().next() else { return false };
    matches!(prefix.kind(), Prefix::UNC(..) | Prefix::VerbatimUNC(..) | Prefix::DeviceNS(_))
}

/// Says whether a relative path climbs above its start, or is no relative path.
fn leaves(path: &Path) -> bool {
    let mut depth = 0i64;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => return true,
        }
        if depth < 0 {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(folder: &Path, limits: Limits) -> Reading {
        Reading::new(&folder.join("m/model.gltf"), &limits)
    }

    #[test]
    fn nothing_outside_is_read_unless_it_is_allowed() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("m");
        std::fs::create_dir_all(folder.join("maps")).unwrap();
        for name in ["secret.bin", "m/maps/a.bin", "m/b.bin"] {
            std::fs::write(place.path().join(name), name).unwrap();
        }
        let ours = reading(place.path(), Limits::default());
        for inside in ["maps/a.bin", "maps/../b.bin", "./b.bin"] {
            assert!(ours.read(&folder.join(inside)).is_ok(), "{inside}");
        }
        let outside = [folder.join("../secret.bin"), folder.join("maps/../../secret.bin")];
        let absolute = place.path().join("secret.bin");
        for path in outside.iter().chain([&absolute]) {
            let error = ours.read(path).unwrap_err().to_string();
            assert!(error.contains("secret.bin") && error.contains("--allow-outside"), "{error}");
            let limits = Limits { allow_outside: true, ..Limits::default() };
            assert!(reading(place.path(), limits).read(path).is_ok(), "{}", path.display());
        }
        assert!(ours.allows(&folder.join("../absent.bin")).is_err(), "whether it is there is not told");
    }

    #[cfg(unix)]
    #[test]
    fn an_absolute_path_is_not_inside_the_current_folder_by_its_words() {
        assert_eq!(inside(Path::new("/p/a.png"), Path::new("")), None);
        assert_eq!(inside(Path::new("a.png"), Path::new("")), Some(Path::new("a.png")));
        let here = std::env::current_dir().unwrap().join("Cargo.toml");
        assert!(!is_outside(&here, Path::new("")) && is_outside(Path::new("/etc/hosts"), Path::new("")));
    }

    #[cfg(unix)]
    #[test]
    fn links_that_leave_the_folder_are_not_followed() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("m");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("secret.bin"), "").unwrap();
        std::fs::write(folder.join("own.bin"), "").unwrap();
        std::os::unix::fs::symlink("../secret.bin", folder.join("link.bin")).unwrap();
        std::os::unix::fs::symlink("own.bin", folder.join("near.bin")).unwrap();
        let ours = reading(place.path(), Limits::default());
        assert!(ours.read(&folder.join("link.bin")).unwrap_err().to_string().contains("link.bin"));
        assert!(ours.read(&folder.join("near.bin")).is_ok());
    }

    #[test]
    fn all_that_is_wanted_is_told_whoever_asked_first() {
        let limits = Limits { memory: Some(Bytes(100 << 20)), ..Limits::default() };
        let ours = reading(Path::new(""), limits);
        assert!(ours.take(90 << 20) && ours.check().is_ok());
        assert_eq!(ours.left(), 10 << 20);
        assert!(!ours.take(100 << 20) && !ours.take(10 << 20));
        assert_eq!(ours.left(), 0);
        let error = ours.check().unwrap_err().to_string();
        assert!(
            error.contains("200 MiB") && error.contains("100 MiB") && error.contains("model.gltf"),
            "{error}"
        );
        assert!(ours.read_own(Path::new("no/such/file")).is_err());
    }
}
