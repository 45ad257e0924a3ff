//! A set of files that appear together or not at all, and never overwrite an input.

use super::staging::{Staging, exchange, sync};
use same_file::is_same_file;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use taotie_engine::error::{Error, Result};
use taotie_engine::progress::Progress;

/// The buffer size for writing a file, in bytes.
pub(super) const BUFFER: usize = 1 << 16;

/// The number of bytes between two checks for cancellation.
const CHUNK: usize = 1 << 20;

/// A file to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileBytes {
    /// The path of the file.
    pub path: PathBuf,
    /// The whole content of the file.
    pub bytes: Vec<u8>,
}

/// A set of files that appear together or not at all, and never overwrite an input. Clones share everything.
///
/// Files are written to a hidden folder next to their destination until [`FileSet::commit`]. Without a commit, they
/// are removed when the last clone is dropped, and existing files stay unchanged.
///
/// ```
/// use taotie_io::FileSet;
///
/// let folder = tempfile::tempdir().unwrap();
/// let [scan, asset, report] = ["scan.ply", "asset.glb", "report.json"].map(|name| folder.path().join(name));
/// std::fs::write(&scan, "ply").unwrap();
///
/// let files = FileSet::new();
/// files.protect([&scan])?;
/// files.write_bytes(&asset, b"glTF")?;
/// files.write_text(&report, "{}")?;
/// assert!(!asset.exists() && files.current(&asset).exists());
/// assert!(files.write_text(&scan, "no").unwrap_err().to_string().contains("would overwrite"));
/// files.commit()?;
/// assert!(asset.exists() && report.exists());
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct FileSet {
    state: Arc<Mutex<State>>,
}

/// A handle to a [`FileSet`] that stops it from any thread.
#[derive(Debug, Clone)]
pub struct Stopper {
    state: Weak<Mutex<State>>,
}

#[derive(Debug, Default)]
struct State {
    /// The files that were read.
    sources: Vec<PathBuf>,
    /// The files that will be written.
    claimed: Vec<PathBuf>,
    folders: Vec<Staging>,
    /// Folders that were created, the deepest of each path first.
    made: Vec<PathBuf>,
    /// Number of files that were started but are not complete.
    open: usize,
    is_stopped: bool,
}

/// A seekable output.
pub(crate) trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

impl FileSet {
    /// Creates an empty set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Lets `write` fill a new set, and commits it.
    ///
    /// # Errors
    /// Those of `write` and of [`FileSet::commit`].
    pub fn one<T>(write: impl FnOnce(&Self) -> Result<T>) -> Result<T> {
        let files = Self::new();
        let written = write(&files)?;
        files.commit().map(|()| written)
    }

    /// Marks files as inputs: no file of the set may overwrite one of them, under any name or link.
    ///
    /// # Errors
    /// [`Error::Invalid`] with both names if one of them is to be written.
    pub fn protect(&self, sources: impl IntoIterator<Item = impl AsRef<Path>>) -> Result<()> {
        let mut state = self.state()?;
        let sources: Vec<PathBuf> = sources.into_iter().map(|source| source.as_ref().to_path_buf()).collect();
        state.claimed.iter().try_for_each(|target| refuse_read(target, &sources))?;
        state.sources.extend(sources);
        Ok(())
    }

    /// Registers a file to be written, and tests that it can be, before the actual work.
    ///
    /// ```
    /// let files = taotie_io::FileSet::new();
    /// let error = files.claim("no/such/folder/scan.glb".as_ref()).unwrap_err();
    /// assert_eq!(error.to_string(), "no/such/folder: the folder does not exist; create it first");
    /// ```
    ///
    /// # Errors
    /// [`Error::Io`] with the folder if that is missing, or with the path if it is not a regular file or the system
    /// refuses; [`Error::Invalid`] with both names if it is an input.
    pub fn claim(&self, path: &Path) -> Result<()> {
        self.reserve(path)?;
        let at = self.state()?.place(path)?;
        if !at.exists() {
            // The name may be too long.
            let tried = File::create_new(&at).and_then(|_| fs::remove_file(&at));
            tried.map_err(|e| Error::io(path, e))?;
        }
        Ok(())
    }

    /// Registers a file that may be written, and checks that it is not an input.
    ///
    /// # Errors
    /// [`Error::Invalid`] with both names if it is an input.
    pub fn reserve(&self, path: &Path) -> Result<()> {
        let mut state = self.state()?;
        refuse_read(path, &state.sources)?;
        state.claimed.push(path.to_path_buf());
        Ok(())
    }

