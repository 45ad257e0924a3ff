//! Figures of the code base, with targets. A figure that misses its target is recorded, and may only improve.

use super::cycles::Files;
use super::english;
use super::exceptions::RECORDED;
use super::public_names::Exports;
use super::{files_in, library_files, module_of, rust_files, source_of};
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::Visit;

/// Returns the root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the root exists")
}

/// Returns a path from the root, with forward slashes.
fn below_root(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

/// Returns a source text without its tests.
fn code(path: &Path) -> String {
    read(path).split("#[cfg(test)]").next().unwrap_or_default().to_owned()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

/// Every file of some files and folders of the repository; sorted.
fn files_below(parts: &[&str]) -> Vec<PathBuf> {
    let mut files: Vec<_> = parts.iter().flat_map(|part| files_in(&root().join(part))).collect();
    files.sort();
    files
}

/// The source folders of all crates.
fn crates() -> Vec<PathBuf> {
    let folders = std::fs::read_dir(root().join("crates")).expect("the folder is readable");
    let mut sources: Vec<_> =
        folders.map(|entry| entry.expect("the folder is readable").path().join("src")).collect();
    sources.push(root().join("xtask/src"));
    sources
}

/// Source files of the product in all languages: neither tests, nor benchmarks, nor generated.
fn production() -> Vec<PathBuf> {
    let is_code = |path: &PathBuf| {
        let text = below_root(path);
        let kinds = [".rs", ".py", ".ts", ".js", ".wgsl", ".glsl"];
        kinds.iter().any(|kind| text.ends_with(kind))
            && !["/tests/", "/bundle/", "/benches/", "/examples/"].iter().any(|part| text.contains(part))
    };
    files_below(&["crates", "python", "viewer/src"]).into_iter().filter(is_code).collect()
}

fn mentions(word: &str) -> usize {
    production().iter().filter(|path| read(path).to_lowercase().contains(word)).count()
}

/// Lines of code in a file: neither blank, nor comments, nor tests.
fn code_lines(path: &Path) -> usize {
    code(path).lines().filter(|line| !line.trim().is_empty() && !line.trim_start().starts_with("//")).count()
}

/// Lines of code in the median file of the library.
fn median_lines() -> usize {
    let mut lines: Vec<usize> = library_files().iter().map(|(path, _)| code_lines(path)).collect();
    lines.sort_unstable();
    lines[lines.len() / 2]
}

fn count_matches(paths: &[PathBuf], pattern: &str) -> usize {
    let pattern = Regex::new(pattern).expect("the pattern is valid");
    paths.iter().map(|path| pattern.find_iter(&code(path)).count()).sum()
}

fn files_with(paths: &[PathBuf], pattern: &str) -> usize {
    let pattern = Regex::new(pattern).expect("the pattern is valid");
    paths.iter().filter(|path| pattern.is_match(&code(path))).count()
}

/// Lines of shader code that are written by hand: files, and string literals that hold statements.
fn shader_lines() -> usize {
    struct Literals(usize);
    impl Visit<'_> for Literals {
        /// Doc comments are attributes.
        fn visit_attribute(&mut self, _: &syn::Attribute) {}

        fn visit_lit_str(&mut self, text: &syn::LitStr) {
            let is_code = |line: &&str| {
                let line = line.trim_end_matches("\\n").trim_end();
                line.ends_with(';') || line.ends_with('{') || line.trim() == "}"
            };
            self.0 += text.value().lines().filter(is_code).count();
        }

        fn visit_macro(&mut self, used: &syn::Macro) {
            used.tokens.clone().into_iter().for_each(|token| self.token(token));
        }
    }
    impl Literals {
        fn token(&mut self, token: proc_macro2::TokenTree) {
            match token {
                proc_macro2::TokenTree::Group(group) => {
                    group.stream().into_iter().for_each(|token| self.token(token))
                }
                proc_macro2::TokenTree::Literal(literal) => {
                    if let Ok(text) = syn::parse_str::<syn::LitStr>(&literal.to_string()) {
                        self.visit_lit_str(&text);
                    }
                }
                _ => {}
            }
        }
    }
    let files = files_below(&["crates/taotie-shader/src", "crates/taotie-gpu/src"]);
    let mut found = Literals(0);
    let of_files = files.iter().filter(|path| path.extension().is_some_and(|kind| kind == "wgsl"));
    found.0 +=
        of_files.map(|path| read(path).lines().filter(|line| !line.trim().is_empty()).count()).sum::<usize>();
    for path in files.iter().filter(|path| path.extension().is_some_and(|kind| kind == "rs")) {
        found.visit_file(&syn::parse_file(&read(path)).expect("the file is Rust"));
    }
    found.0
}

/// The crate below a source folder.
pub fn graph(folder: &Path) -> Files {
    let mut files = Files::default();
    for file in rust_files(folder) {
        let module = module_of(file.strip_prefix(folder).expect("it is below the folder"));
        files.add(&module, &read(&file)).expect("the file is Rust");
    }
    files
}

/// Groups of files that import one another, in every crate and language.
fn import_cycles() -> Vec<BTreeSet<String>> {
    let of_crate = |folder: PathBuf| {
        // These crates' modules have layers, which another test checks.
        let has_layers = ["taotie-engine/src", "taotie/src"].iter().any(|layered| folder.ends_with(layered));
        let mut files = graph(&folder);
        files.across_modules = !has_layers;
        files.cycles()
    };
    let rust = crates().into_iter().flat_map(of_crate);
    let python = script_cycles(&root().join("python/taotie"), "py", r"(?m)^\s*from \.(\w*) import ([\w, ]+)");
    let typescript = script_cycles(&root().join("viewer/src"), "ts", r#"(?m)from "\./(\w+)(?:\.js)?"()"#);
    rust.chain(python).chain(typescript).collect()
}

/// Groups of scripts of a folder that import one another. The pattern captures a module, or names from the package.
fn script_cycles(folder: &Path, kind: &str, pattern: &str) -> Vec<BTreeSet<String>> {
    let pattern = Regex::new(pattern).expect("the pattern is valid");
    let mut files = Files::default();
    for path in files_in(folder).iter().filter(|path| path.extension().is_some_and(|found| found == kind)) {
        let name = path.file_stem().expect("it has a name").to_string_lossy().into_owned();
        let text = read(path);
        let imports = pattern.captures_iter(&text).flat_map(|import| match &import[1] {
            "" => import[2].split(',').map(|name| name.trim().to_owned()).collect(),
            module => vec![module.to_owned()],
        });
        files.add_script(&name, imports);
    }
    files.cycles()
}

/// The library's exported names by origin, each with the paths that lead to it.
type Names = BTreeMap<Vec<String>, BTreeSet<String>>;

fn exports() -> Names {
    let mut exports = Exports::default();
    let facade = source_of("taotie");
    for file in rust_files(&facade) {
        let module = module_of(file.strip_prefix(&facade).expect("it is below the folder"));
        exports.add(&module, &read(&file)).expect("the file is Rust");
    }
    exports.names()
}

/// Exported names that nothing outside the library uses: neither another crate, nor a test, example or benchmark.
fn unused_names(all: &Names) -> Vec<String> {
    let library = source_of("taotie").canonicalize().expect("it exists");
    let others = files_below(&["crates", "xtask"]).into_iter();
    let is_user =
        |path: &PathBuf| path.extension().is_some_and(|kind| kind == "rs") && !path.starts_with(&library);
    let texts: Vec<String> = others.filter(is_user).map(|path| read(&path)).collect();
    let words: BTreeSet<&str> =
        texts.iter().flat_map(|text| text.split(|c: char| !c.is_alphanumeric() && c != '_')).collect();
    let unused = all.keys().filter(|origin| origin.last().is_some_and(|name| !words.contains(name.as_str())));
    unused.map(|origin| origin.join("::")).collect()
}

fn words(page: &str) -> usize {
    read(&root().join(page)).split_whitespace().count()
}

/// Phrases that docs/style.md advises against, each with its place.
fn phrases() -> Vec<String> {
    let folders = ["crates", "python", "viewer/src", "xtask", "docs", "tests", "benches", "README.md"];
    let pages = ["ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md"];
    let files = files_below(&[&folders[..], &pages[..]].concat());
    let in_file = |path: PathBuf| {
        let name = below_root(&path);
        let found = english::phrases(&read(&path)).into_iter();
        found.map(move |(line, phrase, advice)| format!("{name}:{line}: `{phrase}`: {advice}"))
    };
    files.into_iter().filter(|path| english::is_prose(&below_root(path))).flat_map(in_file).collect()
}

/// Every figure: its name, its value, and its target. All but the median are better if smaller.
fn measured() -> Vec<(&'static str, usize, usize)> {
    let (code, all) = (production(), exports());
    let library: Vec<PathBuf> = library_files().into_iter().map(|(file, _)| file).collect();
    let asset = graph(&source_of("taotie"));
    let writers = rust_files(&source_of("taotie-io").join("write"));
    let memory = [
        source_of("taotie").join("asset/bake/memory.rs"),
        source_of("taotie").join("comparison/options.rs"),
        source_of("taotie-engine").join("render/memory.rs"),
    ];
    vec![
        ("files of the library", library.len(), 330),
        ("lines of code in the library's median file", median_lines(), 110),
        ("production files that mention `sheen`", mentions("sheen"), 20),
        ("production files that mention `anisotropy`", mentions("anisotropy"), 18),
        (
            "enums of the source of shading normals",
            count_matches(&code, r"(?m)^    Object(?:Map|Normal)(?:\(| \{|,)"),
            1,
        ),
        (
            "places that choose the shading normal",
            files_with(&code, r"(?:[:.]object_mapped|Some\(of_object_map)\("),
            1,
        ),
        ("hand-written lines of shaders", shader_lines(), 350),
        (
            "writers of a glTF material",
            files_with(&writers, r#"\[?"pbrMetallicRoughness"\]? ?=|\bPBR: |member\(json, PBR\)"#),
            1,
        ),
        ("public `Gltf` types", count_matches(&code, r"(?m)^pub (?:struct|enum) Gltf"), 3),
        ("files of `asset`", rust_files(&source_of("taotie").join("asset")).len(), 30),
        ("levels of imports in `asset`", asset.levels("asset"), 6),
        ("import cycles", import_cycles().len(), 0),
        ("public names", all.len(), 150),
        ("names exported from two modules", all.values().filter(|paths| paths.len() > 1).count(), 0),
        ("public names that are unused elsewhere", unused_names(&all).len(), 0),
        ("byte constants of memory estimates", count_matches(&memory, r"const [A-Z_]+: (?:u64|usize)"), 12),
        ("words in ARCHITECTURE.md", words("ARCHITECTURE.md"), 2000),
        ("words in CHANGELOG.md", words("CHANGELOG.md"), 800),
        ("decision pages", files_below(&["docs/decisions"]).len(), 9),
        ("phrases that docs/style.md advises against", phrases().len(), 25),
    ]
}

/// What is wrong with a figure; `recorded` is the value that an earlier change left, if it misses the target.
fn fault(name: &str, value: usize, target: usize, recorded: Option<usize>) -> Option<String> {
    let larger_is_better = name.contains("median");
    let misses = |limit: usize| if larger_is_better { value < limit } else { value > limit };
    match recorded {
        None => misses(target).then(|| format!("{name}: {value}, but the target is {target}")),
        Some(limit) if misses(limit) => {
            Some(format!("{name}: {value}, but it was {limit}: keep it from getting worse"))
        }
        Some(_) if !misses(target) => {
            Some(format!("{name}: {value} reaches the target: remove it from RECORDED"))
        }
        Some(limit) if value != limit => Some(format!("{name}: improved from {limit} to {value}: record it")),
        Some(_) => None,
    }
}

#[test]
fn figures_reach_their_targets_or_improve() {
    let (mut faults, measured) = (Vec::new(), measured());
    for &(name, value, target) in &measured {
        println!("{name}: {value} (target {target})");
        let recorded = RECORDED.iter().find(|(recorded, _)| *recorded == name).map(|(_, value)| *value);
        faults.extend(fault(name, value, target, recorded));
    }
    let unknown = RECORDED.iter().filter(|(name, _)| !measured.iter().any(|(known, ..)| known == name));
    faults.extend(unknown.map(|(name, _)| format!("{name}: no such figure; remove it from RECORDED")));
    if faults.iter().any(|fault| fault.contains("style.md")) {
        phrases().iter().for_each(|phrase| println!("{phrase}"));
    }
    if faults.iter().any(|fault| fault.contains("unused elsewhere")) {
        unused_names(&exports()).iter().for_each(|name| println!("unused elsewhere: {name}"));
    }
    if faults.iter().any(|fault| fault.contains("import cycles")) {
        import_cycles().iter().for_each(|cycle| println!("import cycle: {cycle:?}"));
    }
    super::report(&faults);
}

/// The file that records the public names of `taotie`.
const NAMES: &str = "crates/taotie/public-names.txt";

#[test]
fn public_names_change_on_purpose() {
    let all = exports().into_values().flatten();
    let found: BTreeSet<String> = all.map(|name| name.trim_start_matches("::").to_owned()).collect();
    assert!(!found.iter().any(|name| name.contains('*')), "a glob re-export hides names: {found:?}");
    if std::env::var_os("TAOTIE_BLESS").is_some() {
        let text: String = found.iter().map(|name| format!("{name}\n")).collect();
        std::fs::write(root().join(NAMES), text).expect("the file is writable");
    }
    let text = read(&root().join(NAMES));
    let recorded: BTreeSet<String> = text.lines().map(str::to_owned).collect();
    let gone = recorded.difference(&found).map(|name| format!("`{name}` is gone, which breaks users"));
    let new =
        found.difference(&recorded).map(|name| format!("`{name}` is new, and must be kept from now on"));
    let mut faults: Vec<String> = gone.chain(new).collect();
    if !faults.is_empty() {
        faults.push(format!("if that is intended, run `make bless` and commit {NAMES}"));
    }
    super::report(&faults);
}

#[test]
fn a_figure_may_only_improve() {
    assert_eq!(fault("files", 5, 5, None), None);
    assert!(fault("files", 6, 5, None).unwrap().contains("target is 5"));
    assert_eq!(fault("files", 7, 5, Some(7)), None);
    assert!(fault("files", 8, 5, Some(7)).unwrap().contains("was 7"));
    assert!(fault("files", 6, 5, Some(7)).unwrap().contains("record it"));
    assert!(fault("files", 4, 5, Some(7)).unwrap().contains("remove it"));
    assert!(fault("lines in the median file", 4, 5, None).is_some());
    assert_eq!(fault("lines in the median file", 6, 5, None), None);
}

#[test]
fn phrases_are_found_and_sound_english_is_not() {
    let count = |text: &str| english::phrases(text).len();
    let poor = [
        "`x` is no level of detail",
        "the file tells its size",
        "beside the mesh",
        "levels alone",
        "/// What the file holds.",
        "the unit stands in the file",
        "so many texels",
        "read anew",
        "a map of its own",
        "all but for one",
        "mend the file",
        "/// Says whether it is empty.",
        "if not given",
    ];
    poor.iter().for_each(|text| assert!(count(text) > 0, "{text}"));
    let sound =
        "there is no file; it is no longer valid; an asset is no larger than its scan. // What is lost?";
    assert_eq!(english::phrases(sound), []);
}

#[test]
fn exported_names_are_followed_through_doors() {
    let mut exports = Exports::default();
    for (module, text) in [
        ("lib.rs", "pub mod a; mod hidden; pub use hidden::H; pub use a::B as C;"),
        ("a/mod.rs", "mod b; pub use b::{B, f}; pub struct A; struct Private; pub(crate) struct Inner;"),
        ("a/b.rs", "pub struct B; pub fn f() {} pub fn not_exported() {}"),
        ("hidden.rs", "pub struct H; pub struct NotExported;"),
    ] {
        exports.add(&module_of(Path::new(module)), text).unwrap();
    }
    let names: BTreeSet<String> = exports.names().into_values().flatten().collect();
    assert_eq!(names, ["C", "H", "a::A", "a::B", "a::f"].map(String::from).into());
    assert_eq!(exports.names().values().filter(|paths| paths.len() > 1).count(), 1);
}

/// The test targets of the workspace: files and folders with a `main.rs` in the crates' `tests`.
fn test_targets() -> BTreeSet<String> {
    let is_target = |path: &PathBuf| {
        let of_crate = path
            .strip_prefix(root().join("crates"))
            .is_ok_and(|rest| rest.iter().nth(1).is_some_and(|part| part == "tests"));
        let depth = path.strip_prefix(root().join("crates")).map_or(0, |rest| rest.iter().count());
        let is_rust = path.extension().is_some_and(|kind| kind == "rs");
        of_crate && is_rust && (depth == 3 || (depth == 4 && path.ends_with("main.rs")))
    };
    let name = |path: PathBuf| {
        let named =
            if path.ends_with("main.rs") { path.parent().unwrap_or(&path).to_path_buf() } else { path };
        named.file_stem().map(|name| name.to_string_lossy().into_owned())
    };
    files_below(&["crates"]).into_iter().filter(is_target).filter_map(name).collect()
}

#[test]
fn every_test_target_is_quick_or_slow() {
    let makefile = read(&root().join("Makefile"));
    let listed = |name: &str| {
        let line = makefile.lines().find_map(|line| line.strip_prefix(&format!("{name} = ")));
        let words = line.expect("the list exists").split_whitespace();
        words.map(str::to_owned).collect::<BTreeSet<String>>()
    };
    let (quick, slow) = (listed("QUICK"), listed("SLOW"));
    assert!(quick.is_disjoint(&slow), "in both lists: {:?}", quick.intersection(&slow));
    assert_eq!(&quick | &slow, test_targets(), "the lists of the Makefile and the targets of the workspace");
}
