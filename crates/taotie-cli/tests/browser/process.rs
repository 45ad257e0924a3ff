//! The browser's process.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

/// Names of the browser that all of them have been given.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

const ANNOUNCEMENT: &str = "DevTools listening on ";

/// A browser without a window, which ends when this is dropped.
pub struct Process {
    child: Child,
    address: String,
    /// Where it keeps its things.
    _profile: TempDir,
}

impl Process {
    /// Starts Chromium with these flags among others; `None`, with the reason told, where there is none. Under `CI=true` that is a failure.
    pub fn start(flags: &[&str]) -> Option<Self> {
        let Some(program) = find() else {
            let reason = "no Chromium in PATH or BROWSER; `make tools` installs it where it can";
            let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
            assert!(!required, "a browser is needed: {reason}");
            println!("skipped: {reason}");
            return None;
        };
        let profile = tempfile::tempdir().expect("temporary folders can be made");
        let mut child = command(&program, profile.path())
            .args(flags)
            .arg("about:blank")
            .spawn()
            .expect("the browser starts");
        let mut stderr = BufReader::new(child.stderr.take().expect("it is a pipe"));
        let address = announced(&mut stderr);
        // A browser whose talk nobody hears would wait for a listener.
        std::thread::spawn(move || io::copy(&mut stderr, &mut io::sink()));
        Some(Self { child, address, _profile: profile })
    }

    /// Where it listens, `ws://...`.
    pub fn address(&self) -> &str {
        &self.address
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn find() -> Option<PathBuf> {
    let named = std::env::var_os("BROWSER").map(PathBuf::from).filter(|path| path.is_file());
    let folders: Vec<PathBuf> =
        std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).collect();
    let mut found = folders.iter().flat_map(|folder| NAMES.map(|name| folder.join(name)));
    named.or_else(|| found.find(|path| path.is_file()))
}

fn command(program: &Path, profile: &Path) -> Command {
    let mut command = Command::new(program);
    command.args(["--headless=new", "--remote-debugging-port=0", "--no-first-run"]);
    command.args(["--hide-scrollbars", "--disable-background-networking", "--disable-component-update"]);
    command.args(["--disable-sync", "--disable-extensions", "--force-color-profile=srgb"]);
    command.arg(format!("--user-data-dir={}", profile.display()));
    if is_root(profile) {
        // The browser's own sandbox refuses to run for the superuser.
        command.arg("--no-sandbox");
    }
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Whether a folder that was made just now belongs to the superuser.
#[cfg(unix)]
fn is_root(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    File::open(folder).and_then(|folder| folder.metadata()).is_ok_and(|of| of.uid() == 0)
}

#[cfg(not(unix))]
fn is_root(_folder: &Path) -> bool {
    false
}

fn announced(stderr: &mut impl BufRead) -> String {
    let mut talk = String::new();
    loop {
        let mut line = String::new();
        let read = stderr.read_line(&mut line).expect("its talk is text");
        assert!(read > 0, "the browser ended:\n{talk}");
        if let Some(address) = line.trim().strip_prefix(ANNOUNCEMENT) {
            return address.to_owned();
        }
        talk += &line;
    }
}
