//! A folder whose files are all made from others.

use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What a folder should hold: these files and no others.
pub struct Generated {
    /// The folder, which need not be there yet.
    pub folder: PathBuf,
    /// The text of each file by its name.
    pub files: BTreeMap<String, String>,
}

impl Generated {
    /// The paths whose content is not as it should be: changed, missing, or there without a reason; sorted.
    ///
    /// # Errors
    /// Where the folder or a file is there but cannot be read.
    pub fn stale(&self) -> Result<BTreeSet<PathBuf>> {
        let mut stale = BTreeSet::new();
        for (name, text) in &self.files {
            let path = self.folder.join(name);
            if read(&path)?.as_deref() != Some(text.as_bytes()) {
                stale.insert(path);
            }
        }
        let left_over = self.present()?.into_iter().filter(|path| self.wanted(path).is_none());
        stale.extend(left_over);
        Ok(stale)
    }

    /// Renews the files at these paths, which [`Self::stale`] gave: writes those that are wanted, removes the others.
    ///
    /// # Errors
    /// Where a file cannot be written or removed.
    pub fn write(&self, stale: &BTreeSet<PathBuf>) -> Result<()> {
        let folder = &self.folder;
        fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
        for path in stale {
            match self.wanted(path) {
                Some(text) => fs::write(path, text),
                None => fs::remove_file(path),
            }
            .with_context(|| format!("{}: cannot be renewed", path.display()))?;
        }
        Ok(())
    }

    fn wanted(&self, path: &Path) -> Option<&String> {
        self.files.get(path.file_name()?.to_str()?)
    }

    /// The paths in the folder; none where there is no folder.
    fn present(&self) -> Result<Vec<PathBuf>> {
        let what = || format!("{}: cannot be listed", self.folder.display());
        match fs::read_dir(&self.folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(error).with_context(what),
            Ok(entries) => {
                entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>().with_context(what)
            }
        }
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
        let files = ["same", "changed", "missing"].map(|name| (name.to_string(), format!("{name}\n")));
        let generated = Generated { folder: folder.clone(), files: BTreeMap::from(files) };
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
}
