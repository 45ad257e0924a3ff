//! What other programs say of glTF files, through node: the Khronos validator and glTF-Transform.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Severities of the validator below which a message is no fault.
const WARNING: u64 = 1;

/// The folder of what npm installs for tests; `None`, with the reason told, where node or a package in it is missing.
/// Under `CI=true` that is a failure.
pub fn packages(package: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/validator");
    let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    if node && folder.join("node_modules").join(package).is_dir() {
        return Some(folder);
    }
    let reason = format!("no node, or no {package} in {}; `make tools` installs it", folder.display());
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(!required, "npm's packages are needed: {reason}");
    #[allow(clippy::print_stderr)]
    {
        eprintln!("skipped: {reason}");
    }
    None
}

/// That the validator has neither an error nor a warning to tell about the `.glb` or `.gltf` file `path`; what else it
/// tells, one code a line. `None` where the test has to be skipped.
#[allow(dead_code, reason = "each test uses a part")]
pub fn assert_valid(path: &Path) -> Option<Vec<String>> {
    let folder = packages("gltf-validator")?;
    let script = folder.join("validate.mjs");
    let output = Command::new("node").arg(&script).arg(path).output().expect("node starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let messages: Vec<Value> = serde_json::from_slice(&output.stdout).expect("the script prints JSON");
    let text = |message: &Value, key: &str| message[key].as_str().unwrap_or_default().to_owned();
    let line = |m: &Value| format!("{} at {}: {}", text(m, "code"), text(m, "pointer"), text(m, "message"));
    // The validator knows neither KTX2 nor AVIF, which it tells once of the extension and then of each image.
    let told = |of: &str| messages.iter().any(|m| text(m, "message").contains(of));
    let unknown = [("'KHR_texture_basisu'", "image/ktx2"), ("'EXT_texture_avif'", "image/avif")];
    let unknown: Vec<&str> = unknown.iter().filter(|(name, _)| told(name)).map(|(_, kind)| *kind).collect();
    let is_unknown = |m: &Value| {
        unknown.iter().any(|kind| line(m).contains(kind) || text(m, "code") == "IMAGE_UNRECOGNIZED_FORMAT")
    };
    let is_fault = |m: &&Value| m["severity"].as_u64().is_none_or(|severity| severity <= WARNING);
    let (faults, infos): (Vec<_>, Vec<_>) = messages.iter().filter(|m| !is_unknown(m)).partition(is_fault);
    let faults: Vec<String> = faults.into_iter().map(line).collect();
    assert!(faults.is_empty(), "{}:\n{}", path.display(), faults.join("\n"));
    Some(infos.into_iter().map(line).collect())
}

/// What `gltf-transform inspect` prints about a glTF file, as comma-separated values. `None` where the test has to be
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
