//! Where tests find data that is not in the repository.
#![allow(dead_code, clippy::print_stderr)]

use std::path::{Path, PathBuf};

/// The folder `sub` of the test data: in `TAOTIE_DATA` if set, else in `../shared/data` beside the workspace.
///
/// Where it is absent the test has nothing to do: `None`, and a line that says so. In CI (`CI=true`) it panics, so
/// that no test is skipped unseen.
pub fn data_folder(sub: &str) -> Option<PathBuf> {
    let root = match std::env::var_os("TAOTIE_DATA") {
        Some(folder) => PathBuf::from(folder),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
    };
    let folder = root.join(sub);
    if folder.exists() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "test data missing in CI: {}", folder.display());
    eprintln!("skipped: no test data at {} (set TAOTIE_DATA)", folder.display());
    None
}
