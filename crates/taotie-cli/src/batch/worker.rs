//! The process of one object, started by the driver of a collection.

use crate::{photometric, stop};
use anyhow::{Context, Result};
use std::ffi::OsString;
use std::io::{self, BufRead, Write};
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Mutex, PoisonError};
use taotie_batch::{Go, Host, Job, Message, Worker};

/// The subcommand of such a process; not for users.
pub const WORKER: &str = "batch-worker";

/// Environment variable with the Python interpreter, if this command runs in a Python package.
const PYTHON: &str = "TAOTIE_PYTHON";

/// Returns the command that starts this program as the process of an asset.
pub fn worker() -> Result<Worker> {
    let (program, module) = this_program()?;
    let arguments = module.iter().chain([&WORKER]).map(OsString::from).collect();
    Ok(Worker { program, arguments })
}

/// Returns this program, and its first arguments.
pub fn this_program() -> Result<(PathBuf, &'static [&'static str])> {
    // In a Python package the executable is Python: start its module.
    Ok(match std::env::var_os(PYTHON) {
        Some(python) => (python.into(), &["-m", "taotie"]),
        None => (std::env::current_exe().context("cannot find the program's own executable")?, &[]),
    })
}

/// Does the job given on stdin. When stdin ends, the driver is gone, and this process ends immediately.
pub fn run() -> Result<()> {
    let (job, go) = listen()?;
    let (stdout, go) = (Mutex::new(io::stdout()), Mutex::new(go));
    let send = |message: Message| {
        let mut line = serde_json::to_vec(&message).unwrap_or_default();
        line.push(b'\n');
        let mut stdout = stdout.lock().unwrap_or_else(PoisonError::into_inner);
        // Errors are ignored: the driver may be gone.
        let _ = stdout.write_all(&line).and_then(|()| stdout.flush());
    };
    let wait = || {
        let said = go.lock().unwrap_or_else(PoisonError::into_inner).recv();
        said.unwrap_or_else(|_| stop::wait())
    };
    let host = Host { files: &stop::files, send: &send, go: &wait, estimate: &photometric::fill };
    let outcome = taotie_batch::work(&job, host);
    send(Message::Ended(Box::new(outcome)));
    Ok(())
}

/// Reads the job; starts a thread that waits for the go-ahead, and for the end of stdin.
fn listen() -> Result<(Job, Receiver<Go>)> {
    let mut line = String::new();
    io::stdin().read_line(&mut line)?;
    let job = serde_json::from_str(&line)
        .context("stdin: expected a job; this subcommand is for `taotie batch`")?;
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
