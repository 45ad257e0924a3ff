//! The parent of a worker: listens, and ends it where a run takes too long.

use crate::failure::{Failure, FailureKind};
use crate::worker::News;
use anyhow::{Context, Result};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// The most bytes of a worker's last words that are kept.
const WORDS: usize = 2000;

/// The course of a worker.
#[derive(Debug, Default)]
pub struct Seen {
    /// The runs that began.
    pub runs: u64,
    /// The run that began last.
    pub last: Option<u64>,
    /// The failures, each with its run; the last may have ended the worker.
    pub failures: Vec<FailedRun>,
}

/// A run that failed.
#[derive(Debug)]
pub struct FailedRun {
    /// Its number.
    pub run: u64,
    /// In which way.
    pub failure: Failure,
}

/// Starts a worker with `input` on its stdin, and listens until it ends or tells nothing for as long as `patience`.
///
/// # Errors
/// Where it cannot be started, or ends before any run.
pub fn watch(mut command: Command, input: &str, patience: Duration) -> Result<Seen> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().context("a worker cannot be started")?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(input.as_bytes())?;
    }
    let words = last_words(&mut child);
    let (seen, end) = listen(&mut child, patience);
    if end == End::Silent {
        child.kill()?;
    }
    let status = child.wait()?;
    let words = words.and_then(|words| words.join().ok()).unwrap_or_default();
    let failure = match end {
        End::Done => return Ok(seen),
        End::Silent => Failure { kind: FailureKind::Time, message: format!("no end within {patience:?}") },
        End::Gone if words.contains("memory allocation of") => {
            Failure { kind: FailureKind::Memory, message: words }
        }
        End::Gone => Failure { kind: FailureKind::Abort, message: format!("{status}: {words}") },
    };
    let run = seen.last.with_context(|| format!("a worker ended before any run: {}", failure.message))?;
    Ok(Seen { failures: seen.failures.into_iter().chain([FailedRun { run, failure }]).collect(), ..seen })
}

/// The end of listening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// The worker did all its runs.
    Done,
    /// The worker told nothing for too long.
    Silent,
    /// The worker is gone.
    Gone,
}

/// Listens to a worker's stdout.
fn listen(child: &mut Child, patience: Duration) -> (Seen, End) {
    let (sender, receiver) = mpsc::channel();
    if let Some(stdout) = child.stdout.take() {
        thread::spawn(move || {
            let news = BufReader::new(stdout).lines().map_while(std::result::Result::ok);
            // A parent that no longer listens has heard enough.
            let _ = news
                .filter_map(|line| serde_json::from_str(&line).ok())
                .try_for_each(|news| sender.send(news));
        });
    }
    let mut seen = Seen::default();
    loop {
        match receiver.recv_timeout(patience) {
            Ok(News::Run(run)) => (seen.runs, seen.last) = (seen.runs + 1, Some(run)),
            Ok(News::Failed(failure)) => {
                seen.failures.push(FailedRun { run: seen.last.unwrap_or_default(), failure });
            }
            Ok(News::Done) => return (seen, End::Done),
            Err(RecvTimeoutError::Timeout) => return (seen, End::Silent),
            Err(RecvTimeoutError::Disconnected) => return (seen, End::Gone),
        }
    }
}

/// Collects the end of what a worker says on stderr.
fn last_words(child: &mut Child) -> Option<JoinHandle<String>> {
    let mut stderr = child.stderr.take()?;
    Some(thread::spawn(move || {
        let mut said = Vec::new();
        // What cannot be read is not told.
        let _ = stderr.read_to_end(&mut said);
        let from = said.len().saturating_sub(WORDS);
        String::from_utf8_lossy(&said[from..]).trim().to_owned()
    }))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// Watches a shell in the place of a worker.
    fn seen(script: &str) -> Result<Seen> {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        watch(command, "", Duration::from_millis(500))
    }

    fn kinds(seen: &Seen) -> Vec<(u64, FailureKind)> {
        seen.failures.iter().map(|failed| (failed.run, failed.failure.kind)).collect()
    }

    #[test]
    fn a_worker_that_tells_of_all_its_runs_is_heard() {
        let told = r#"echo '{"run":4}'; echo '{"failed":{"kind":"panic","message":"a"}}'; echo '{"run":5}'; echo '"done"'"#;
        let seen = seen(told).unwrap();
        assert_eq!((seen.runs, seen.last), (2, Some(5)));
        assert_eq!(kinds(&seen), [(4, FailureKind::Panic)]);
    }

    #[test]
    fn a_worker_that_ends_or_hangs_in_a_run_is_a_failure_of_it() {
        let after = |rest: &str| kinds(&seen(&format!("echo '{{\"run\":7}}'; {rest}")).unwrap());
        assert_eq!(after("exit 3"), [(7, FailureKind::Abort)]);
        assert_eq!(after("kill -9 $$"), [(7, FailureKind::Abort)]);
        assert_eq!(
            after("echo 'memory allocation of 9 bytes failed' >&2; exit 3"),
            [(7, FailureKind::Memory)]
        );
        assert_eq!(after("exec sleep 60"), [(7, FailureKind::Time)]);
    }

    #[test]
    fn a_worker_that_does_not_begin_is_an_error() {
        let error = seen("echo 'no such folder' >&2; exit 2").unwrap_err();
        assert!(error.to_string().contains("no such folder"), "{error}");
    }
}
