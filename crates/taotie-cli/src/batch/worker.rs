//! The process of one asset: what the driver of a collection starts.

use crate::stop;
use anyhow::{Context, Result};
use std::ffi::OsString;
use std::io::{self, BufRead, Write};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Mutex, PoisonError};
use taotie_batch::{Go, Host, Job, Message, Worker};

/// The subcommand that is such a process. It is not for users.
pub const WORKER: &str = "batch-worker";

/// Names the Python that this command runs in, as a package of it.
const PYTHON: &str = "TAOTIE_PYTHON";

/// Returns how this program is started as the process of an asset.
pub fn worker() -> Result<Worker> {
    // As a Python package, this is Python, whose module is started.
    let (program, module): (_, &[&str]) = match std::env::var_os(PYTHON) {
        Some(python) => (python.into(), &["-m", "taotie"]),
        None => (std::env::current_exe().context("the program's own file is not known")?, &[]),
    };
    let arguments = module.iter().chain([&WORKER]).map(OsString::from).collect();
    Ok(Worker { program, arguments })
}

/// Does the job that stands on stdin. When stdin ends the driver is gone, and so is this process, at once.
pub fn run() -> Result<()> {
    let (job, go) = listen()?;
    let (stdout, go) = (Mutex::new(io::stdout()), Mutex::new(go));
    let tell = |message: Message| {
        let mut line = serde_json::to_vec(&message).unwrap_or_default();
        line.push(b'\n');
        let mut stdout = stdout.lock().unwrap_or_else(PoisonError::into_inner);
        // A driver that has gone hears nothing.
        let _ = stdout.write_all(&line).and_then(|()| stdout.flush());
    };
    let wait = || {
        let said = go.lock().unwrap_or_else(PoisonError::into_inner).recv();
        said.unwrap_or_else(|_| stop::wait())
    };
    let host = Host { files: &stop::files, tell: &tell, go: &wait };
    let outcome = taotie_batch::work(&job, host);
    tell(Message::Ended(Box::new(outcome)));
    Ok(())
}

/// Reads the job; begins a thread that waits for the word to begin, and for the end of stdin.
fn listen() -> Result<(Job, Receiver<Go>)> {
    let mut line = String::new();
    io::stdin().read_line(&mut line)?;
    let job = serde_json::from_str(&line)
        .context("stdin: a job is wanted; this subcommand is for `taotie batch`")?;
    let (sender, receiver) = mpsc::channel();
    let waiting = move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if let Ok(go) = serde_json::from_str::<Go>(&line) {
                let _ = sender.send(go);
            }
        }
        stop::end_quietly();
    };
    std::thread::Builder::new().spawn(waiting)?;
    Ok((job, receiver))
}
