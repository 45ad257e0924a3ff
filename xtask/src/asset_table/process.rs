//! Runs the command with a time limit.

use anyhow::{Context, Result};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

/// The interval between checks whether a run has ended.
const STEP: Duration = Duration::from_millis(20);

/// A program and its limits.
pub struct Limited<'a> {
    /// The program.
    pub program: &'a Path,
    /// A folder for its output.
    pub folder: &'a Path,
    /// The time after which it is killed.
    pub limit: Duration,
}

/// The way a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// With exit code 0.
    Fine,
    /// With a failure.
    Failed,
    /// Killed after the time limit.
    TooLong,
}

/// The output of a run.
#[derive(Debug)]
pub struct Said {
    /// The way it ended.
    pub ending: Ending,
    /// Its standard output.
    pub stdout: String,
    /// Its standard error.
    pub stderr: String,
}

impl Limited<'_> {
    /// Runs the program with these arguments. Its output goes to files, since full pipes would block it.
    ///
    /// # Errors
    /// If it does not start, or its output cannot be stored.
    pub fn run(&self, arguments: &[&OsStr]) -> Result<Said> {
        let [out, err] = ["stdout", "stderr"].map(|name| self.folder.join(name));
        let mut child = Command::new(self.program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(File::create(&out)?)
            .stderr(File::create(&err)?)
            .spawn()
            .with_context(|| format!("{}: cannot be started", self.program.display()))?;
        let ending = match self.wait(&mut child)? {
            Some(status) if status.success() => Ending::Fine,
            Some(_) => Ending::Failed,
            None => Ending::TooLong,
        };
        let read = |path| fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        Ok(Said { ending, stdout: read(out)?, stderr: read(err)? })
    }

    /// Waits for the end; kills the process and returns `None` if it takes too long.
    fn wait(&self, child: &mut Child) -> Result<Option<ExitStatus>> {
        for _ in 0..=self.limit.as_millis() / STEP.as_millis() {
            if let Some(status) = child.try_wait()? {
                return Ok(Some(status));
            }
            thread::sleep(STEP);
        }
        child.kill()?;
        child.wait()?;
        Ok(None)
    }
}

impl Said {
    /// Returns the last line of standard error, without the program's name.
    pub fn sentence(&self) -> String {
        let line = self.stderr.trim_end().lines().last().unwrap_or("failed without a message");
        line.strip_prefix("taotie: error: ").unwrap_or(line).to_owned()
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str, limit: Duration) -> Result<Said> {
        let folder = tempfile::tempdir()?;
        let limited = Limited { program: Path::new("sh"), folder: folder.path(), limit };
        limited.run(&["-c".as_ref(), script.as_ref()])
    }

    #[test]
    fn a_run_ends_well_badly_or_too_late() -> Result<()> {
        let long = Duration::from_secs(60);
        let fine = shell("echo out; echo err >&2", long)?;
        assert_eq!(
            (fine.ending, fine.stdout.as_str(), fine.stderr.as_str()),
            (Ending::Fine, "out\n", "err\n")
        );
        let failed = shell("echo 'more' >&2; echo 'taotie: error: no triangles' >&2; exit 2", long)?;
        assert_eq!((failed.ending, failed.sentence().as_str()), (Ending::Failed, "no triangles"));
        assert_eq!(shell("exit 3", long)?.sentence(), "failed without a message");
        assert_eq!(shell("exec sleep 60", Duration::from_millis(100))?.ending, Ending::TooLong);
        Ok(())
    }
}
