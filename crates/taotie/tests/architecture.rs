//! The rules that keep the code base in order, checked on the source text: which modules may import one another,
//! which may access the system, how long a file may be, and how many arguments a function may take.
#![allow(clippy::print_stderr, clippy::print_stdout)]

#[path = "architecture/arguments.rs"]
mod arguments;
#[path = "architecture/cycles.rs"]
mod cycles;
#[path = "architecture/english.rs"]
mod english;
#[path = "architecture/exceptions.rs"]
mod exceptions;
#[path = "architecture/figures.rs"]
mod figures;
#[path = "architecture/public_names.rs"]
mod public_names;
#[path = "architecture/scanner.rs"]
mod scanner;

use exceptions::{CIRCLES, LONG_FUNCTIONS};
use scanner::{Found, scan};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Every top-level module of the engine and of `taotie` with its layer. A module imports only from lower layers; modules
/// of the same layer never see each other. Cargo keeps the crates in order: the engine, `taotie-io`, `taotie`.
const LAYERS: [(&str, u32); 26] = [
    // The foundation of everything: `math` too reports errors and has values chosen by name.
    ("error", 0),
    ("names", 1),
    ("progress", 1),
    ("groups", 0),
    ("parallel", 1),
    ("math", 2),
    ("length", 2),
    ("image", 3),
    ("mesh", 3),
    ("surface", 4),
    ("shade", 4),
    ("scene", 4),
    ("raster", 4),
    ("trace", 4),
    ("film", 4),
    ("compare", 4),
    ("pixel", 5),
    ("render", 6),
    ("bake", 6),
    ("normal_map", 7),
    ("proof", 7),
    // The crate `taotie`.
    ("studio", 8),
    ("inspection", 8),
    ("picture", 9),
    ("asset", 9),
    ("comparison", 9),
];

/// The names re-exported by the crate's root, and the modules that they come from.
const RENAMED: [(&str, &str); 5] = [
    ("Error", "error"),
    ("Result", "error"),
    ("Warning", "error"),
    ("Warnings", "error"),
    ("Progress", "progress"),
];

/// Parts of `std` that access the system, and the modules that may use them; `io` is the crate `taotie-io`.
const SYSTEM: [(&str, &[&str]); 6] = [
    ("env", &["io"]),
    ("fs", &["io"]),
    ("net", &[]),
    ("path", &["io", "error", "studio", "asset", "picture"]),
    // Its number differs in a child made by `fork`.
    ("process", &["io"]),
    ("time", &["io"]),
];

/// The most arguments of a function, counting the elements of tuples.
const MOST_ARGUMENTS: usize = 4;

/// The most lines of a file.
const MOST_LINES: usize = 600;

/// The library's crates, lowest first.
const LIBRARY: [&str; 3] = ["taotie-engine", "taotie-io", "taotie"];

/// The folder of a crate's sources.
fn source_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name).join("src")
}

/// Every file of the library with its module path; those of `taotie-io` are below `io`.
fn library_files() -> Vec<(PathBuf, Vec<String>)> {
    let files = LIBRARY.iter().flat_map(|name| {
        let source = source_of(name);
        rust_files(&source).into_iter().map(move |file| {
            let within = module_of(file.strip_prefix(&source).expect("it is below the folder"));
            let prefix = (*name == "taotie-io").then(|| "io".to_owned());
            (file, prefix.into_iter().chain(within).collect())
        })
    });
    files.collect()
}

/// Returns every file in `folder`, at any depth, except built and installed ones; sorted.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let is_made = |path: &Path| {
        path.join("CACHEDIR.TAG").is_file() || path.ends_with("node_modules") || path.ends_with("__pycache__")
    };
    let (mut found, mut waiting) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(path) = waiting.pop() {
        if path.is_file() {
            found.push(path);
        } else if !is_made(&path) {
            let entries = std::fs::read_dir(&path).expect("the folder is readable");
            waiting.extend(entries.map(|entry| entry.expect("the folder is readable").path()));
        }
    }
    found.sort();
    found
}

