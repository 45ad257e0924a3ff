//! Generated files.

use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use taotie_engine::image::{Encoding, Texels};
use taotie_io::{PngColor, PngImage, PngSamples, read_bitmap, write_png};

/// Files that should be on disk.
#[derive(Default)]
pub struct Generated {
    /// The content of each file by path.
    pub files: BTreeMap<PathBuf, Content>,
    /// A folder that should contain nothing else; it need not exist yet.
    pub folder: Option<PathBuf>,
}

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// Text.
    Text(String),
    /// A PNG picture. Files with the same pixels are equivalent.
    Picture(Picture),
}

/// 8-bit sRGB pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

impl Generated {
    /// Returns the paths with wrong content, sorted: changed, missing or unexpected files.
    ///
    /// # Errors
    /// If the folder or a file exists but cannot be read.
    pub fn stale(&self) -> Result<BTreeSet<PathBuf>> {
        let mut stale = BTreeSet::new();
        for (path, content) in &self.files {
            if !content.is_at(path)? {
                stale.insert(path.clone());
            }
        }
        let left_over = self.present()?.into_iter().filter(|path| !self.files.contains_key(path));
        stale.extend(left_over);
        Ok(stale)
    }

    /// Updates the files at these paths, which [`Self::stale`] returned: writes expected files and removes others.
    ///
    /// # Errors
    /// If a file cannot be written or removed.
    pub fn write(&self, stale: &BTreeSet<PathBuf>) -> Result<()> {
        for path in stale {
            match self.files.get(path) {
                Some(content) => content.write(path),
                None => fs::remove_file(path).map_err(Into::into),
            }
            .with_context(|| format!("{}: cannot be updated", path.display()))?;
        }
        Ok(())
    }

    /// Returns the paths in the folder; empty if it does not exist.
    fn present(&self) -> Result<Vec<PathBuf>> {
        let Some(folder) = &self.folder else { return Ok(Vec::new()) };
        let what = || format!("{}: cannot be listed", folder.display());
        match fs::read_dir(folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(error).with_context(what),
            Ok(entries) => {
                entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>().with_context(what)
            }
        }
    }
}

impl Content {
    fn is_at(&self, path: &Path) -> Result<bool> {
        match self {
            Self::Text(text) => Ok(read(path)?.as_deref() == Some(text.as_bytes())),
            // A file that cannot be read as a picture is stale.
            Self::Picture(picture) => Ok(Picture::read(path).as_ref() == Some(picture)),
        }
    }

    fn write(&self, path: &Path) -> Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
        }
        match self {
            Self::Text(text) => Ok(fs::write(path, text)?),
            Self::Picture(picture) => picture.write(path),
        }
    }
}

impl Picture {
    /// Reads a picture with 8 bits per channel.
    fn read(path: &Path) -> Option<Self> {
        let bitmap = read_bitmap(path).ok()?;
        let Texels::U8(texels) = bitmap.texels() else { return None };
        let pixels = texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
        Some(Self { width: bitmap.width(), height: bitmap.height(), pixels })
    }

    fn write(&self, path: &Path) -> Result<()> {
        let image = PngImage {
            width: self.width,
            height: self.height,
            color: PngColor::Rgb,
            samples: PngSamples::U8(self.pixels.as_flattened()),
            encoding: Encoding::Srgb,
        };
        Ok(write_png(path, &image)?)
    }
}

/// Reads a file, with Windows line endings normalised; `None` if there is no file.
fn read(path: &Path) -> Result<Option<Vec<u8>>> {
    match fs::read(path) {
        Ok(mut bytes) => {
            bytes.retain(|byte| *byte != b'\r');
            Ok(Some(bytes))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| format!("{}: cannot be read", path.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_missing_and_left_over_files_are_stale_until_written() -> Result<()> {
        let place = tempfile::tempdir()?;
        let folder = place.path().join("made");
        let text = |name: &str| (folder.join(name), Content::Text(format!("{name}\n")));
        let files = BTreeMap::from(["same", "changed", "missing"].map(text));
        let generated = Generated { files, folder: Some(folder.clone()) };
        assert_eq!(generated.stale()?.len(), 3);

        fs::create_dir(&folder)?;
        fs::write(folder.join("same"), "same\r\n")?;
        fs::write(folder.join("changed"), "old\n")?;
        fs::write(folder.join("left over"), "")?;
        let stale = generated.stale()?;
        assert_eq!(stale, BTreeSet::from(["changed", "left over", "missing"].map(|name| folder.join(name))));

        generated.write(&stale)?;
        assert!(generated.stale()?.is_empty());
        assert!(!folder.join("left over").exists());
        assert_eq!(fs::read_to_string(folder.join("missing"))?, "missing\n");
        Ok(())
    }

    #[test]
    fn pictures_are_compared_by_their_pixels() -> Result<()> {
        let place = tempfile::tempdir()?;
        let path = place.path().join("p.png");
        let picture = |grey: u8| Picture { width: 2, height: 1, pixels: vec![[grey; 3], [7, 8, 9]] };
        let of = |grey| Generated {
            files: BTreeMap::from([(path.clone(), Content::Picture(picture(grey)))]),
            ..Generated::default()
        };
        assert_eq!(of(1).stale()?.len(), 1, "missing");
        of(1).write(&of(1).stale()?)?;
        assert!(of(1).stale()?.is_empty());
        assert_eq!(of(2).stale()?.len(), 1, "one pixel differs");
        fs::write(place.path().join("other"), "")?;
        assert!(of(1).stale()?.is_empty(), "files next to it are ignored");
        fs::write(&path, "no picture")?;
        assert_eq!(of(1).stale()?.len(), 1);
        Ok(())
    }
}
