//! Starts workers for ranges of runs and for single cases, listens to them, and kills one if a run takes too long.
//! The patience with a silent worker counts the worker's own work, not the load of the machine.

use crate::case::{Case, Failure, FailureKind};
use crate::target::Target;
use crate::worker::News;
use anyhow::{Context, Result};
use std::fmt;
use std::io::{BufRead, BufReader, Read, Write};
use std::ops::Range;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use taotie::Bytes;

/// Starts workers and limits them.
#[derive(Debug, Clone)]
pub struct Runner {
    /// A folder of additional sound files.
    pub models: Option<PathBuf>,
    /// The memory that a run may allocate.
    pub memory: Bytes,
    /// The time that a run may take.
    pub patience: Patience,
}

/// Runs of one target.
#[derive(Debug, Clone)]
pub struct Slice {
    /// The target.
    pub target: Target,
    /// The seed for all random numbers.
    pub seed: u64,
    /// The run numbers.
    pub runs: Range<u64>,
}

impl Runner {
    /// Runs a slice in one worker, which may end before all runs are done.
    ///
    /// # Errors
    /// If no worker can be started.
    pub fn slice(&self, slice: &Slice) -> Result<Seen> {
        let mut command = self.worker()?;
        command.args(["--target", &slice.target.name()]);
        let numbers = [slice.seed, slice.runs.start, slice.runs.end].map(|number| number.to_string());
        let [seed, from, to] = &numbers;
        command.args(["--seed", seed, "--from", from, "--to", to]);
        watch(command, "", self.patience)
    }

    /// Runs one case in a separate worker; `None` if nothing fails.
    ///
    /// # Errors
    /// If no worker can be started, or the case names a file that does not exist.
    pub fn case(&self, case: &Case) -> Result<Option<Failure>> {
        let seen = watch(self.worker()?, &serde_json::to_string(case)?, self.patience)?;
        Ok(seen.failures.into_iter().next().map(|failed| failed.failure))
    }

    /// Returns a command that starts this program as a worker. It uses one thread, since many workers run
    /// concurrently.
    fn worker(&self) -> Result<Command> {
        let mut command = Command::new(std::env::current_exe()?);
        command.args(["worker", "--memory", &self.memory.0.to_string()]);
        if let Some(models) = &self.models {
            command.arg("--models").arg(models);
        }
        command.env("RAYON_NUM_THREADS", "1").env_remove("RUST_BACKTRACE");
        Ok(command)
    }
}

/// The most bytes kept of a worker's stderr.
const WORDS: usize = 2000;
/// The time without news after which a worker is checked.
const TICK: Duration = Duration::from_millis(50);
/// How often a worker is restarted if it does not get to its first run.
const RESTARTS: usize = 2;

/// The history of a worker.
#[derive(Debug, Default)]
pub struct Seen {
    /// The number of runs started.
    pub runs: u64,
    /// The run started last.
    pub last: Option<u64>,
    /// The failures, each with its run; the last may have ended the worker.
    pub failures: Vec<FailedRun>,
}

/// A run that failed.
#[derive(Debug)]
pub struct FailedRun {
    /// Its number.
    pub run: u64,
    /// How it failed.
    pub failure: Failure,
}

/// Starts a worker with `input` on its stdin, and listens until it ends or stays silent longer than `patience`.
///
/// If it falls silent or is killed before its first run, it is restarted, at most twice: no file can have caused
/// that.
///
/// # Errors
/// If it cannot be started, or ends before any run.
fn watch(mut command: Command, input: &str, patience: Patience) -> Result<Seen> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut life = Life::of(&mut command, input, patience)?;
    for _ in 0..RESTARTS {
        if life.never_began() {
            life = Life::of(&mut command, input, patience)?;
        }
    }
    life.outcome(patience)
}

/// The lifetime of a worker.
#[derive(Debug)]
struct Life {
    seen: Seen,
    end: End,
    status: ExitStatus,
    /// The end of its stderr.
    words: String,
}

/// How listening ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// The worker finished all its runs.
    Done,
    /// The worker was silent for too long.
    Silent,
    /// The worker is gone.
    Gone,
}

impl Life {
    /// Starts a worker and waits for it to end.
    fn of(command: &mut Command, input: &str, patience: Patience) -> Result<Self> {
        let mut child = command.spawn().context("could not start a worker")?;
        if let Some(mut stdin) = child.stdin.take() {
            // If a worker ends before it has read everything, its end is noticed below.
            let _ = stdin.write_all(input.as_bytes());
        }
        let words = last_words(&mut child);
        let (seen, end) = listen(&mut child, patience);
        if end == End::Silent {
            child.kill()?;
        }
        let status = child.wait()?;
        let words = words.and_then(|words| words.join().ok()).unwrap_or_default();
        Ok(Self { seen, end, status, words })
    }

    /// Returns true if the worker fell silent or was killed before its first run.
    fn never_began(&self) -> bool {
        // Only a process killed by a signal has no exit code.
        let is_killed = self.end == End::Gone && self.status.code().is_none();
        self.seen.last.is_none() && (is_killed || self.end == End::Silent)
    }

