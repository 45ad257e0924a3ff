//! The command, and numbers in its JSON output.

use crate::schemas;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Options of a bake whose views are not used.
pub const SMALL_VIEWS: [&str; 2] = ["--proof-view", "96"];

/// Runs the command in a folder and returns its output.
pub fn json(args: &[&str], folder: &Path) -> Value {
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .args(args)
        .arg("--json")
        .current_dir(folder)
        .output()
        .expect("the command runs");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{args:?}: {said}");
    let document = serde_json::from_slice(&run.stdout).expect("stdout is one JSON document");
    schemas::check_printed(args.iter().copied(), &document);
    document
}

pub fn number(report: &Value, path: &str) -> f64 {
    report.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {report}"))
}
