//! What integration tests share.

use std::path::{Path, PathBuf};

/// The folder `sub` of the test data by others: below `TAOTIE_DATA`, else below `../shared/data` beside the workspace.
/// `None`, with the reason printed, where it is absent; on CI that is a failure.
pub fn data_folder(sub: &str) -> Option<PathBuf> {
    let root = match std::env::var_os("TAOTIE_DATA") {
        Some(root) => PathBuf::from(root),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
    };
    let folder = root.join(sub);
    if folder.exists() {
        return Some(folder);
    }
    let reason = format!("{} is not there; set TAOTIE_DATA", folder.display());
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{reason}");
    eprintln!("skipped: {reason}");
    None
}
