//! The dependencies of Taotie: whether `deny.toml` allows them, and which of them are not safe Rust.

mod metadata;
mod policy;
mod unsafe_code;

use crate::computed;
use crate::generated::Generated;
use anyhow::{Context, Result, bail};
use metadata::{Lock, Metadata};
use policy::Policy;
use std::path::Path;
use std::process::Command;

/// Returns what `deny.toml` does not allow, a line each.
///
/// # Errors
/// Where cargo does not tell the dependencies, or a file cannot be read.
pub fn faults(root: &Path) -> Result<Vec<String>> {
    let policy = Policy::read(root)?;
    let lock = Lock::read(root)?;
    let licenses = policy.licenses.faults(&Metadata::read(root)?.packages);
    Ok([licenses, policy.bans.faults(&lock.package), policy.sources.faults(&lock.package)].concat())
}

/// `docs/security.md` with its tables as of today.
///
/// # Errors
/// As [`faults`]; where the counts of fuzzing cannot be had.
pub fn generated(root: &Path) -> Result<Generated> {
    let crates = unsafe_code::table(&Metadata::read(root)?)?;
    let fuzzing = fuzzing(root)?;
    computed::page(root, "docs/security.md", |name| match name {
        "crates" => Some(crates.clone()),
        "fuzzing" => Some(fuzzing.clone()),
        _ => None,
    })
}

/// The counts of all fuzzing, as its own program prints them.
fn fuzzing(root: &Path) -> Result<String> {
    output(root, &["run", "--release", "--quiet", "--package", "taotie-fuzz", "--", "table"])
}

/// Runs cargo and returns what it prints.
fn output(root: &Path, arguments: &[&str]) -> Result<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output =
        Command::new(cargo).args(arguments).current_dir(root).output().context("cargo cannot be run")?;
    if !output.status.success() {
        bail!("cargo {}: {}", arguments.join(" "), String::from_utf8_lossy(&output.stderr).trim());
    }
    String::from_utf8(output.stdout).context("cargo printed no text")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dependency_is_allowed() {
        assert_eq!(faults(&crate::root()).unwrap(), [""; 0]);
    }

    /// The program that users build holds C or C++ in three places and much unsafe Rust, but none of its own.
    #[test]
    fn crates_that_are_not_safe_rust_are_found() {
        let table = unsafe_code::table(&Metadata::read(&crate::root()).unwrap()).unwrap();
        let compiled = table.lines().filter(|line| line.contains("| yes |"));
        let names: Vec<&str> = compiled.filter_map(|line| line.split(' ').nth(1)).collect();
        // `re_rav1d` would compile assembly, which its feature `asm` asks for.
        assert_eq!(names, ["libwebp-sys", "meshopt", "re_rav1d", "zstd-sys"]);
        assert!(table.contains("\n| rayon-core | "), "{table}");
        assert!(!table.contains("| taotie"), "{table}");
    }
}