    /// Registers a folder that files will be written to, and creates it if it does not exist. It is removed again if
    /// the set is not committed.
    ///
    /// # Errors
    /// [`Error::Io`] with the path of an existing file in its place, or with the folder if the system refuses.
    pub fn claim_folder(&self, folder: &Path) -> Result<()> {
        let mut state = self.state()?;
        let missing = |part: &&Path| !part.as_os_str().is_empty() && !part.exists();
        let new: Vec<PathBuf> = folder.ancestors().take_while(missing).map(Path::to_path_buf).collect();
        if let Some(there) = folder.ancestors().find(|part| part.exists())
            && !there.is_dir()
        {
            let why = io::Error::new(io::ErrorKind::NotADirectory, "expected a folder, found a file");
            return Err(Error::io(there, why));
        }
        state.made.extend(new);
        fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        state.staging(folder).map(drop).map_err(|e| Error::io(folder, e))
    }

    /// Returns the path where a file of the set can be read now: its own after [`FileSet::commit`].
    pub fn current(&self, path: &Path) -> PathBuf {
        let state = lock(&self.state);
        let name = path.file_name().unwrap_or_default();
        let mut held = state.folders.iter().filter(|staging| staging.is_of(folder_of(path)));
        let held = held.find(|staging| staging.holds(name));
        held.map_or_else(|| path.to_path_buf(), |staging| staging.new_path(name))
    }

    /// Returns the files that are complete but not yet at their destination.
    pub fn files(&self) -> Vec<PathBuf> {
        lock(&self.state).folders.iter().flat_map(Staging::targets).collect()
    }

    /// Writes `bytes` to `path`.
    ///
    /// # Errors
    /// As [`FileSet::claim`], and [`Error::Cancelled`] after [`Stopper::stop`].
    pub fn write_bytes(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        self.write_with(path, |out| out.write_all(bytes).map_err(|e| Error::io(path, e)))
    }

    /// Writes `text` to `path`.
    ///
    /// # Errors
    /// As [`FileSet::write_bytes`].
    pub fn write_text(&self, path: &Path, text: &str) -> Result<()> {
        self.write_bytes(path, text.as_bytes())
    }

    /// Writes all files. The first is renamed last: a document appears after the files it refers to.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; as [`FileSet::write_bytes`].
    pub fn write_files(&self, files: &[FileBytes], progress: Progress<'_>) -> Result<()> {
        let total: usize = files.iter().map(|file| file.bytes.len()).sum();
        let mut done = 0;
        for file in files {
            self.write_with(&file.path, |out| {
                for chunk in file.bytes.chunks(CHUNK) {
                    progress.at(done as f64 / total as f64)?;
                    out.write_all(chunk).map_err(|e| Error::io(&file.path, e))?;
                    done += chunk.len();
                }
                Ok(())
            })?;
        }
        progress.at(1.0)
    }

    /// Lets `fill` write to a file of the set. The file is removed if anything fails.
    pub(crate) fn write_with(
        &self,
        path: &Path,
        fill: impl FnOnce(&mut dyn Sink) -> Result<()>,
    ) -> Result<()> {
        let draft = self.begin(path)?;
        let mut out = BufWriter::with_capacity(BUFFER, &draft.file);
        fill(&mut out)?;
        out.flush().map_err(|e| Error::io(path, e))?;
        drop(out);
        draft.finish()
    }

    /// Starts a file of the set.
    pub(super) fn begin(&self, path: &Path) -> Result<Draft> {
        let mut state = self.state()?;
        let at = state.place(path)?;
        let file = File::create_new(&at).map_err(|e| Error::io(path, e))?;
        state.open += 1;
        drop(state);
        Ok(Draft { files: self.clone(), path: path.to_path_buf(), at, file, is_done: false })
    }

    /// Moves all files to their destinations, or none of them.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a file is incomplete, [`Error::Cancelled`] after [`Stopper::stop`], [`Error::Io`] if the
    /// system refuses: then everything is unchanged.
    pub fn commit(&self) -> Result<()> {
        let mut state = self.state()?;
        if state.open > 0 {
            return Err(Error::invalid("output files", format!("{} incomplete", state.open)));
        }
        let folders: Vec<PathBuf> = state.folders.iter().map(|staging| staging.folder().to_owned()).collect();
        let done = exchange(&mut state.folders);
        state.folders.clear();
        if done.is_ok() {
            state.made.clear();
        }
        drop(state);
        folders.iter().for_each(|folder| sync(folder));
        done
    }

    /// Returns a handle with which another thread can stop the set.
    pub fn stopper(&self) -> Stopper {
        Stopper { state: Arc::downgrade(&self.state) }
    }

    /// Returns the state, unless the set was stopped.
    fn state(&self) -> Result<MutexGuard<'_, State>> {
        let state = lock(&self.state);
        if state.is_stopped { Err(Error::Cancelled) } else { Ok(state) }
    }
}

impl Stopper {
    /// Removes all files that are not at their destination, and prevents further writes. Files being moved get there
    /// first, which takes milliseconds.
    pub fn stop(&self) {
        if let Some(state) = self.state.upgrade() {
            let mut state = lock(&state);
            state.is_stopped = true;
            state.clear();
        }
    }
}

