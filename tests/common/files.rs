//! The files of the test data by others.

use crate::common::data_folder;
use std::path::{Path, PathBuf};

/// Returns every file in the folder `sub` of the test data, at any depth, whose extension is one of `extensions`;
/// sorted. If the folder is absent, prints why and returns an empty list; a folder without any such file is a
/// failure.
pub fn data_files(sub: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let Some(folder) = data_folder(sub) else { return Vec::new() };
    let found = files_below(&folder, extensions);
    assert!(!found.is_empty(), "{} holds no file of {extensions:?}", folder.display());
    found
}

/// Returns every file in `folder`, at any depth, whose extension, in lower case, is one of `extensions`; sorted.
pub fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let wanted = |path: &PathBuf| {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        extension.is_some_and(|e| extensions.contains(&e.as_str()))
    };
    all_files_below(folder).into_iter().filter(wanted).collect()
}

/// Returns every file in `folder`, at any depth; sorted.
pub fn all_files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut waiting = vec![folder.to_path_buf()];
    while let Some(folder) = waiting.pop() {
        for entry in std::fs::read_dir(&folder).expect("the folder is readable") {
            let path = entry.expect("the folder is readable").path();
            if path.is_dir() { waiting.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    found
}
