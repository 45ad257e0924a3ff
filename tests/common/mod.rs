//! Test data by others, which is not part of the repository.

use std::path::{Path, PathBuf};

/// Returns the folder `sub` of the test data: in `TAOTIE_DATA`, otherwise in `../shared/data` next to the workspace.
/// If it is absent the test must be skipped, which is a failure with `CI=true`.
pub fn data_folder(sub: &str) -> Option<PathBuf> {
    let sibling = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("TAOTIE_DATA").map_or_else(sibling, PathBuf::from).join(sub);
    if folder.exists() {
        return Some(folder);
    }
    absent(&format!("{} does not exist; set TAOTIE_DATA", folder.display()));
    None
}

/// Prints why a test must be skipped, which is a failure with `CI=true`.
pub fn absent(reason: &str) {
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(!required, "test data is required: {reason}");
    #[allow(clippy::print_stderr)]
    {
        eprintln!("skipped: {reason}");
    }
}