impl State {
    /// Returns the temporary path of a file.
    fn place(&mut self, path: &Path) -> Result<PathBuf> {
        refuse_special(path)?;
        refuse_read(path, &self.sources)?;
        let Some(name) = path.file_name() else {
            return Err(Error::invalid(path.display().to_string(), "specify a file name"));
        };
        let folder = folder_of(path);
        if !folder.is_dir() {
            let why = io::Error::new(io::ErrorKind::NotFound, "the folder does not exist; create it first");
            return Err(Error::io(folder, why));
        }
        let staging = self.staging(folder).map_err(|e| Error::io(path, e))?;
        Ok(staging.new_path(name))
    }

    fn staging(&mut self, folder: &Path) -> io::Result<&mut Staging> {
        let known = self.folders.iter().position(|staging| staging.is_of(folder));
        let index = match known {
            Some(index) => index,
            None => {
                self.folders.push(Staging::new(folder)?);
                self.folders.len() - 1
            }
        };
        Ok(&mut self.folders[index])
    }

    fn clear(&mut self) {
        self.folders.clear();
        // Folders that are not empty stay.
        self.made.drain(..).for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

impl Drop for State {
    fn drop(&mut self) {
        self.clear();
    }
}

/// A file of a set, being written.
#[derive(Debug)]
pub(super) struct Draft {
    files: FileSet,
    path: PathBuf,
    at: PathBuf,
    pub file: File,
    is_done: bool,
}

impl Draft {
    /// Returns the final path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Marks the file as complete.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be synced to disk, [`Error::Cancelled`] if the set was stopped.
    pub fn finish(mut self) -> Result<()> {
        self.file.sync_data().map_err(|e| Error::io(&self.path, e))?;
        let mut state = self.files.state()?;
        let staging = state.staging(folder_of(&self.path)).map_err(|e| Error::io(&self.path, e))?;
        staging.complete(self.path.file_name().unwrap_or_default());
        state.open -= 1;
        drop(state);
        self.is_done = true;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if !self.is_done {
            let _ = fs::remove_file(&self.at);
            lock(&self.files.state).open -= 1;
        }
    }
}

/// Writes `bytes` to `path`, completely or not at all.
///
/// # Errors
/// [`Error::Io`] with the folder if that is missing, or with the path if the system refuses.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    FileSet::one(|files| files.write_bytes(path, bytes))
}

/// Writes `text` to `path`, completely or not at all.
///
/// # Errors
/// As [`write_bytes`].
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_bytes(path, text.as_bytes())
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the folder that a file is in.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Rejects anything that cannot be replaced by a file: folders, devices, pipes.
fn refuse_special(path: &Path) -> Result<()> {
    let why = match fs::metadata(path) {
        Ok(about) if about.is_dir() => "expected a file, found a folder",
        Ok(about) if !about.is_file() => "not a regular file; choose another name",
        _ => return Ok(()),
    };
    Err(Error::io(path, io::Error::new(io::ErrorKind::InvalidInput, why)))
}

/// Rejects overwriting an input.
fn refuse_read(target: &Path, sources: &[PathBuf]) -> Result<()> {
    if !target.is_file() {
        return Ok(());
    }
    let is_target = |source: &&PathBuf| source.is_file() && is_same_file(target, source).unwrap_or(false);
    let Some(source) = sources.iter().find(is_target) else { return Ok(()) };
    let (target, source) = (target.display(), source.display());
    let why = format!("it would overwrite the input {source}; choose another name or folder");
    Err(Error::invalid(target.to_string(), why))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    fn count(folder: &TempDir) -> usize {
        fs::read_dir(folder.path()).unwrap().count()
    }

    #[test]
    fn replaces_whole_files_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a b.txt");
        write_text(&path, "first, and longer").unwrap();
        write_text(&path, "second").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        let failed = FileSet::one(|files| {
            files.write_with(&path, |out| {
                out.write_all(b"half").unwrap();
                Err(Error::invalid("x", "y"))
            })
        });
        assert!(failed.is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(count(&folder), 1);
    }

    #[test]
    fn a_cancelled_write_leaves_no_file_and_no_change() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, length: usize| FileBytes {
            path: folder.path().join(name),
            bytes: vec![b'x'; length],
        };
        fs::write(folder.path().join("a"), "before").unwrap();
        let list = [file("a", 10), file("b", 3 * CHUNK)];
        let stop = |_: &'static str, done: f64| done < 0.5;
        let cancelled = FileSet::one(|files| files.write_files(&list, Progress::new(&stop)));
        assert!(matches!(cancelled, Err(Error::Cancelled)));
        assert_eq!(fs::read(&list[0].path).unwrap(), b"before");
        assert_eq!(count(&folder), 1);
        FileSet::one(|files| files.write_files(&list, Progress::SILENT)).unwrap();
        assert!(list.iter().all(|file| fs::read(&file.path).unwrap() == file.bytes));
        assert_eq!(count(&folder), 2);
    }