    /// Returns the worker's history, with the failure that ended it.
    fn outcome(self, patience: Patience) -> Result<Seen> {
        let Self { seen, end, status, words } = self;
        let failure = match end {
            End::Done => return Ok(seen),
            End::Silent => Failure { kind: FailureKind::Time, message: format!("no end within {patience}") },
            End::Gone if words.contains("memory allocation of") => {
                Failure { kind: FailureKind::Memory, message: words }
            }
            End::Gone => Failure { kind: FailureKind::Abort, message: format!("{status}: {words}") },
        };
        let run = seen.last.with_context(|| format!("a worker ended before any run: {}", failure.message))?;
        let failures = seen.failures.into_iter().chain([FailedRun { run, failure }]).collect();
        Ok(Seen { failures, ..seen })
    }
}

/// Listens to a worker's stdout.
fn listen(child: &mut Child, patience: Patience) -> (Seen, End) {
    let news = news(child);
    let mut seen = Seen::default();
    let mut silence = None;
    loop {
        match news.recv_timeout(TICK) {
            Ok(News::Run(run)) => (seen.runs, seen.last) = (seen.runs + 1, Some(run)),
            Ok(News::Failed(failure)) => {
                seen.failures.push(FailedRun { run: seen.last.unwrap_or_default(), failure });
            }
            Ok(News::Done) => return (seen, End::Done),
            Err(RecvTimeoutError::Disconnected) => return (seen, End::Gone),
            Err(RecvTimeoutError::Timeout) => {
                let silence = silence.get_or_insert_with(|| Silence::of(child.id()));
                if silence.outlasts(patience) {
                    return (seen, End::Silent);
                }
                continue;
            }
        }
        silence = None;
    }
}

/// Returns the news that a worker prints to its stdout, read on a separate thread.
fn news(child: &mut Child) -> Receiver<News> {
    let (sender, receiver) = mpsc::channel();
    if let Some(stdout) = child.stdout.take() {
        thread::spawn(move || {
            let news = BufReader::new(stdout).lines().map_while(std::result::Result::ok);
            // The parent may stop listening at any time.
            let _ = news
                .filter_map(|line| serde_json::from_str(&line).ok())
                .try_for_each(|news| sender.send(news));
        });
    }
    receiver
}

/// Collects the end of a worker's stderr.
fn last_words(child: &mut Child) -> Option<JoinHandle<String>> {
    let mut stderr = child.stderr.take()?;
    Some(thread::spawn(move || {
        let mut said = Vec::new();
        // Unreadable output is dropped.
        let _ = stderr.read_to_end(&mut said);
        let from = said.len().saturating_sub(WORDS);
        String::from_utf8_lossy(&said[from..]).trim().to_owned()
    }))
}

/// The patience with a sleeping worker, as a multiple of that with a working one.
const SLEEP: u32 = 30;

/// How long a worker may stay silent.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// The processor time that it may use meanwhile; on systems that do not report it, wall-clock time.
    processor: Duration,
    /// Wall-clock time, which ends a sleeping worker.
    clock: Duration,
}

impl Patience {
    /// Returns a patience of `processor` in processor time, and thirty times as much in wall-clock time.
    pub fn of(processor: Duration) -> Self {
        Self { processor, clock: processor.saturating_mul(SLEEP) }
    }
}

impl fmt::Display for Patience {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of processor time, or {:?} of wall-clock time", self.processor, self.clock)
    }
}

/// A period of silence of a process.
#[derive(Debug)]
struct Silence {
    process: u32,
    begin: Instant,
    /// The processor time that the process had used when the silence began.
    used: Option<Duration>,
}

impl Silence {
    /// Starts a period of silence now.
    fn of(process: u32) -> Self {
        Self { process, begin: Instant::now(), used: processor_time(process) }
    }

    /// Returns true if it is longer than `patience`.
    fn outlasts(&self, patience: Patience) -> bool {
        let elapsed = self.begin.elapsed();
        let used = self.used.zip(processor_time(self.process));
        let worked = used.map_or(elapsed, |(before, now)| now.saturating_sub(before));
        worked >= patience.processor || elapsed >= patience.clock
    }
}

/// Returns the processor time that all threads of a process have used, if the system reports it.
#[cfg(target_os = "linux")]
fn processor_time(process: u32) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let milliseconds = ticks(&stat)?.saturating_mul(1000);
    milliseconds.checked_div(rustix::param::clock_ticks_per_second()).map(Duration::from_millis)
}

/// Returns the processor time that all threads of a process have used, if the system reports it.
#[cfg(not(target_os = "linux"))]
fn processor_time(_process: u32) -> Option<Duration> {
    None
}

