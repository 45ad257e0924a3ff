//! The process of an asset, as seen by its driver; and an asset made again by one, to compare it with the existing
//! one.

use crate::collection::{Collection, Kind};
use crate::job::{Go, Job, Message, Outcome};
use crate::record::Record;
use serde::Serialize;
use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use taotie::Limits;
use taotie_engine::{Error, Result};

/// How often processes are checked, and the caller is asked whether to go on.
pub const POLL: Duration = Duration::from_millis(50);

/// The program that does a job: it reads [`Job`] and [`Go`] from its stdin, one line of JSON each, writes
/// [`Message`]s to its stdout, and exits at the end of its stdin.
#[derive(Debug, Clone)]
pub struct Worker {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<OsString>,
}

/// A message from a process; `said` is `None` once it has closed its stdout.
pub struct Heard {
    /// The process.
    pub number: u64,
    /// The message.
    pub said: Option<Message>,
}

/// A process at work on an asset. It exits when its stdin is closed, so it never outlives its driver, however that
/// ends.
pub struct Process {
    /// Its number among the driver's processes.
    pub number: u64,
    child: Child,
    stdin: Option<ChildStdin>,
    complaints: Option<JoinHandle<String>>,
}

/// How to start a process.
#[derive(Clone, Copy)]
pub struct Start<'a> {
    /// The program.
    pub worker: &'a Worker,
    /// Its working folder.
    pub folder: &'a Path,
    /// Its number among the driver's processes.
    pub number: u64,
}

impl Start<'_> {
    /// Starts a process and sends it its job.
    ///
    /// # Errors
    /// System errors, and paths that are not UTF-8.
    pub fn process(self, job: &Job, heard: &Sender<Heard>) -> io::Result<Process> {
        let Self { worker, folder, number } = self;
        let job = line_of(job)?;
        let mut command = Command::new(&worker.program);
        command.args(&worker.arguments).current_dir(folder);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // Ctrl-C is for the driver, which ends its processes itself.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn()?;
        let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        if let Some(stdout) = stdout {
            let heard = heard.clone();
            thread::Builder::new().spawn(move || listen(stdout, number, &heard))?;
        }
        let complaints =
            stderr.map(|stderr| thread::Builder::new().spawn(move || tail(stderr))).transpose()?;
        let mut process = Process { number, child, stdin, complaints };
        // If it has already ended, its closed stdout reports that.
        let _ = process.send(&job);
        Ok(process)
    }
}

impl Process {
    /// Lets it begin baking.
    pub fn go(&mut self, threads: usize) {
        // If it has ended, its closed stdout reports that.
        let _ = line_of(&Go { threads }).and_then(|line| self.send(&line));
    }

    fn send(&mut self, line: &[u8]) -> io::Result<()> {
        let Some(stdin) = &mut self.stdin else { return Ok(()) };
        stdin.write_all(line).and_then(|()| stdin.flush())
    }

    /// Returns its process id.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Kills it.
    pub fn kill(&mut self) {
        // It may have already ended.
        let _ = self.child.kill();
    }

    /// Waits for its end; returns its exit status and the tail of its stderr.
    ///
    /// # Errors
    /// System errors.
    pub fn wait(&mut self) -> io::Result<(ExitStatus, String)> {
        drop(self.stdin.take());
        let status = self.child.wait()?;
        let said = self.complaints.take().and_then(|thread| thread.join().ok());
        Ok((status, said.unwrap_or_default()))
    }

    /// Lets it end in an orderly way, leaving nothing half written. If it does not end in time, it is killed.
    pub fn end(mut self) {
        const MOST: Duration = Duration::from_secs(5);
        drop(self.stdin.take());
        let start = Instant::now();
        while start.elapsed() < MOST {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            thread::sleep(Duration::from_millis(5));
        }
        self.kill();
        let _ = self.child.wait();
    }
}

/// Returns a value as a line of JSON.
///
/// # Errors
/// Paths that are not UTF-8.
fn line_of(what: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut line = serde_json::to_vec(what)?;
    line.push(b'\n');
    Ok(line)
}

/// Forwards a process's messages until it closes its stdout. Malformed lines are skipped.
fn listen(stdout: ChildStdout, number: u64, heard: &Sender<Heard>) {
    let lines = BufReader::new(stdout).split(b'\n').map_while(std::result::Result::ok);
    let messages = lines.filter_map(|line| serde_json::from_slice(&line).ok());
    for message in messages {
        let _ = heard.send(Heard { number, said: Some(message) });
    }
    let _ = heard.send(Heard { number, said: None });
}

/// Reads all of a process's stderr; returns the last part of it.
fn tail(mut stderr: ChildStderr) -> String {
    const MOST: usize = 1 << 13;
    let (mut kept, mut block) = (Vec::new(), [0; 4096]);
    while let Ok(count @ 1..) = stderr.read(&mut block) {
        kept.extend_from_slice(&block[..count]);
        if kept.len() > MOST {
            kept.drain(..kept.len() - MOST);
        }
    }
    String::from_utf8_lossy(&kept).trim().to_owned()
}

/// Makes an asset again in a temporary folder. `hear` returns true to go on.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Io`] if the folder or the process cannot be created.
pub fn remake(
    record: &Record,
    collection: &Collection,
    worker: &Worker,
    hear: &mut dyn FnMut(f64) -> bool,
) -> Result<Outcome> {
    let root = collection.output();
    let place = tempfile::Builder::new().prefix(".taotie-proof-").tempdir_in(&root);
    let place = place.map_err(|e| Error::io(&root, e))?;
    // Relative, since the folder of the collection may have a name that is not UTF-8, which JSON does not hold.
    let output = collection.relative_output().join(place.path().file_name().unwrap_or_default());
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let scan = record.source().map(Path::to_path_buf).unwrap_or_default();
    let kind = if record.photographs.is_some() { Kind::Photographs } else { Kind::Scan };
    let mut settings = collection.settings(&record.id, kind)?;
    settings.task.take_points(record.points);
    let job = Job {
        id: record.id.clone(),
        scan,
        output,
        settings,
        limits: Limits::default().or_free(),
        threads,
        reuse: false,
    };
    let (sender, heard) = mpsc::channel();
    let folder = nonempty(collection.folder());
    let started = Start { worker, folder: &folder, number: 0 }.process(&job, &sender);
    let mut process = started.map_err(|e| Error::io(&worker.program, e))?;
    let mut outcome = None;
    loop {
        match heard.recv_timeout(POLL) {
            Ok(Heard { said: Some(Message::Forecast { .. }), .. }) => process.go(threads),
            Ok(Heard { said: Some(Message::Ended(ended)), .. }) => outcome = Some(*ended),
            Ok(Heard { said: Some(_), .. }) | Err(RecvTimeoutError::Timeout) => {}
            Ok(Heard { said: None, .. }) | Err(RecvTimeoutError::Disconnected) => break,
        }
        if !hear(1.0) {
            process.end();
            return Err(Error::Cancelled);
        }
    }
    let ended = process.wait().map_err(|e| Error::io(&worker.program, e))?;
    let lost = || Error::invalid(&record.id, format!("its process ended without a result: {}", ended.1));
    outcome.ok_or_else(lost)
}

/// Returns the folder's path, `.` if it is empty.
pub fn nonempty(folder: &Path) -> PathBuf {
    if folder.as_os_str().is_empty() { ".".into() } else { folder.to_path_buf() }
}
