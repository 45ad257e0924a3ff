//! The files of a folder: its page lists them with their hashes, so that a later page replaces only these, and only if
//! they are unchanged.

use super::document::{PageFile, linked};
use super::iiif::MANIFESTS;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result};
use taotie_io::{read_bytes, sha256, sha256_of};

/// The name of the page.
const PAGE: &str = "index.html";

/// The name of the model.
const MODEL: &str = "asset.glb";

/// The element of a page that lists the files of its folder.
const START: &str = "<script type=\"application/json\" id=\"taotie-files\">";
const END: &str = "</script>\n";

/// Returns the page of a folder, followed by its other files.
pub(super) fn with_page(title: &str, mut files: Vec<PageFile>) -> Vec<PageFile> {
    let plain = PageFile { name: PAGE.into(), bytes: linked(title, "").into_bytes() };
    let hashes = files.iter().chain([&plain]).map(|file| (file.name.as_str(), sha256_of(&file.bytes)));
    let list = serde_json::json!(hashes.collect::<BTreeMap<_, _>>());
    let bytes = linked(title, &format!("{START}{list}{END}")).into_bytes();
    files.insert(0, PageFile { bytes, ..plain });
    files
}

/// The files of a folder that its page lists, by name, with the SHA-256 of each: that of the page is without its list.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FolderFiles {
    folder: PathBuf,
    hashes: BTreeMap<String, String>,
}

impl FolderFiles {
    /// Reads the list of the page in a folder; an empty one if it has no such page.
    pub fn read(folder: &Path) -> Self {
        let page = read_bytes(&folder.join(PAGE)).ok().and_then(|bytes| String::from_utf8(bytes).ok());
        Self { folder: folder.to_path_buf(), hashes: page.and_then(|page| listed(&page)).unwrap_or_default() }
    }

    /// Returns the names of the files that every folder has, and those of its manifests if it has an address.
    pub fn main_names(has_address: bool) -> impl Iterator<Item = &'static str> {
        [PAGE, MODEL].into_iter().chain(MANIFESTS.into_iter().filter(move |_| has_address))
    }

    /// Rejects files that cannot be replaced: existing ones that are not listed, or have changed since.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the path of the first one.
    pub fn check<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Result<()> {
        match names
            .into_iter()
            .find(|name| self.folder.join(name).symlink_metadata().is_ok() && !self.is_own(name))
        {
            Some(name) => Err(Error::invalid(
                self.folder.join(name).display().to_string(),
                "it would be overwritten, but `taotie view` did not write it, or it has changed since; move it away, \
                 or choose another folder",
            )),
            None => Ok(()),
        }
    }

    /// Returns the paths of unchanged files that are not in `names`, such as those of a scan published earlier.
    pub fn others(&self, names: &[&str]) -> Vec<PathBuf> {
        let is_other = |name: &&String| !names.contains(&name.as_str()) && self.is_own(name);
        self.hashes.keys().filter(is_other).map(|name| self.folder.join(name)).collect()
    }

    fn is_own(&self, name: &str) -> bool {
        let hash = self.hashes.get(name);
        // The page itself was compared when its list was read.
        hash.is_some_and(|hash| {
            name == PAGE || sha256(&self.folder.join(name)).is_ok_and(|found| found == *hash)
        })
    }
}

/// Returns `true` if pages have files with such a name.
fn is_of_pages(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    MANIFESTS.contains(&name) || matches!(extension, Some("glb" | "bin" | "jpg"))
}

/// Returns the files that a page lists: the page itself only if it is unchanged, and none outside its folder.
fn listed(page: &str) -> Option<BTreeMap<String, String>> {
    let (before, rest) = page.split_once(START)?;
    let (list, after) = rest.split_once(END)?;
    let mut hashes: BTreeMap<String, String> = serde_json::from_str(list).ok()?;
    let own = sha256_of([before, after].concat().as_bytes());
    hashes.retain(|name, hash| match name.as_str() {
        PAGE => *hash == own,
        other => Path::new(other).file_name().is_some_and(|name| name == other) && is_of_pages(other),
    });
    Some(hashes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, files: &[PageFile]) {
        files.iter().for_each(|file| std::fs::write(folder.join(&file.name), &file.bytes).unwrap());
    }

    fn page() -> Vec<PageFile> {
        let file = |name: &str| PageFile { name: name.into(), bytes: name.into() };
        with_page("A </script> title", vec![file(MODEL), file("scan.glb")])
    }

    #[test]
    fn only_unchanged_files_of_a_page_can_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (here, names) = (folder.path(), [PAGE, MODEL, "scan.glb", "manifest.json"]);
        let check = |names: &[&str]| FolderFiles::read(here).check(names.iter().copied());
        assert!(check(&names).is_ok(), "an empty folder");
        write(here, &page());
        assert!(check(&names).is_ok());
        assert_eq!(FolderFiles::read(here).others(&[PAGE, MODEL]), [here.join("scan.glb")]);

        for name in [MODEL, "manifest.json"] {
            std::fs::write(here.join(name), "the user's").unwrap();
            assert!(check(&[PAGE, "scan.glb"]).is_ok());
            let error = check(&names).unwrap_err().to_string();
            assert!(error.starts_with(here.join(name).to_str().unwrap()), "{error}");
            std::fs::remove_file(here.join(name)).unwrap();
        }
        let text = String::from_utf8(page()[0].bytes.clone()).unwrap();
        std::fs::write(here.join(PAGE), text.replace("title", "heading")).unwrap();
        assert!(check(&[PAGE]).is_err() && check(&["scan.glb"]).is_ok(), "an edited page");
        std::fs::write(here.join(PAGE), "<taotie-viewer src=\"vase/\">").unwrap();
        assert!(check(&[PAGE]).is_err() && check(&["scan.glb"]).is_err(), "another page");
    }

    #[test]
    fn a_list_names_no_file_elsewhere() {
        let list = format!("{START}{{\"../a\":\"1\",\"/b\":\"2\",\"c.bin\":\"3\"}}{END}");
        assert_eq!(listed(&list).unwrap().into_keys().collect::<Vec<_>>(), ["c.bin"]);
    }
}
