//! Runs of cargo.

use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;

/// Runs cargo and returns what it prints.
pub fn output(root: &Path, arguments: &[&str]) -> Result<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output =
        Command::new(cargo).args(arguments).current_dir(root).output().context("cargo cannot be run")?;
    if !output.status.success() {
        bail!("cargo {}: {}", arguments.join(" "), String::from_utf8_lossy(&output.stderr).trim());
    }
    String::from_utf8(output.stdout).context("the output of cargo is not valid UTF-8")
}