/// Returns every Rust file in `folder`.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let files = files_in(folder).into_iter();
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// Returns the module path of a file in `src`: `io/gltf/mod.rs` is `io`, `gltf`.
fn module_of(file: &Path) -> Vec<String> {
    let parts = file.with_extension("");
    let mut parts: Vec<String> = parts.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    parts.pop_if(|last| ["mod", "lib"].contains(&last.as_str()));
    parts
}

fn layer(module: &str) -> Result<u32, String> {
    LAYERS.iter().find(|(name, _)| *name == module).map(|(_, layer)| *layer).ok_or_else(|| {
        format!(
            "the module `{module}` has no layer yet: add it to LAYERS in tests/architecture.rs, \
             and to ARCHITECTURE.md"
        )
    })
}

/// Returns the violations in the source text of the module `module`.
fn violations(module: &[String], text: &str) -> Vec<String> {
    let Some(own) = module.first() else { return Vec::new() };
    let wrong = |found: Found| match found {
        Found::Import(path) => wrong_import(own, &path),
        Found::Macro(name) => Some(format!("`{name}!` prints; report to the caller instead")),
        Found::Unsafe => Some("`unsafe` is forbidden".into()),
    };
    scan(module, text)
        .into_iter()
        .filter_map(|(line, found)| Some(format!("line {line}: {}", wrong(found)?)))
        .collect()
}

fn wrong_import(own: &str, path: &[String]) -> Option<String> {
    let part = |index: usize| path.get(index).map_or("", String::as_str);
    match part(0) {
        // `pub(crate)` is the only path this short. The files of `taotie-io` have no layers.
        "crate" if path.len() > 1 && own != "io" => wrong_layer(own, part(1)),
        // A duration does not read the clock.
        "std" if part(2) != "Duration" => {
            let (_, allowed) = SYSTEM.iter().find(|(name, _)| *name == part(1))?;
            let refused = !allowed.contains(&own);
            refused.then(|| format!("`{own}` may not use `std::{}`; only {allowed:?} may", part(1)))
        }
        _ => None,
    }
}

fn wrong_layer(own: &str, named: &str) -> Option<String> {
    let target = RENAMED.iter().find(|(name, _)| *name == named).map_or(named, |(_, module)| module);
    if target == own {
        return None;
    }
    match (layer(own), layer(target)) {
        (Err(why), _) | (_, Err(why)) => Some(why),
        (Ok(mine), Ok(other)) => (other >= mine).then(|| {
            format!("`{own}` may not import `{target}`: modules import only from lower layers (house rule in lib.rs)")
        }),
    }
}

fn report(faults: &[String]) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn modules_import_from_lower_layers_only() {
    let mut faults = Vec::new();
    for (file, module) in library_files() {
        let text = std::fs::read_to_string(&file).expect("the file is readable");
        let found = violations(&module, &text);
        faults.extend(found.into_iter().map(|fault| format!("{}: {fault}", file.display())));
    }
    report(&faults);
}

#[test]
fn every_module_has_a_layer() {
    let lib = ["taotie-engine", "taotie"]
        .map(|name| std::fs::read_to_string(source_of(name).join("lib.rs")).expect("lib.rs is readable"));
    let lib = lib.concat();
    let declared = lib.lines().filter_map(|line| line.trim().trim_start_matches("pub ").strip_prefix("mod "));
    let faults: Vec<String> =
        declared.filter_map(|line| layer(line.trim_end_matches([';', ' ', '{'])).err()).collect();
    report(&faults);
}

