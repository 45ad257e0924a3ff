//! The context for reading one model or image: its limits, the memory used so far, and the files that it may refer
//! to; and decoders of other projects, whose panics become values.

use super::file;
use super::limits::{Bytes, Limits, free_memory};
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Component, Path, PathBuf, Prefix};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Once, OnceLock};
use taotie_engine::error::{Error, Result};

/// The context for reading one model or image. Every file that a model refers to is opened through it, and all
/// decoded data is counted by it before memory is allocated.
pub(super) struct Reading {
    path: PathBuf,
    limits: Limits,
    /// Bytes requested so far, including rejected requests, so that the sum does not depend on the order of threads.
    wanted: AtomicU64,
    /// The machine's free memory, once queried.
    free: OnceLock<Option<Bytes>>,
}

impl Reading {
    /// Starts reading a file.
    pub fn new(path: &Path, limits: &Limits) -> Self {
        Self { path: path.to_path_buf(), limits: *limits, wanted: AtomicU64::new(0), free: OnceLock::new() }
    }

    /// Rejects a scene with too many nodes.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub fn check_nodes(&self, count: u64) -> Result<()> {
        let most = self.limits.nodes;
        match count > most {
            true => Err(Error::limit(
                format!("{}: a scene of {count} nodes", self.path.display()),
                format!("the maximum is {most}; split the file"),
            )),
            false => Ok(()),
        }
    }

    /// Returns the path of the model or image.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the folder that relative names start from, and that no file may leave.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Returns the limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Counts bytes that are about to be allocated, and returns `true` if they fit in addition to all others.
    pub fn take(&self, bytes: u64) -> bool {
        let before = self.wanted.fetch_add(bytes, Ordering::Relaxed);
        let wanted = Bytes(before.saturating_add(bytes));
        self.within(wanted).memory_left().is_none_or(|left| wanted <= left)
    }

    /// Returns the limits that apply to `wanted` bytes. The machine's free memory is queried only if it matters.
    fn within(&self, wanted: Bytes) -> Limits {
        /// Every machine has this much.
        const LITTLE: Bytes = Bytes(1 << 26);
        match self.limits.memory {
            None if wanted > LITTLE => {
                Limits { memory: *self.free.get_or_init(|| free_memory().map(Bytes)), ..self.limits }
            }
            _ => self.limits,
        }
    }

    /// Returns how many bytes may still be allocated.
    pub fn left(&self) -> u64 {
        let left = self.within(Bytes(u64::MAX)).memory_left().map_or(u64::MAX, |left| left.0);
        left.saturating_sub(self.wanted.load(Ordering::Relaxed))
    }

    /// Fails if the memory requested so far, including rejected requests, exceeds the limit.
    ///
    /// # Errors
    /// [`Error::Limit`] with both figures.
    pub fn check(&self) -> Result<()> {
        let wanted = Bytes(self.wanted.load(Ordering::Relaxed));
        self.within(wanted).check(self.path.display().to_string(), wanted)
    }

    /// Reads a file that the model refers to.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is outside the model's folder, [`Error::Limit`] if it does not fit in memory; those
    /// of reading.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>> {
        if let Err(why) = self.allows(path) {
            return Err(Error::invalid(path.display().to_string(), why));
        }
        self.read_own(path)
    }

    /// Counts the memory for a file of text or packed numbers: OBJ, MTL, PLY, STL. `unpacked` is the number of bytes
    /// per byte of the file.
    ///
    /// # Errors
    /// [`Error::Limit`] if it does not fit in memory; [`Error::Io`] if it does not exist.
    pub fn count_file(&self, path: &Path, unpacked: u64) -> Result<()> {
        match self.take(unpacked * file::file_size(path)?) {
            true => Ok(()),
            false => self.check(),
        }
    }

    /// Reads the model or image itself.
    ///
    /// # Errors
    /// [`Error::Limit`] if it does not fit in memory; those of reading.
    pub fn read_own(&self, path: &Path) -> Result<Vec<u8>> {
        if !self.take(file::file_size(path)?) {
            self.check()?;
        }
        file::read(path)
    }

    /// Returns an error message if a file is outside the model's folder and may not be read. Links are followed
    /// first.
    pub fn allows(&self, path: &Path) -> std::result::Result<(), String> {
        if self.limits.allow_outside || !is_outside(path, self.folder()) {
            return Ok(());
        }
        Err(format!("{} is outside the model's folder; use --allow-outside to read it", path.display()))
    }
}

/// Returns `true` if a path, which starts with `folder` or is absolute, leaves the folder: by its components, or
/// through links. The system is not queried for a path that leaves it by its components.
fn is_outside(path: &Path, folder: &Path) -> bool {
    let inner = inside(path, folder);
    if names_network(path) && inner.is_none() || inner.is_some_and(leaves) {
        return true;
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (path.canonicalize(), here.canonicalize()) {
        (Ok(path), Ok(folder)) => !path.starts_with(folder),
        // A file that does not exist cannot be read either, unless the path is absolute and thus outside.
        _ => inner.is_none(),
    }
}

/// Returns the rest of a path that starts with a folder; an empty one means the current folder.
fn inside<'a>(path: &'a Path, folder: &Path) -> Option<&'a Path> {
    let is_elsewhere = folder.as_os_str().is_empty() && path.is_absolute();
    if is_elsewhere { None } else { path.strip_prefix(folder).ok() }
}

