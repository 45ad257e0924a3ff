//! What the tests share.

use std::path::{Path, PathBuf};

/// The folder `sub` of the test data by others, or `None` where it is absent.
///
/// The data lie in the folder that the environment variable `TAOTIE_DATA` names, else beside the repository in
/// `shared/data`. Where the variable `CI` is `true`, absence is a failure.
pub fn data_folder(sub: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("TAOTIE_DATA").map_or(beside, PathBuf::from);
    let folder = root.join(sub);
    if folder.exists() {
        return Some(folder);
    }
    let reason = format!("no {}; set TAOTIE_DATA to the folder of test data", folder.display());
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{reason}");
    println!("skipped: {reason}");
    None
}
