//! Finding the files that models name, whatever system the name was written on.

use std::path::{Path, PathBuf};

/// Finds the file that a name written on any system means: as it stands below one of `folders`, else its last part
/// beside them, else the same without regard to upper and lower case.
pub(super) fn find(name: &str, folders: &[&Path]) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    let last = name.rsplit('/').next().unwrap_or(&name);
    let candidates = [name.as_str(), last];
    for candidate in candidates.iter().filter(|c| !c.is_empty()) {
        for folder in folders {
            let path = folder.join(candidate);
            if path.is_file() {
                return Some(path);
            }
        }
    }
    folders.iter().find_map(|folder| find_any_case(last, folder))
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
    use super::*;

    #[test]
    fn finds_names_of_other_systems() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("Maps")).unwrap();
        std::fs::write(folder.path().join("Maps/a.png"), "").unwrap();
        std::fs::write(folder.path().join("B c.PNG"), "").unwrap();
        let found = |name: &str| find(name, &[Path::new("no such folder"), folder.path()]);
        assert!(found("Maps\\a.png").is_some_and(|p| p.ends_with("Maps/a.png")));
        assert!(found("C:\\Users\\me\\b C.png").is_some_and(|p| p.ends_with("B c.PNG")));
        assert!(found("/home/me/B c.PNG").is_some());
        assert_eq!((found("Maps"), found(""), found("d.png")), (None, None, None));
    }
}