/// Returns `true` if a path refers to a network share or a device, as Windows paths can: querying it would access
/// them.
pub fn names_network(path: &Path) -> bool {
    let Some(Component::Prefix(prefix)) = path.components().next() else { return false };
    !matches!(prefix.kind(), Prefix::Disk(_) | Prefix::VerbatimDisk(_))
}

/// Returns `true` if a path climbs above its start, or is not relative.
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

/// Locates the file that a name from any system refers to: the path as written in one of `folders`, else its last
/// component there, else the same ignoring case. Returns `None` if it does not exist.
///
/// # Errors
/// An error message if the only file with that name is outside the model's folder and may not be read.
pub(super) fn find(
    name: &str,
    folders: &[&Path],
    reading: &Reading,
) -> std::result::Result<Option<PathBuf>, String> {
    let name = name.replace('\\', "/");
    let last = name.rsplit('/').next().unwrap_or(&name);
    let exact = [name.as_str(), last].into_iter().filter(|name| !name.is_empty());
    let exact = exact.flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let similar = folders.iter().filter_map(|folder| find_any_case(last, folder));
    let mut refused = None;
    for path in exact.chain(similar) {
        match reading.allows(&path) {
            Ok(()) if path.is_file() => return Ok(Some(path)),
            Ok(()) => {}
            Err(why) => drop(refused.get_or_insert(why)),
        }
    }
    refused.map_or(Ok(None), Err)
}

fn find_any_case(name: &str, folder: &Path) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.file_name().is_some_and(|f| f.to_string_lossy().eq_ignore_ascii_case(name)))
        .collect();
    found.sort();
    found.into_iter().find(|path| path.is_file())
}

/// A value, or the reason why it cannot be read; the caller knows the place in the file.
pub(super) type Reason<T> = std::result::Result<T, String>;

/// Returns the standard message for an index out of range.
pub(super) fn no_such(what: &str, index: usize) -> String {
    format!("{what} {index} does not exist")
}

thread_local! {
    /// `true` while a decoder runs on this thread and its panics are caught.
    static CAUGHT_HERE: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder that may panic; returns `None` if it did. Nothing is printed then, since the caller returns an
/// error. The decoder must stay on this thread.
pub(super) fn caught<T>(decode: impl FnOnce() -> T) -> Option<T> {
    keep_quiet_here();
    let before = CAUGHT_HERE.replace(true);
    // A half-finished decoder is dropped with all its state: it owns everything it changes.
    let attempt = panic::catch_unwind(AssertUnwindSafe(decode));
    CAUGHT_HERE.set(before);
    attempt.ok()
}

/// Wraps the process's panic hook, once, with one that ignores panics caught here.
fn keep_quiet_here() {
    static WRAPPED: Once = Once::new();
    WRAPPED.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |about| {
            if !CAUGHT_HERE.get() {
                usual(about);
            }
        }));
    });
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
        assert!(ours.allows(&folder.join("../absent.bin")).is_err(), "existence is not revealed");
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

    #[test]
    fn finds_names_of_other_systems() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("Maps")).unwrap();
        std::fs::write(folder.path().join("Maps/a.png"), "").unwrap();
        std::fs::write(folder.path().join("B c.PNG"), "").unwrap();
        let reading = Reading::new(&folder.path().join("model.obj"), &Limits::default());
        let found = |name: &str| {
            find(name, &[&folder.path().join("no such folder"), folder.path()], &reading).unwrap()
        };
        assert!(found("Maps\\a.png").is_some_and(|p| p.ends_with("Maps/a.png")));
        assert!(found("C:\\Users\\me\\b C.png").is_some_and(|p| p.ends_with("B c.PNG")));
        assert!(found("/home/me/B c.PNG").is_some());
        assert_eq!((found("Maps"), found(""), found("d.png")), (None, None, None));
    }

    #[test]
    fn what_lies_outside_is_told_unless_its_like_lies_inside() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("m");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("secret.png"), "").unwrap();
        let find = |name: &str, allow_outside: bool| {
            let limits = Limits { allow_outside, ..Limits::default() };
            super::find(name, &[&folder], &Reading::new(&folder.join("model.obj"), &limits))
        };
        let absolute = place.path().join("secret.png").display().to_string();
        for name in ["../secret.png", "..\\secret.png", absolute.as_str()] {
            let why = find(name, false).unwrap_err();
            assert!(why.contains("secret.png") && why.contains("--allow-outside"), "{why}");
            assert!(find(name, true).unwrap().is_some());
        }
        std::fs::write(folder.join("secret.png"), "").unwrap();
        assert_eq!(find("../secret.png", false), Ok(Some(folder.join("secret.png"))));
    }

    #[test]
    fn a_panic_becomes_nothing_and_leaves_no_mark() {
        assert_eq!(caught(|| 7), Some(7));
        assert_eq!(caught(|| caught(|| -> u8 { panic!("inner") }).map_or(1, |_| 2)), Some(1));
        assert_eq!(caught(|| -> u8 { panic!("outer") }), None);
        assert!(!CAUGHT_HERE.get(), "later panics are reported again");
    }
}