/// Returns the sum of `utime` and `stime`: fields 14 and 15 of a line of `/proc/PID/stat`, in clock ticks.
#[cfg(target_os = "linux")]
fn ticks(stat: &str) -> Option<u64> {
    // The second field is a name in parentheses, which may itself contain spaces and parentheses.
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut times = after_name.split_ascii_whitespace().skip(11).map(|field| field.parse::<u64>().ok());
    Some(times.next()?? + times.next()??)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// A time that no shell here reaches.
    const LONG: Duration = Duration::from_secs(60);
    /// A patience that a shell exhausts only by working.
    const WORK: Patience = Patience { processor: Duration::from_millis(300), clock: LONG };
    /// A patience that a shell exhausts only by sleeping.
    const SLEEP: Patience = Patience { processor: LONG, clock: Duration::from_secs(1) };

    /// Watches a shell in place of a worker.
    fn seen(script: &str, patience: Patience) -> Result<Seen> {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        watch(command, "", patience)
    }

    /// Watches a shell that appends a line to a file, its `$0`, at every start; counts the starts.
    fn starts(script: &str, patience: Patience) -> (usize, Result<Seen>) {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("starts");
        let mut command = Command::new("sh");
        command.args(["-c", &format!("echo >> \"$0\"; {script}")]).arg(&file);
        let seen = watch(command, "", patience);
        (std::fs::read_to_string(&file).unwrap().lines().count(), seen)
    }

    fn kinds(seen: &Seen) -> Vec<(u64, FailureKind)> {
        seen.failures.iter().map(|failed| (failed.run, failed.failure.kind)).collect()
    }

    #[test]
    fn a_worker_that_tells_of_all_its_runs_is_heard() {
        let echo = r#"echo '{"run":4}'; echo '{"failed":{"kind":"panic","message":"a"}}'; echo '{"run":5}'; echo '"done"'"#;
        let seen = seen(echo, WORK).unwrap();
        assert_eq!((seen.runs, seen.last), (2, Some(5)));
        assert_eq!(kinds(&seen), [(4, FailureKind::Panic)]);
    }

    #[test]
    fn a_worker_that_ends_or_hangs_in_a_run_is_a_failure_of_it() {
        let after =
            |rest: &str, patience| kinds(&seen(&format!("echo '{{\"run\":7}}'; {rest}"), patience).unwrap());
        assert_eq!(after("exit 3", WORK), [(7, FailureKind::Abort)]);
        assert_eq!(after("kill -9 $$", WORK), [(7, FailureKind::Abort)]);
        assert_eq!(
            after("echo 'memory allocation of 9 bytes failed' >&2; exit 3", WORK),
            [(7, FailureKind::Memory)]
        );
        assert_eq!(after("while :; do :; done", WORK), [(7, FailureKind::Time)]);
        assert_eq!(after("exec sleep 60", SLEEP), [(7, FailureKind::Time)]);
    }

    /// A worker that waits for a processor uses no processor time, like one that sleeps.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_worker_that_waits_is_no_failure() {
        let seen = seen(r#"echo '{"run":7}'; sleep 1; echo '"done"'"#, WORK).unwrap();
        assert_eq!((kinds(&seen), seen.runs), (vec![], 1));
    }

    #[test]
    fn a_worker_that_does_not_begin_is_an_error() {
        let (starts, outcome) = starts("echo 'no such folder' >&2; exit 2", WORK);
        let error = outcome.unwrap_err();
        assert!(error.to_string().contains("no such folder"), "{error}");
        assert_eq!(starts, 1, "its own error is enough");
    }

    #[test]
    fn a_worker_that_is_killed_or_silent_before_its_first_run_is_started_anew_twice() {
        let third =
            |end: &str| format!(r#"[ $(wc -l < "$0") -gt 2 ] || {end}; echo '{{"run":7}}'; echo '"done"'"#);
        for (end, patience) in [("kill -9 $$", WORK), ("exec sleep 60", SLEEP)] {
            let (starts, outcome) = starts(&third(end), patience);
            assert_eq!((starts, outcome.unwrap().runs), (3, 1), "{end}");
        }
        let (starts, outcome) = starts("kill -9 $$", WORK);
        assert_eq!(starts, 3);
        assert!(outcome.unwrap_err().to_string().contains("before any run"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn ticks_are_found_behind_any_name() {
        assert_eq!(ticks("7 (a) b) 1) R 1 2 3 4 -1 6 7 8 9 10 250 31 12 13 20 0"), Some(281));
        assert_eq!([ticks("7 (a) R 1 2"), ticks("")], [None, None]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn work_ends_patience_and_sleep_does_not() {
        let silence = Silence::of(std::process::id());
        let short = Duration::from_millis(50);
        std::thread::sleep(short);
        let patience = Patience { processor: Duration::from_secs(3600), clock: short };
        assert!(silence.outlasts(patience), "the clock ends it");
        assert!(!silence.outlasts(Patience { clock: Duration::from_secs(3600), ..patience }));
        let until = processor_time(silence.process).unwrap() + short;
        while processor_time(silence.process).unwrap() < until {}
        assert!(silence.outlasts(Patience { processor: short, clock: Duration::from_secs(3600) }));
    }
}
