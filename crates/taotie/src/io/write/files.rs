//! Several files that appear together or not at all.

use super::draft;
use crate::error::{Error, Result};
use crate::progress::Progress;
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

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

/// Writes all files under temporary names, then renames them, the first last: a document comes after the files it
/// names. A write that fails or is cancelled before the renaming leaves none.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Io`] naming the folder where that is missing, or the path where the system refuses.
pub fn write_files(files: &[FileBytes], progress: Progress<'_>) -> Result<()> {
    let total: usize = files.iter().map(|file| file.bytes.len()).sum();
    let (mut done, mut drafts) = (0, Vec::new());
    for file in files {
        let mut draft = draft(&file.path)?;
        for chunk in file.bytes.chunks(CHUNK) {
            progress.at(done as f64 / total as f64)?;
            draft.write_all(chunk).map_err(|e| Error::io(&file.path, e))?;
            done += chunk.len();
        }
        drafts.push((draft, file.path.as_path()));
    }
    progress.at(1.0)?;
    drafts.into_iter().rev().try_for_each(|(draft, path)| renamed(draft, path))
}

fn renamed(draft: NamedTempFile, path: &Path) -> Result<()> {
    draft.persist(path).map(drop).map_err(|e| Error::io(path, e.error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cancelled_write_leaves_no_file_and_no_change() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, length: usize| FileBytes {
            path: folder.path().join(name),
            bytes: vec![b'x'; length],
        };
        std::fs::write(folder.path().join("a"), "before").unwrap();
        let files = [file("a", 10), file("b", 3 * CHUNK)];
        let cancelled = write_files(&files, Progress::new(&|_, done| done < 0.5));
        assert!(matches!(cancelled, Err(Error::Cancelled)));
        assert_eq!(std::fs::read(&files[0].path).unwrap(), b"before");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write_files(&files, Progress::SILENT).unwrap();
        assert!(files.iter().all(|file| std::fs::read(&file.path).unwrap() == file.bytes));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
