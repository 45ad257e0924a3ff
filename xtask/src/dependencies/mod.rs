//! Checks that `deny.toml` allows the dependencies of Taotie, and lists those that are not safe Rust.

mod cargo;
mod metadata;
mod policy;
mod unsafe_code;

use crate::computed;
use crate::generated::Generated;
use anyhow::Result;
use metadata::{Lock, Metadata};
use policy::Policy;
use std::path::Path;

/// Returns the violations of `deny.toml`, one line each.
///
/// # Errors
/// If cargo fails, or a file cannot be read.
pub fn faults(root: &Path) -> Result<Vec<String>> {
    let policy = Policy::read(root)?;
    let lock = Lock::read(root)?;
    let licenses = policy.licenses.faults(&Metadata::read(root)?.packages);
    Ok([licenses, policy.bans.faults(&lock.package), policy.sources.faults(&lock.package)].concat())
}

/// Returns `docs/security.md` with its tables updated.
///
/// # Errors
/// As for [`faults`], and if the fuzzing counts are not available.
pub fn generated(root: &Path) -> Result<Generated> {
    let crates = unsafe_code::table(&Metadata::read(root)?)?;
    let fuzzing = fuzzing(root)?;
    computed::page(root, "docs/security.md", |name| match name {
        "crates" => Some(crates.clone()),
        "fuzzing" => Some(fuzzing.clone()),
        _ => None,
    })
}

/// Returns the counts of all fuzzing, printed by the fuzzing program.
fn fuzzing(root: &Path) -> Result<String> {
    cargo::output(root, &["run", "--release", "--quiet", "--package", "taotie-fuzz", "--", "table"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dependency_is_allowed() {
        assert_eq!(faults(&crate::root()).unwrap(), [""; 0]);
    }

    /// The program that users build contains C or C++ in a few places and much unsafe Rust, but none in our crates.
    #[test]
    fn crates_that_are_not_safe_rust_are_found() {
        let table = unsafe_code::table(&Metadata::read(&crate::root()).unwrap()).unwrap();
        let compiled = table.lines().filter(|line| line.contains("| yes |"));
        let names: Vec<&str> = compiled.filter_map(|line| line.split(' ').nth(1)).collect();
        // `re_rav1d` would compile assembly, which its feature `asm` asks for.
        assert_eq!(names, ["libwebp-sys", "meshopt", "re_rav1d", "ufbx", "zstd-sys"]);
        assert!(table.contains("\n| rayon-core | "), "{table}");
        assert!(!table.contains("| taotie"), "{table}");
    }
}
