//! The Python package as cargo built it: the tests in `python/tests`, except for slow ones, in `tests/dist` and
//! `tests/benches`, and its types.
#![allow(clippy::print_stdout, reason = "tests print their findings")]

#[allow(dead_code)]
#[path = "../../../tests/common/mod.rs"]
mod common;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// The package in a temporary folder, and the interpreter that finds it there.
struct Package {
    python: PathBuf,
    folder: PathBuf,
}

impl Package {
    /// Puts the module that cargo built next to the package's Python files; prints why and returns `None` if there is
    /// no interpreter with the packages of the tests. With `CI=true` that is a failure.
    fn find(name: &str) -> Option<Self> {
        let python = interpreter();
        if !python.exists() {
            common::absent(&format!("there is no {}; run `make tools`", python.display()));
            return None;
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let package = folder.join("taotie");
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&package).expect("a folder");
        for file in fs::read_dir(root().join("python/taotie")).expect("the package") {
            let file = file.expect("a file").path();
            if file.is_file() {
                fs::copy(&file, package.join(file.file_name().expect("a name"))).expect("a copy");
            }
        }
        let [built, module] = module();
        fs::copy(&built, package.join(&module)).unwrap_or_else(|error| panic!("{built}: {error}"));
        Some(Self { python, folder })
    }

    /// Runs a Python module at the root of the repository, and checks that it succeeds.
    fn run(&self, arguments: &[&str]) {
        let output = Command::new(&self.python)
            .arg("-m")
            .args(arguments)
            .current_dir(root())
            .env("PYTHONPATH", &self.folder)
            .env("MYPYPATH", &self.folder)
            .output()
            .expect("Python starts");
        let [out, wrong] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        println!("{out}{wrong}");
        assert!(output.status.success(), "python -m {}", arguments.join(" "));
    }
}

/// Returns the interpreter that `make tools` installed the test packages for.
fn interpreter() -> PathBuf {
    let programs = if cfg!(windows) { "Scripts" } else { "bin" };
    root().join("target/python-tests").join(programs).join("python")
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Returns the module that cargo built next to this test, and its name as Python finds it.
fn module() -> [String; 2] {
    let program = env::current_exe().expect("a path");
    let folder = program.parent().expect("a folder");
    let file = format!("{}_taotie{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
    let name = if cfg!(windows) { "_taotie.pyd" } else { "_taotie.abi3.so" };
    [folder.join(file).display().to_string(), name.into()]
}

#[test]
fn its_tests_pass() {
    if let Some(package) = Package::find("python") {
        package.run(&["pytest", "-m", "not slow", "-p", "no:cacheprovider", "--durations=8"]);
    }
}

/// Installers, recipes, the action, the hook and workflows, with the command of the package.
#[test]
fn what_surrounds_a_release_works() {
    if let Some(package) = Package::find("python-release") {
        package.run(&["pytest", "-p", "no:cacheprovider", "--durations=8", "tests/dist"]);
    }
}

/// How `make bench` decides, and the page it writes. The package is not used.
#[test]
fn benchmarks_draw_the_right_conclusions() {
    if let Some(package) = Package::find("python-benches") {
        package.run(&["pytest", "-p", "no:cacheprovider", "tests/benches"]);
    }
}

#[test]
fn its_types_are_those_of_the_module() {
    if let Some(package) = Package::find("python-types") {
        let cache = format!("--cache-dir={}", package.folder.join("cache").display());
        package.run(&["mypy", &cache]);
        package.run(&["mypy", &cache, "python/tests/typed.py"]);
        package.run(&["mypy.stubtest", "taotie._taotie"]);
    }
}
