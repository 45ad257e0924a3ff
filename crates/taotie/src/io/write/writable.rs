//! Places that can be written to: asked before the work, not after it.

use super::{draft, draft_in};
use crate::error::{Error, Result};
use std::io;
use std::path::Path;

/// Refuses a file that cannot be written: makes a temporary file beside it, and removes that again.
///
/// ```
/// let error = taotie::io::check_writable("no/such/folder/scan.glb".as_ref()).unwrap_err();
/// assert_eq!(error.to_string(), "no/such/folder: there is no such folder; make it first");
/// ```
///
/// # Errors
/// [`Error::Io`] naming the folder where that is missing, or the path where it is a folder or the system refuses.
pub fn check_writable(path: &Path) -> Result<()> {
    draft(path).map(drop)
}

/// Refuses a folder that can neither be written to nor made: makes a temporary file in the part of its path that is
/// there, and removes that again.
///
/// # Errors
/// [`Error::Io`] naming what stands in its place where that is no folder, or the folder where the system refuses.
pub fn check_writable_folder(folder: &Path) -> Result<()> {
    let there = folder.ancestors().find(|part| part.exists()).unwrap_or(Path::new("."));
    if !there.is_dir() {
        let why = io::Error::new(io::ErrorKind::NotADirectory, "it is a file; give a folder");
        return Err(Error::io(there, why));
    }
    draft_in(there).map(drop).map_err(|e| Error::io(folder, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_tried_and_left_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("file"), "before").unwrap();
        check_writable(&path("file")).unwrap();
        check_writable(&path("new")).unwrap();
        check_writable_folder(&path("new/deep")).unwrap();
        assert!(check_writable(folder.path()).is_err() && check_writable(&path("new/deep/file")).is_err());
        let error = check_writable_folder(&path("file/deep")).unwrap_err().to_string();
        assert!(error.ends_with("file: it is a file; give a folder"), "{error}");
        assert_eq!(std::fs::read(path("file")).unwrap(), b"before");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_refuses_is_told() {
        // No one can make files there, not even the administrator.
        assert!(
            check_writable(Path::new("/proc/scan.glb"))
                .unwrap_err()
                .to_string()
                .starts_with("/proc/scan.glb: ")
        );
        assert!(check_writable_folder(Path::new("/proc/scans")).is_err());
    }
}
