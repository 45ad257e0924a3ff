//! Locates the files that models refer to, whatever system the name was written on.

use super::reading::Reading;
use std::path::{Path, PathBuf};

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

#[cfg(test)]
mod tests {
    use super::super::limits::Limits;
    use super::*;

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
}