#[test]
fn every_file_of_the_workspace_opens_with_its_purpose_and_is_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut faults = Vec::new();
    for file in
        ["crates", "xtask"].iter().map(|f| root.join(f)).filter(|f| f.is_dir()).flat_map(|f| rust_files(&f))
    {
        let text = std::fs::read_to_string(&file).expect("the file is readable");
        if !text.starts_with("//!") {
            faults.push(format!("{}: missing `//!` comment that describes it", file.display()));
        }
        let lines = text.lines().count();
        if lines > MOST_LINES {
            faults.push(format!(
                "{}: {lines} lines, at most {MOST_LINES}: split it by concept",
                file.display()
            ));
        }
    }
    report(&faults);
}

#[test]
fn the_scanner_catches_what_is_wrong() {
    let cases: BTreeMap<&str, &[(&str, usize)]> = BTreeMap::from([
        ("shade", [
            ("use crate::scene::Scene;", 1),
            ("use crate::{math::Vec3, scene::{Scene, Camera}};", 2),
            ("fn f() { crate::raster::go::<crate::trace::Bvh>(); }", 2),
            ("use super::super::scene::Scene;", 1),
            ("use super::angles; use self::ndf; use crate::shade::microfacets;", 0),
            ("mod tests { use super::super::super::trace::Bvh; use super::super::microfacets; }", 1),
            ("// use crate::scene::Scene;\n/* crate::scene /* nested */ crate::io */", 0),
            ("const A: &str = \"crate::scene\"; const B: &str = r#\"use \"crate::io\";\"#; const C: char = '\"';", 0),
            ("fn f<'a>(x: &'a str) { use crate::render; }", 1),
            ("use crate::math::{Lane, Vec3}; use crate::Result; use crate::error::Error;", 0),
            ("use crate::newcomer::X;", 1),
            ("use std::fs; use std::{env, collections::HashMap}; use std::path::Path;", 3),
            ("fn f() { println!(\"{}\", 1); eprint!(\"\"); dbg!(2); }", 3),
            ("fn f() { unsafe { g() } }", 1),
                ("pub(crate) use simd::go; use std::time::{Duration, Instant};", 1),
            ("macro_rules! m { () => { $crate::trace::Bvh } }", 1),
            ("use crate::*;", 1),
        ].as_slice()),
        ("io", [
            ("use std::fs::File; use std::path::Path; use crate::gltf::Reader; use super::super::Error;", 0),
            ("use std::time::Instant;", 0),
        ].as_slice()),
        ("error", [("use std::path::PathBuf;", 0), ("use crate::math::Vec3;", 1)].as_slice()),
    ]);
    for (own, texts) in cases {
        for (text, expected) in texts {
            // As if in a file one level deeper.
            let found = violations(&[own.to_string(), "part".to_string()], text);
            assert_eq!(found.len(), *expected, "{own}: {text}: {found:?}");
        }
    }
}

#[test]
fn the_missing_layer_is_explained() {
    let fault = violations(&["shade".into()], "use crate::newcomer::X;").remove(0);
    assert!(fault.contains("newcomer") && fault.contains("LAYERS in tests/architecture.rs"), "{fault}");
    assert_eq!(module_of(Path::new("io/gltf/mod.rs")), ["io", "gltf"]);
    assert_eq!(module_of(Path::new("lib.rs")), Vec::<String>::new());
}

#[test]
fn no_module_imports_itself_in_a_circle() {
    let cycles = LIBRARY.iter().flat_map(|name| figures::graph(&source_of(name)).cycles());
    let found: Vec<_> = cycles.map(Vec::from_iter).collect();
    let excepted = |files: &[String]| CIRCLES.iter().any(|(circle, _)| circle.iter().eq(files));
    let faults = found.iter().filter(|files| !excepted(files)).map(|files| {
        format!("these files import one another; move what they share to a lower file: {}", files.join(", "))
    });
    let fixed = CIRCLES.iter().filter(|(circle, _)| !found.iter().any(|files| circle.iter().eq(files)));
    let fixed = fixed.map(|(circle, _)| format!("no longer a circle, remove it from CIRCLES: {circle:?}"));
    report(&faults.chain(fixed).collect::<Vec<_>>());
}

