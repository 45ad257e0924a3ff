//! A separate folder for each test, in which the command runs.

use super::schemas;
use serde_json::Value;
use snapbox::cmd::Command;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder that is removed at the end, and a separate one for temporary files.
pub struct Place {
    folder: TempDir,
    temporary: TempDir,
}

impl Place {
    /// Creates an empty folder.
    pub fn new() -> Self {
        let folder = || tempfile::tempdir().expect("temporary folders can be made");
        Self { folder: folder(), temporary: folder() }
    }

    /// Creates a folder with one file.
    pub fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let place = Self::new();
        place.write(name, content);
        place
    }

    /// Returns the path of a file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("the folder can be written to");
    }

    /// Reads a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Returns every name in it, sorted; fails if any temporary file is left.
    pub fn files(&self) -> Vec<String> {
        assert_eq!(names(self.temporary.path()), [""; 0], "temporary files are left");
        names(self.folder.path())
    }

    /// Returns the command with the words of `line`, to run in the folder.
    pub fn taotie(&self, line: &str) -> Command {
        self.taotie_with(&line.split_whitespace().collect::<Vec<_>>())
    }

    /// Returns the command with these arguments.
    pub fn taotie_with(&self, arguments: &[&str]) -> Command {
        Command::from_std(self.process(arguments))
    }

    /// Like [`Place::taotie_with`], to be started by hand.
    pub fn process(&self, arguments: &[&str]) -> std::process::Command {
        let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_taotie"));
        process.args(arguments).args(quick_proof(arguments)).current_dir(self.folder.path());
        process.env("TMPDIR", self.temporary.path()).env_remove("RUST_BACKTRACE");
        process
    }

    /// Runs a command that must succeed, and returns its stdout as JSON, which must be as its schema states.
    pub fn json(&self, line: &str) -> Value {
        let assert = self.taotie(line).assert().success();
        let document =
            serde_json::from_slice(&assert.get_output().stdout).expect("stdout is one JSON document");
        schemas::check_printed(line.split_whitespace(), &document);
        document
    }

    /// Runs a command that must succeed, and returns its stdout as text.
    pub fn text(&self, line: &str) -> String {
        let assert = self.taotie(line).assert().success();
        String::from_utf8(assert.get_output().stdout.clone()).expect("stdout is text")
    }
}

/// Returns options for a proof in a tenth of the time, unless the test states what it needs.
fn quick_proof(arguments: &[&str]) -> &'static [&'static str] {
    let asks =
        |argument: &&str| argument.starts_with("--proof-") || ["--no-verify", "--help"].contains(argument);
    match arguments {
        ["bake" | "verify", rest @ ..] if !rest.iter().any(asks) => {
            &["--proof-points", "20000", "--proof-view", "96"]
        }
        _ => &[],
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the folder is readable");
    let mut names: Vec<String> = entries
        .map(|entry| entry.expect("it is readable").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
