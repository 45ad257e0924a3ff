//! OBJ, PLY and STL: files by others, and small ones with known values.

#![allow(clippy::print_stderr)]
mod common;

use std::path::{Path, PathBuf};
use std::time::Instant;
use taotie::io::load_model;

fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a readable folder") {
            let path = entry.expect("a readable entry").path();
            let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
            if path.is_dir() {
                folders.push(path);
            } else if extension.is_some_and(|e| extensions.contains(&e.as_str())) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn every_file_loads_or_says_why_not_in_one_line() {
    let Some(folder) = common::data_folder("") else { return };
    for path in files_below(&folder, &["obj", "ply", "stl"]) {
        let start = Instant::now();
        let text = match load_model(&path) {
            Ok(loaded) => {
                println!("{} {:?} {:?}", path.display(), start.elapsed(), loaded.warnings);
                let triangles = loaded.scene.triangle_count();
                assert!(triangles > 0, "{}", path.display());
                format!("{triangles} triangles, {:?}", loaded.warnings)
            }
            Err(error) => {
                let text = error.to_string();
                println!("{text}");
                assert!(!text.contains('\n'), "{text}");
                assert!(text.contains(&*path.file_name().expect("a name").to_string_lossy()), "{text}");
                text
            }
        };
        assert!(start.elapsed().as_secs() < 20, "{}", path.display());
    }
}