#[test]
fn functions_take_few_arguments() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = BTreeMap::new();
    let folders = std::fs::read_dir(root.join("crates")).expect("the folder is readable");
    let crates = folders.map(|entry| entry.expect("the folder is readable").path().join("src"));
    for file in crates.chain([root.join("xtask/src")]).filter(|f| f.is_dir()).flat_map(|f| rust_files(&f)) {
        let text = std::fs::read_to_string(&file).expect("the file is readable");
        let name = file.strip_prefix(&root).unwrap_or(&file).display().to_string();
        let name = name.rsplit("../").next().unwrap_or_default().to_owned();
        for function in arguments::functions(&text).expect("the file is Rust") {
            if function.arguments > MOST_ARGUMENTS {
                found.insert((name.clone(), function.name), function.arguments);
            }
        }
    }
    let excepted = |file: &str, name: &str| LONG_FUNCTIONS.contains(&(file, name));
    let faults =
        found.iter().filter(|((file, name), _)| !excepted(file, name)).map(|((file, name), count)| {
            format!("{file}: `{name}` takes {count} arguments; bundle what travels together in a struct")
        });
    let listed = LONG_FUNCTIONS.iter().map(|(file, name)| (file.to_string(), name.to_string()));
    let fixed = listed.filter(|key| !found.contains_key(key));
    let fixed = fixed.map(|(file, name)| format!("{file}: remove `{name}` from LONG_FUNCTIONS"));
    report(&faults.chain(fixed).collect::<Vec<_>>());
}

#[test]
fn circles_are_found_through_doors_and_macros() {
    let circles = |files: &[(&str, &str)]| {
        let mut all = cycles::Files::default();
        for (module, text) in files {
            all.add(&module_of(Path::new(module)), text).unwrap();
        }
        all.cycles().into_iter().map(|circle| Vec::from_iter(circle).join(" ")).collect::<Vec<_>>()
    };
    let door = ("a/mod.rs", "mod b; mod c; pub use b::B; pub use c::{C, D as E};");
    assert!(circles(&[door, ("a/b.rs", "use super::C;"), ("a/c.rs", "use crate::d::X;")]).is_empty());
    let two = circles(&[door, ("a/b.rs", "use super::E;"), ("a/c.rs", "fn f(b: super::B) {}")]);
    assert_eq!(two, ["a/b a/c"]);
    let called = circles(&[door, ("a/b.rs", "use super::c::C;"), ("a/c.rs", "m!(super::b::B);")]);
    assert_eq!(called, ["a/b a/c"]);
    let up = ("a/mod.rs", "mod b; use b::B; pub struct A;");
    assert_eq!(circles(&[up, ("a/b.rs", "use super::A;")]), ["a a/b"]);
    let tests = "mod tests { use super::super::C; }";
    assert!(circles(&[door, ("a/b.rs", tests), ("a/c.rs", "use super::b::B;")]).is_empty());
    let others = [("a.rs", "use crate::b::B;"), ("b.rs", "use crate::a::A;")];
    assert!(circles(&others).is_empty(), "layers are the other test's");
}

#[test]
fn arguments_are_counted_as_a_caller_sees_them() {
    let counts = |text: &str| -> Vec<usize> {
        arguments::functions(text).unwrap().iter().map(|function| function.arguments).collect()
    };
    let text = "fn a() {} fn b(x: u8, (y, z): (u8, (u8, u8)), w: ()) {} struct S;
        impl S { fn c(&mut self, [x, y]: [f32; 2], [from, to]: [&[u8]; 2]) {} }
        trait T { fn d<F: Fn(u8, u8)>(self, f: F, g: impl Fn(u8, (u8, u8))); }";
    assert_eq!(counts(text), [0, 5, 3, 2]);
}
