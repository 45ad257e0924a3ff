//! The results of other programs for glTF files, through node: the Khronos validator and glTF-Transform.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The highest severity number of the validator that counts as a fault.
const WARNING: u64 = 1;

/// Returns the folder of the npm packages for tests; prints why and returns `None` if node or a package in it is
/// missing. With `CI=true` that is a failure.
pub fn packages(package: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/validator");
    let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    if node && folder.join("node_modules").join(package).is_dir() {
        return Some(folder);
    }
    let reason = format!("no node, or no {package} in {}; `make tools` installs it", folder.display());
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(!required, "npm packages are required: {reason}");
    #[allow(clippy::print_stderr)]
    {
        eprintln!("skipped: {reason}");
    }
    None
}

/// Asserts that the validator reports neither an error nor a warning for the `.glb` or `.gltf` file `path`; returns
/// its other messages, one code per line. `None` if the test must be skipped.
#[allow(dead_code, reason = "each test uses a part")]
pub fn assert_valid(path: &Path) -> Option<Vec<String>> {
    let folder = packages("gltf-validator")?;
    let script = folder.join("validate.mjs");
    let output = Command::new("node").arg(&script).arg(path).output().expect("node starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let messages: Vec<Value> = serde_json::from_slice(&output.stdout).expect("the script prints JSON");
    let text = |message: &Value, key: &str| message[key].as_str().unwrap_or_default().to_owned();
    let line = |m: &Value| format!("{} at {}: {}", text(m, "code"), text(m, "pointer"), text(m, "message"));
    // The validator knows neither KTX2 nor AVIF, which it reports once for the extension and then for each image.
    let seen = |of: &str| messages.iter().any(|m| text(m, "message").contains(of));
    let unknown = [("'KHR_texture_basisu'", "image/ktx2"), ("'EXT_texture_avif'", "image/avif")];
    let unknown: Vec<&str> = unknown.iter().filter(|(name, _)| seen(name)).map(|(_, kind)| *kind).collect();
    let is_unknown = |m: &Value| {
        unknown.iter().any(|kind| line(m).contains(kind) || text(m, "code") == "IMAGE_UNRECOGNIZED_FORMAT")
    };
    let is_fault = |m: &&Value| m["severity"].as_u64().is_none_or(|severity| severity <= WARNING);
    let (faults, infos): (Vec<_>, Vec<_>) = messages.iter().filter(|m| !is_unknown(m)).partition(is_fault);
    let faults: Vec<String> = faults.into_iter().map(line).collect();
    assert!(faults.is_empty(), "{}:\n{}", path.display(), faults.join("\n"));
    Some(infos.into_iter().map(line).collect())
}

/// Returns the output of `gltf-transform inspect` for a glTF file, as comma-separated values. `None` if the test must
/// be
/// skipped.
#[allow(dead_code, reason = "each test uses a part")]
pub fn inspected(path: &Path) -> Option<String> {
    let program = packages("@gltf-transform/cli")?.join("node_modules/@gltf-transform/cli/bin/cli.js");
    let line = Command::new("node").arg(program).arg("inspect").arg(path).args(["--format", "csv"]).output();
    let output = line.expect("node starts");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let faults = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !faults.contains("error"), "{said}{faults}");
    Some(said)
}
