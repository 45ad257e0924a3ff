//! The crates built into the command that contain unsafe Rust or compile C or C++.

use super::metadata::{Metadata, Package};
use anyhow::{Context, Result};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The program that users build.
const PROGRAM: &str = "taotie-cli";

/// The keywords that start unsafe code.
const BEGINS: [&str; 5] = ["unsafe {", "unsafe fn", "unsafe impl", "unsafe extern", "unsafe trait"];

/// The maximum number of direct dependencies that are listed.
const MOST_DOORS: usize = 3;

/// Returns the table, with a line for each crate that is not entirely safe Rust, by name.
///
/// # Errors
/// If the source of a crate cannot be read.
pub fn table(metadata: &Metadata) -> Result<String> {
    let built = metadata.built_into(PROGRAM);
    let mut lines = BTreeSet::new();
    for package in metadata.packages.iter().filter(|package| package.source.is_some()) {
        let Some(doors) = built.get(package.name.as_str()) else { continue };
        let (count, compiles) = (unsafe_lines(package)?, metadata.compiles_others(&package.id));
        if count > 0 || compiles {
            let compiled = if compiles { "yes" } else { "" };
            lines.insert(format!("| {} | {count} | {compiled} | {} |", package.name, named(doors)));
        }
    }
    let head = "| crate | lines with unsafe code | C or C++ | comes with |\n|---|---:|---|---|\n";
    Ok(lines.into_iter().fold(head.to_owned(), |text, line| text + &line + "\n"))
}

/// Lists the names of some dependencies.
fn named(doors: &BTreeSet<&str>) -> String {
    let some: Vec<String> = doors.iter().take(MOST_DOORS).map(|door| format!("`{door}`")).collect();
    let rest = doors.len().saturating_sub(MOST_DOORS);
    let rest = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    format!("{}{rest}", some.join(", "))
}

/// Counts the lines in a package's `src` that start unsafe code.
fn unsafe_lines(package: &Package) -> Result<usize> {
    let folder = package.manifest_path.parent().unwrap_or(Path::new("")).join("src");
    let mut count = 0;
    if folder.is_dir() {
        visit(&folder, &mut |text| count += text.lines().filter(|line| begins_unsafe(line)).count())?;
    }
    Ok(count)
}

/// Reads every Rust file below a folder.
fn visit(folder: &Path, see: &mut impl FnMut(&str)) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            visit(&path, see)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            see(&String::from_utf8_lossy(&fs::read(&path).with_context(|| path.display().to_string())?));
        }
    }
    Ok(())
}

/// Returns `true` for a line that starts unsafe code outside comments.
fn begins_unsafe(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    BEGINS.iter().any(|begin| code.contains(begin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_lints_are_not_unsafe_code() {
        for line in ["let a = unsafe { b() };", "pub unsafe fn f() {", "unsafe impl Send for A {}"] {
            assert!(begins_unsafe(line), "{line}");
        }
        for line in ["#![forbid(unsafe_code)]", "// unsafe { }", "/// An unsafe fn.", "safe();"] {
            assert!(!begins_unsafe(line), "{line}");
        }
    }

    #[test]
    fn few_doors_are_named() {
        let doors = |names: &[&'static str]| named(&names.iter().copied().collect());
        assert_eq!(doors(&["b", "a"]), "`a`, `b`");
        assert_eq!(doors(&["a", "b", "c", "d", "e"]), "`a`, `b`, `c` and 2 more");
    }
}
