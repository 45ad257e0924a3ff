//! A collection in its own folder.

use crate::balls::{Ball, SCAN};
use crate::files::all_files_below;
use crate::photographed::{LIGHTS, photograph};
use crate::schemas;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use tempfile::TempDir;

/// The options for balls, baked quickly.
pub const QUICK: &str = "
[bake]
triangles = 100
size = 64

[verify]
points = 1000
map = 64
view = 32

[thumbnail]
size = 32
";

/// A small ball; other wave heights make other scans.
pub fn ball(waves: f64) -> String {
    Ball { rings: 16, meridians: 32, waves, ..SCAN }.obj()
}

/// A folder with scans and `collection.toml`.
pub struct Collection {
    folder: TempDir,
}

impl Collection {
    /// Creates a collection of everything below `scans`.
    pub fn new(options: &str) -> Self {
        let folder = tempfile::tempdir().expect("temporary folders can be made");
        std::fs::create_dir(folder.path().join("scans")).expect("it can be written to");
        let collection = Self { folder };
        collection.configure(options);
        collection
    }

    /// Creates a collection of `count` balls.
    pub fn of_balls(count: usize) -> Self {
        let collection = Self::new(QUICK);
        for index in 0..count {
            collection.write(&format!("scans/ball{index}.obj"), ball(0.01 + 0.002 * index as f64));
        }
        collection
    }

    /// Creates a collection of a ball and two folders of photographs, `coins/a` and `coins/b`.
    pub fn of_photographs() -> Self {
        let collection = Self::of_balls(1);
        std::fs::create_dir(collection.path("scans/coins")).expect("it is new");
        collection.photograph("scans/coins/a");
        collection.photograph("scans/coins/b");
        // Without the last one, its result is another.
        let lp = std::fs::read_to_string(collection.path("scans/coins/b/dome.lp")).expect("it was written");
        let kept = lp.lines().take(LIGHTS).skip(1);
        let lp = format!("{}\n{}\n", LIGHTS - 1, kept.collect::<Vec<_>>().join("\n"));
        collection.write("scans/coins/b/dome.lp", lp);
        std::fs::remove_file(collection.path(&format!("scans/coins/b/p{}.exr", LIGHTS - 1)))
            .expect("it exists");
        collection
    }

    /// Creates a folder of photographs.
    pub fn photograph(&self, name: &str) {
        static FOLDER: OnceLock<TempDir> = OnceLock::new();
        let folder = FOLDER.get_or_init(|| {
            let folder = tempfile::tempdir().expect("temporary folders can be made");
            photograph(folder.path());
            std::fs::remove_file(folder.path().join("waves.obj")).expect("it was written");
            folder
        });
        std::fs::create_dir(self.path(name)).expect("it is new");
        for path in all_files_below(folder.path()) {
            let target = self.path(name).join(path.file_name().expect("it is a file"));
            std::fs::copy(path, target).expect("it can be written");
        }
    }

    /// Rewrites `collection.toml`.
    pub fn configure(&self, options: &str) {
        let (top, tables) = options.split_at(options.find("\n[").unwrap_or(options.len()));
        let text = format!("output = \"out\"\n{top}\n[[source]]\nfolder = \"scans\"\n{tables}");
        self.write("collection.toml", text);
    }

    /// Writes a file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("it can be written");
    }

    /// Returns the path of a file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Returns the command, to be started.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_taotie"));
        command.arg("batch").args(line.split_whitespace()).current_dir(self.folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.env_remove("RUST_BACKTRACE");
        command
    }

    /// Works through it with further arguments.
    pub fn run(&self, line: &str) -> Output {
        self.command(&format!("collection.toml {line}")).output().expect("the command runs")
    }

    /// Works through it; returns the exit code and the report.
    pub fn report(&self, line: &str) -> (Option<i32>, Value) {
        let output = self.run(&format!("--json {line}"));
        let stderr = String::from_utf8_lossy(&output.stderr);
        let report =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {stderr}"));
        schemas::check_printed(["batch"].into_iter().chain(line.split_whitespace()), &report);
        (output.status.code(), report)
    }

    /// Returns all records, in order.
    pub fn records(&self) -> Vec<Value> {
        let text = std::fs::read(self.path("out/manifest.jsonl")).expect("there is a manifest");
        let lines = text.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
        let records: Vec<Value> = lines.filter_map(|line| serde_json::from_slice(line).ok()).collect();
        // Records of earlier versions stay in a manifest.
        let current = schemas::number("batch-manifest");
        let is_current = |record: &&Value| record["schema"].as_u64().is_none_or(|number| number >= current);
        records.iter().filter(is_current).for_each(|record| schemas::check("batch-manifest", record));
        records
    }

    /// Returns the last record of each asset.
    pub fn last(&self) -> BTreeMap<String, Value> {
        self.records().into_iter().map(|record| (text(&record, "/id"), record)).collect()
    }

    /// Returns true if `count` assets have a record.
    pub fn is_complete(&self, count: usize) -> bool {
        self.path("out/manifest.jsonl").exists() && self.last().len() == count
    }

    /// Returns every file of all objects with its bytes. Fails if anything is unfinished.
    pub fn objects(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        objects(&self.path("out"))
    }
}

/// Returns every file of all objects of a collection's folder. Fails if anything hidden is left.
pub fn objects(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = all_files_below(&root.join("objects"));
    let hidden = files.iter().find(|path| path.to_string_lossy().contains("/.taotie"));
    assert_eq!(hidden, None, "a temporary file is left");
    let read = |path: &PathBuf| std::fs::read(path).expect("it can be read");
    let name = |path: &PathBuf| path.strip_prefix(root).expect("it is below the root").to_path_buf();
    files.iter().map(|path| (name(path), read(path))).collect()
}

/// Returns a text of a record.
pub fn text(record: &Value, path: &str) -> String {
    record.pointer(path).and_then(Value::as_str).unwrap_or_else(|| panic!("{path} in {record}")).to_owned()
}

/// Returns a number of a record.
pub fn number(record: &Value, path: &str) -> f64 {
    record.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {record}"))
}

/// Asserts that no object was made twice: existing ones are reused.
pub fn assert_nothing_twice(records: &[Value]) {
    let mut made = BTreeMap::new();
    for record in records {
        for part in record["parts"].as_array().expect("a list").iter().filter(|part| part["reused"] == false)
        {
            let address = text(part, "/address");
            let before = made.insert(address, text(record, "/id"));
            assert_eq!(before, None, "{} was made twice", record["id"]);
        }
    }
}
