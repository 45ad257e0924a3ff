//! Test data by others, which is not part of the repository.

use std::path::{Path, PathBuf};

/// The folder `sub` of the test data: in `TAOTIE_DATA`, else in `../shared/data` beside the workspace. Where it is
/// absent the test has to be skipped, which is a failure under `CI=true`.
pub fn data_folder(sub: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("TAOTIE_DATA").map_or_else(beside, PathBuf::from).join(sub);
    if folder.exists() {
        return Some(folder);
    }
    let reason = format!("{} does not exist; set TAOTIE_DATA", folder.display());
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(!required, "test data is needed: {reason}");
    #[allow(clippy::print_stderr)]
    {
        eprintln!("skipped: {reason}");
    }
    None
}

/// Every file below `folder` whose extension, in lower case, is one of `extensions`; sorted.
#[allow(dead_code)]
pub fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let wanted = |path: &PathBuf| {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        extension.is_some_and(|e| extensions.contains(&e.as_str()))
    };
    all_files_below(folder).into_iter().filter(wanted).collect()
}

/// Every file below `folder`; sorted.
#[allow(dead_code)]
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
