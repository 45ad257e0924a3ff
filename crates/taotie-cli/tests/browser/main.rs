//! Pages in a real browser: the report page in use, and written GLBs as three.js draws them.
//!
//! Rust writes the pages and models, node drives the browser with the scripts of `tests/browser`. Their inputs
//! stay in `target/tmp`: `report-pages`, `same-in-threejs`, `shader-material` and `viewer`.
#![allow(clippy::print_stdout, reason = "tests print their findings and why they are skipped")]

mod collection;
#[allow(dead_code)]
#[path = "../../../../tests/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "../../../../tests/common/files.rs"]
mod files;
mod node;
mod pages;
mod same_in_threejs;
mod shader_material;
mod threejs;
mod viewer;

use node::Node;
use std::path::{Path, PathBuf};

/// Creates an empty folder of this name that outlives the test.
fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // It does not exist at first.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    folder
}

/// The assertions are in the script.
#[test]
fn the_page_of_a_collection_does_what_a_hand_asks_for() {
    let Some(node) = Node::find() else { return };
    let folder = empty_folder("collection-page");
    collection::write(&folder);
    node.run(&["--test", "--test-reporter=spec", "collection.test.mjs"], &folder);
}

/// The assertions are in the scripts.
#[test]
fn report_pages_do_what_a_hand_asks_for() {
    let Some(node) = Node::find() else { return };
    let folder = empty_folder("report-pages");
    pages::write_all(&folder);
    pages::compare(&folder);
    let options = ["--test", "--test-reporter=spec", "--test-concurrency=2"];
    // Named explicitly, since node succeeds if it finds no tests.
    let scripts = ["pictures.test.mjs", "page.test.mjs"];
    node.run(&[options.as_slice(), &scripts].concat(), &folder);
}