    #[test]
    fn places_are_tried_and_left_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("file"), "before").unwrap();
        let files = FileSet::new();
        files.claim(&path("file")).unwrap();
        files.claim(&path("new")).unwrap();
        files.claim_folder(&path("folder/deep")).unwrap();
        let refused = |name: &str| files.claim(&path(name)).unwrap_err().to_string();
        assert!(
            refused("").contains("found a folder") && refused("new/deep/file").contains("does not exist")
        );
        assert!(refused(&"x".repeat(300)).contains("xxx"), "the name is too long");
        let error = files.claim_folder(&path("file/deep")).unwrap_err().to_string();
        assert!(error.ends_with("file: expected a folder, found a file"), "{error}");
        drop(files);
        assert_eq!(fs::read(path("file")).unwrap(), b"before");
        assert_eq!(count(&folder), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_refuses_is_told() {
        // Nobody can create files there, not even root.
        let files = FileSet::new();
        let error = files.claim(Path::new("/proc/scan.glb")).unwrap_err().to_string();
        assert!(error.starts_with("/proc/scan.glb: "), "{error}");
        assert!(files.claim_folder(Path::new("/proc/scans")).is_err());
        assert!(files.claim(Path::new("/dev/null")).unwrap_err().to_string().contains("not a regular file"));
    }

    #[test]
    fn no_file_is_written_over_one_that_was_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("sub")).unwrap();
        fs::write(path("scan.bin"), "numbers").unwrap();
        fs::hard_link(path("scan.bin"), path("link.bin")).unwrap();
        let files = FileSet::new();
        files.claim(&path("later.bin")).unwrap();
        files.protect([path("scan.bin"), path("missing.bin")]).unwrap();
        for name in ["scan.bin", "sub/../scan.bin", "link.bin"] {
            let error = files.write_bytes(&path(name), b"").unwrap_err().to_string();
            assert!(error.contains(name) && error.contains("scan.bin; choose another"), "{error}");
            assert!(files.claim(&path(name)).is_err());
        }
        fs::write(path("later.bin"), "it came to be").unwrap();
        assert!(files.protect([path("later.bin")]).is_err(), "a claimed file cannot become an input");
        files.write_bytes(&path("other.bin"), b"").unwrap();
        files.commit().unwrap();
        assert_eq!(fs::read(path("scan.bin")).unwrap(), b"numbers");
    }

    #[cfg(unix)]
    #[test]
    fn nor_over_one_that_a_link_leads_to() {
        let folder = tempfile::tempdir().unwrap();
        let [source, link] = ["a.png", "b.png"].map(|name| folder.path().join(name));
        fs::write(&source, "").unwrap();
        std::os::unix::fs::symlink(&source, &link).unwrap();
        for (read, written) in [(&source, &link), (&link, &source)] {
            let files = FileSet::new();
            files.protect([read]).unwrap();
            assert!(files.claim(written).is_err());
        }
    }

    #[test]
    fn a_set_that_is_stopped_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (files, made) = (FileSet::new(), folder.path().join("made"));
        files.claim_folder(&made).unwrap();
        files.write_text(&made.join("a"), "a").unwrap();
        let open = files.begin(&made.join("b")).unwrap();
        assert!(files.commit().unwrap_err().to_string().contains("1 incomplete"));
        let stopper = files.stopper();
        stopper.stop();
        assert!(matches!(open.finish(), Err(Error::Cancelled)));
        assert!(matches!(files.write_text(&made.join("c"), "c"), Err(Error::Cancelled)));
        assert!(matches!(files.commit(), Err(Error::Cancelled)));
        assert_eq!(count(&folder), 0);
    }

    #[test]
    fn a_folder_may_be_spelled_in_two_ways() {
        let place = tempfile::tempdir().unwrap();
        let files = FileSet::new();
        files.write_text(&place.path().join("a.txt"), "a").unwrap();
        files.write_text(&place.path().join("./b.txt"), "b").unwrap();
        files.commit().unwrap();
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_file_can_be_read_before_it_is_in_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let (files, path) = (FileSet::new(), folder.path().join("a"));
        fs::write(&path, "before").unwrap();
        files.write_text(&path, "after").unwrap();
        assert_eq!(files.files(), std::slice::from_ref(&path));
        assert_eq!(fs::read_to_string(files.current(&path)).unwrap(), "after");
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        files.commit().unwrap();
        assert_eq!((files.current(&path), files.files().len()), (path.clone(), 0));
        assert_eq!(fs::read_to_string(&path).unwrap(), "after");
    }
}
