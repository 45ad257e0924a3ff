//! The process of an asset, as its driver sees it.

use crate::job::{Go, Job, Message};
use serde::Serialize;
use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::Sender;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// The program that does a job: it reads [`Job`] and [`Go`] from its stdin, a line of JSON each, writes [`Message`]s to
/// its stdout, and ends when its stdin ends.
#[derive(Debug, Clone)]
pub struct Worker {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<OsString>,
}

/// Something that a process said; nothing where it has closed its stdout.
pub struct Heard {
    /// The process.
    pub number: u64,
    /// What it said.
    pub said: Option<Message>,
}

/// A process at work on an asset. It ends when its stdin is closed: so it outlives no driver, however that ends.
pub struct Process {
    /// Its number among all of the driver's.
    pub number: u64,
    child: Child,
    stdin: Option<ChildStdin>,
    complaints: Option<JoinHandle<String>>,
}

/// The start of a process.
#[derive(Clone, Copy)]
pub struct Start<'a> {
    /// The program.
    pub worker: &'a Worker,
    /// The folder that it runs in.
    pub folder: &'a Path,
    /// Its number among all of the driver's.
    pub number: u64,
}

impl Start<'_> {
    /// Starts a process, and tells it its job.
    ///
    /// # Errors
    /// Those of the system.
    pub fn process(self, job: &Job, heard: &Sender<Heard>) -> io::Result<Process> {
        let Self { worker, folder, number } = self;
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
        // Where it has ended already, that is heard.
        let _ = process.tell(job);
        Ok(process)
    }
}

impl Process {
    /// Lets it begin its work.
    pub fn go(&mut self, threads: usize) {
        // Where it has ended, that is heard.
        let _ = self.tell(&Go { threads });
    }

    fn tell(&mut self, what: &impl Serialize) -> io::Result<()> {
        let Some(stdin) = &mut self.stdin else { return Ok(()) };
        let mut line = serde_json::to_vec(what)?;
        line.push(b'\n');
        stdin.write_all(&line).and_then(|()| stdin.flush())
    }

    /// Returns its number in the system.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Ends it at once.
    pub fn kill(&mut self) {
        // It may have ended.
        let _ = self.child.kill();
    }

    /// Waits for its end; returns how it ended and the last that it said to its stderr.
    ///
    /// # Errors
    /// Those of the system.
    pub fn wait(&mut self) -> io::Result<(ExitStatus, String)> {
        drop(self.stdin.take());
        let status = self.child.wait()?;
        let said = self.complaints.take().and_then(|thread| thread.join().ok());
        Ok((status, said.unwrap_or_default()))
    }

    /// Lets it end in order: nothing half written is left. One that does not is killed.
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

/// Hands on what a process says, until it closes its stdout. Lines that say nothing are passed over.
fn listen(stdout: ChildStdout, number: u64, heard: &Sender<Heard>) {
    let lines = BufReader::new(stdout).split(b'\n').map_while(Result::ok);
    let messages = lines.filter_map(|line| serde_json::from_slice(&line).ok());
    for message in messages {
        let _ = heard.send(Heard { number, said: Some(message) });
    }
    let _ = heard.send(Heard { number, said: None });
}

/// Reads all that a process complains of; returns the last of it.
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
