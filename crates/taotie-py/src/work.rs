//! Work without the interpreter's lock, that tells how far it is and ends when Python wants it to.

use crate::error::exception;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;
use taotie::{Error, Progress, Result, Warnings};

/// The interval at which signals are looked for and progress is told.
const POLL: Duration = Duration::from_millis(20);

/// How a piece of work is run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Running {
    /// Called with the stage and the fraction of it that is done; `False` stops the work.
    progress: Option<Py<PyAny>>,
    /// Threads, 1 to 1024; all of the machine's where `None`.
    threads: Option<usize>,
}

/// What the work has told last, and whether it is to stop.
#[derive(Default)]
struct Told {
    last: Mutex<(&'static str, f64)>,
    is_stopped: AtomicBool,
}

impl Told {
    fn tell(&self, stage: &'static str, fraction: f64) -> bool {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = (stage, fraction);
        !self.is_stopped.load(Ordering::Relaxed)
    }

    fn last(&self) -> (&'static str, f64) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Does work on a thread of its own, while this one looks for signals and tells Python's listener the progress.
///
/// # Errors
/// Those of the work, of the listener, and of a signal's handler: `KeyboardInterrupt`.
pub fn run<T: Send>(
    py: Python<'_>,
    running: &Running,
    work: impl FnOnce(Progress<'_>) -> Result<T> + Send,
) -> PyResult<T> {
    let told = Told::default();
    let done = py.detach(|| thread::scope(|scope| watched(scope, (running, &told), work)));
    match done {
        (_, Some(raised)) => Err(raised),
        (Ok(result), None) => Ok(result),
        (Err(error), None) => Err(exception(py, &error)),
    }
}

/// Returns the work's result, and what Python raised meanwhile.
fn watched<'scope, T: Send + 'scope>(
    scope: &'scope thread::Scope<'scope, '_>,
    (running, told): (&'scope Running, &'scope Told),
    work: impl FnOnce(Progress<'_>) -> Result<T> + Send + 'scope,
) -> (Result<T>, Option<PyErr>) {
    let (done, is_done) = mpsc::channel::<()>();
    let worker = scope.spawn(move || {
        let listener = |stage: &'static str, fraction: f64| told.tell(stage, fraction);
        let result = running.in_pool(|| work(Progress::new(&listener)));
        drop(done);
        result
    });
    let mut raised = None;
    while let Err(RecvTimeoutError::Timeout) = is_done.recv_timeout(POLL) {
        if raised.is_none() {
            raised = Python::attach(|py| running.hear(py, told.last())).err();
            told.is_stopped.store(raised.is_some(), Ordering::Relaxed);
        }
    }
    match worker.join() {
        Ok(result) => (result, raised),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

impl Running {
    /// Handles signals and tells the listener.
    fn hear(&self, py: Python<'_>, (stage, fraction): (&'static str, f64)) -> PyResult<()> {
        py.check_signals()?;
        let Some(progress) = self.progress.as_ref().filter(|_| !stage.is_empty()) else { return Ok(()) };
        let answer = progress.bind(py).call1((stage, fraction))?;
        let goes_on = answer.is_none() || answer.is_truthy()?;
        if goes_on { Ok(()) } else { Err(exception(py, &Error::Cancelled)) }
    }

    /// Does work on the threads asked for.
    fn in_pool<T: Send>(&self, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
        let Some(threads) = self.threads else { return work() };
        let wrong = |why: &str| Error::invalid(format!("{threads} threads"), why);
        if !(1..=1024).contains(&threads) {
            return Err(wrong("give 1 to 1024, or None for all of the machine's"));
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map_err(|_| wrong("the system starts no more of them; ask for fewer"))?.install(work)
    }
}

/// Warnings as Python takes them: each kind with its count.
pub type Listed = Vec<(String, usize)>;

/// Returns warnings as Python takes them.
pub fn listed(warnings: &Warnings) -> Listed {
    warnings.iter().map(|(what, count)| (what.to_owned(), count)).collect()
}
