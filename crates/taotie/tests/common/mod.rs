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
    absent(&format!("{} does not exist; set TAOTIE_DATA", folder.display()));
    None
}

/// Tells why a test has to be skipped, which is a failure under `CI=true`.
pub fn absent(reason: &str) {
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(!required, "test data is needed: {reason}");
    #[allow(clippy::print_stderr)]
    {
        eprintln!("skipped: {reason}");
    }
}
