//! Runs of the command that end in time.

use anyhow::{Context, Result};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

/// Between two looks at whether a run has ended.
const STEP: Duration = Duration::from_millis(20);

/// A program and its bounds.
pub struct Limited<'a> {
    /// The program.
    pub program: &'a Path,
    /// A folder for what it prints.
    pub folder: &'a Path,
    /// The time after which it is ended.
    pub limit: Duration,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// With exit code 0.
    Fine,
    /// In any other way of its own.
    Failed,
    /// By us.
    TooLong,
}

/// What a run said.
#[derive(Debug)]
pub struct Said {
    /// How it ended.
    pub ending: Ending,
    /// What it printed.
    pub stdout: String,
    /// What it told beside.
    pub stderr: String,
}

impl Limited<'_> {
    /// Runs the program with these arguments. What it prints goes through files: pipes that nobody empties would stop it.
    ///
    /// # Errors
    /// Where it does not start, or its output cannot be kept.
    pub fn run(&self, arguments: &[&OsStr]) -> Result<Said> {
        let [out, err] = ["stdout", "stderr"].map(|name| self.folder.join(name));
        let mut child = Command::new(self.program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(File::create(&out)?)
            .stderr(File::create(&err)?)
            .spawn()
            .with_context(|| format!("{} does not start", self.program.display()))?;
        let ending = match self.wait(&mut child)? {
            Some(status) if status.success() => Ending::Fine,
            Some(_) => Ending::Failed,
            None => Ending::TooLong,
        };
        let read = |path| fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        Ok(Said { ending, stdout: read(out)?, stderr: read(err)? })
    }

    /// Waits for the end; ends it where it takes too long, which is `None`.
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
    /// The last line that it told, without the program's name.
    pub fn sentence(&self) -> String {
        let line = self.stderr.trim_end().lines().last().unwrap_or("it failed without a word");
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
        assert_eq!(shell("exit 3", long)?.sentence(), "it failed without a word");
        assert_eq!(shell("exec sleep 60", Duration::from_millis(100))?.ending, Ending::TooLong);
        Ok(())
    }
}
