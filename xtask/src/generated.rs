//! Files that are all made from others.

use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use taotie::image::{Encoding, Texels};
use taotie::io::{PngColor, PngImage, PngSamples, read_bitmap, write_png};

/// What should lie on disk.
#[derive(Default)]
pub struct Generated {
    /// What each file holds by its path.
    pub files: BTreeMap<PathBuf, Content>,
    /// A folder that should hold nothing else; it need not be there yet.
    pub folder: Option<PathBuf>,
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// Text.
    Text(String),
    /// A PNG picture. Another file with the same pixels is as good.
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
    /// The paths whose content is not as it should be: changed, missing, or there without a reason; sorted.
    ///
    /// # Errors
    /// Where the folder or a file is there but cannot be read.
    pub fn stale(&self) -> Result<BTreeSet<PathBuf>> {
        let mut stale = BTreeSet::new();
        for (path, content) in &self.files {
            if !content.lies_at(path)? {
                stale.insert(path.clone());
            }
        }
        let left_over = self.present()?.into_iter().filter(|path| !self.files.contains_key(path));
        stale.extend(left_over);
        Ok(stale)
    }

    /// Renews the files at these paths, which [`Self::stale`] gave: writes those that are wanted, removes the others.
    ///
    /// # Errors
    /// Where a file cannot be written or removed.
    pub fn write(&self, stale: &BTreeSet<PathBuf>) -> Result<()> {
        for path in stale {
            match self.files.get(path) {
                Some(content) => content.write(path),
                None => fs::remove_file(path).map_err(Into::into),
            }
            .with_context(|| format!("{}: cannot be renewed", path.display()))?;
        }
        Ok(())
    }

    /// The paths in the folder; none where there is no folder.
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
    fn lies_at(&self, path: &Path) -> Result<bool> {
        match self {
            Self::Text(text) => Ok(read(path)?.as_deref() == Some(text.as_bytes())),
            // Whatever cannot be read as a picture has to be renewed.
            Self::Picture(picture) => Ok(Picture::read(path).as_ref() == Some(picture)),
        }
    }

    fn write(&self, path: &Path) -> Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
        }
        match self {
            Self::Text(text) => Ok(fs::write(path, text)?),
            Self::Picture(picture) => picture.write(path),
        }
    }
}

impl Picture {
    /// The picture in a file of 8 bits a channel.
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

/// A file's bytes, with those of Windows' line ends made plain; `None` where there is no file.
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
    fn pictures_are_the_same_by_their_pixels() -> Result<()> {
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
        assert!(of(1).stale()?.is_empty(), "files beside it are nobody's business");
        fs::write(&path, "no picture")?;
        assert_eq!(of(1).stale()?.len(), 1);
        Ok(())
    }
}
