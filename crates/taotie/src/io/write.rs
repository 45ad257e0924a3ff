//! Writes images and reports to files, each under a temporary name and then renamed, so that no half a file is left.

mod animated_image;
#[cfg(feature = "exr")]
mod exr;
mod files;
mod gltf;
mod png;
mod still_image;
mod writable;

pub use animated_image::{AnimatedImage, AnimationFormat, AnimationSpec};
#[cfg(feature = "exr")]
pub use exr::{ExrLayer, write_exr};
pub use files::{FileBytes, write_files};
pub use gltf::{
    GltfAsset, GltfDraft, GltfFormat, GltfGraft, GltfImage, GltfImages, GltfLevel, GltfMaterial,
    GraftedMaterial, WrittenScene, encode_glb, encode_gltf, encode_graft, encode_scene, write_gltf,
    write_scene,
};
pub use png::{PngColor, PngImage, PngSamples, encode_png, encode_png_bitmap, write_png, write_png_bitmap};
pub use still_image::{ImageFormat, write_developed, write_image};
pub use writable::{check_writable, check_writable_folder};

use crate::error::{Error, Result};
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes `bytes` to `path`, whole or not at all.
///
/// # Errors
/// [`Error::Io`] naming the folder where that is missing, or the path where the system refuses.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write_with(path, |out| out.write_all(bytes).map_err(|e| Error::io(path, e)))
}

/// Writes `text` to `path`, whole or not at all.
///
/// # Errors
/// As [`write_bytes`].
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_bytes(path, text.as_bytes())
}

/// A target to write to, at any place.
trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

/// Lets `fill` write to a temporary file beside `path`, then renames it. The file is removed where anything fails.
fn write_with(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> Result<()>) -> Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER, draft(path)?);
    fill(&mut out)?;
    let file = out.into_inner().map_err(|e| Error::io(path, e.into_error()))?;
    file.persist(path).map_err(|e| Error::io(path, e.error))?;
    Ok(())
}

/// The number of bytes written to a file at once.
const BUFFER: usize = 1 << 16;

/// Makes a temporary file beside `path`, to be renamed when it is whole; it is removed where that never comes.
fn draft(path: &Path) -> Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let why = io::Error::new(io::ErrorKind::NotFound, "there is no such folder; make it first");
        return Err(Error::io(folder, why));
    }
    if path.is_dir() {
        let why = io::Error::new(io::ErrorKind::InvalidInput, "it is a folder; give a file name");
        return Err(Error::io(path, why));
    }
    draft_in(folder).map_err(|e| Error::io(path, e))
}

/// Makes a temporary file in a folder that is there.
fn draft_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".taotie-").suffix(".part");
    public_permissions(&mut builder);
    builder.tempfile_in(folder)
}

/// Makes a temporary file as readable as any other new file; by default it is private.
#[cfg(unix)]
fn public_permissions(builder: &mut tempfile::Builder) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(std::fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn public_permissions(_builder: &mut tempfile::Builder) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_whole_files_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a b.txt");
        write_text(&path, "first, and longer").unwrap();
        write_text(&path, "second").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
        let failed = write_with(&path, |out| {
            out.write_all(b"half").unwrap();
            Err(Error::invalid("x", "y"))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = write_text(Path::new("no/such/folder/x.txt"), "").unwrap_err().to_string();
        assert!(error.contains("no/such/folder") && error.contains("no such folder"), "{error}");
        assert!(write_text(&std::env::temp_dir(), "").unwrap_err().to_string().contains("is a folder"));
    }
}
