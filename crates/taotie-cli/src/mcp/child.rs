//! The process of a call: this program again, which ends when its stdin does.

use crate::console::ProgressLine;
use crate::lines::{self, Line};
use crate::{Outcome, batch, stop};
use anyhow::{Context, Result};
use clap::Args;
use std::ffi::OsString;
use std::future::Future;
use std::io;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncRead, AsyncReadExt, BufReader};
use tokio::process::{Child, ChildStderr, Command};

/// The subcommand of such a process; not for users.
pub const WORKER: &str = "mcp-worker";

/// The command that such a process runs.
#[derive(Args)]
pub struct WorkerArgs {
    /// A subcommand and its arguments
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Runs a subcommand with messages, progress and pictures as lines on stderr. When stdin ends, so does this process;
/// no file is then half-written.
pub fn work(args: &WorkerArgs) -> Result<Outcome> {
    lines::want();
    let waiting = || {
        let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
        stop::end_quietly();
    };
    std::thread::Builder::new().spawn(waiting)?;
    let program = ["taotie", "--progress"].map(OsString::from);
    Ok(match crate::exit_code(program.into_iter().chain(args.arguments.iter().cloned())) {
        0 => Outcome::Fine,
        1 => Outcome::Different,
        _ => Outcome::Failed,
    })
}

/// Largest report on stdout, bytes.
const MOST_JSON: u64 = 64 << 20;

/// Time for a cancelled process to end, before it is killed.
const PATIENCE: Duration = Duration::from_secs(5);

/// Receives the progress of a process.
pub trait Listener {
    /// Called for each report of progress: a stage, and the fraction of it that is done.
    fn hear(&mut self, stage: &str, fraction: f64) -> impl Future<Output = ()>;
}

/// The outcome of a process.
#[derive(Debug, Default)]
pub struct Done {
    /// Its exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// Its stdout.
    pub json: Vec<u8>,
    /// The lines other than progress.
    pub lines: Vec<Line>,
}

/// Runs a subcommand in a separate process, in `folder`. Returns `None` if it was cancelled; it has ended then.
///
/// # Errors
/// If the process cannot be started.
pub async fn run(
    arguments: &[OsString],
    folder: &Path,
    listener: &mut impl Listener,
    cancelled: impl Future<Output = ()>,
) -> Result<Option<Done>> {
    let mut child = started(arguments, folder)?;
    let stdin = child.stdin.take();
    let done = {
        let working = watched(&mut child, listener);
        tokio::pin!(working, cancelled);
        tokio::select! {
            done = &mut working => Some(done?),
            () = &mut cancelled => None,
        }
    };
    if done.is_none() {
        drop(stdin);
        if tokio::time::timeout(PATIENCE, child.wait()).await.is_err() {
            child.kill().await.context("cannot end the process of a cancelled call")?;
        }
    }
    Ok(done)
}

fn started(arguments: &[OsString], folder: &Path) -> Result<Child> {
    let (program, module) = batch::this_program()?;
    let mut command = Command::new(program);
    command.args(module).arg(WORKER).args(arguments).current_dir(folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().context("cannot start the process of a call")
}

/// Reads everything that a process writes, until it ends.
async fn watched(child: &mut Child, listener: &mut impl Listener) -> Result<Done> {
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let (json, lines, status) = tokio::join!(read(stdout), listen(stderr, listener), child.wait());
    Ok(Done { code: status?.code(), json: json?, lines: lines? })
}

async fn read(stdout: Option<impl AsyncRead + Unpin>) -> io::Result<Vec<u8>> {
    let mut json = Vec::new();
    if let Some(stdout) = stdout {
        stdout.take(MOST_JSON).read_to_end(&mut json).await?;
    }
    Ok(json)
}

async fn listen(stderr: Option<ChildStderr>, listener: &mut impl Listener) -> io::Result<Vec<Line>> {
    let mut heard = Vec::new();
    let Some(stderr) = stderr else { return Ok(heard) };
    let mut reader = BufReader::new(stderr);
    let mut text = Vec::new();
    while reader.read_until(b'\n', &mut text).await? > 0 {
        if let Ok(line) = serde_json::from_slice::<ProgressLine>(&text) {
            listener.hear(&line.stage, line.done).await;
        } else {
            // Other lines come from libraries and drivers.
            let message = || Line::Message(String::from_utf8_lossy(&text).trim_end().to_owned());
            heard.push(serde_json::from_slice(&text).unwrap_or_else(|_| message()));
        }
        text.clear();
    }
    Ok(heard)
}
