//! Work without the interpreter's lock, which reports progress and can be stopped from Python.

use crate::error::exception;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;
use taotie_engine::{Error, Progress, Result, Warnings};

/// How often signals are checked and progress is reported.
const POLL: Duration = Duration::from_millis(20);

/// How to run a piece of work.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Running {
    /// Called with the stage and the fraction of it done; returns `False` to stop the work.
    progress: Option<Py<PyAny>>,
    /// The number of threads, 1 to 1024; `None` for all of the machine's.
    threads: Option<usize>,
}

/// The latest progress, and whether to stop.
#[derive(Default)]
struct Told {
    last: Mutex<(&'static str, f64)>,
    is_stopped: AtomicBool,
}

impl Told {
    fn update(&self, stage: &'static str, fraction: f64) -> bool {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = (stage, fraction);
        !self.is_stopped.load(Ordering::Relaxed)
    }

    fn last(&self) -> (&'static str, f64) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Does work on a separate thread, while this one checks for signals and reports progress to Python's listener.
///
/// # Errors
/// Errors of the work, of the listener, and of a signal handler: `KeyboardInterrupt`.
pub fn run<T: Send>(
    py: Python<'_>,
    running: &Running,
    work: impl FnOnce(Progress<'_>) -> Result<T> + Send,
) -> PyResult<T> {
    let status = Told::default();
    let done = py.detach(|| thread::scope(|scope| watched(scope, (running, &status), work)));
    match done {
        (_, Some(raised)) => Err(raised),
        (Ok(result), None) => Ok(result),
        (Err(error), None) => Err(exception(py, &error)),
    }
}

/// Returns the work's result, and the exception that Python raised meanwhile, if any.
fn watched<'scope, T: Send + 'scope>(
    scope: &'scope thread::Scope<'scope, '_>,
    (running, status): (&'scope Running, &'scope Told),
    work: impl FnOnce(Progress<'_>) -> Result<T> + Send + 'scope,
) -> (Result<T>, Option<PyErr>) {
    let (done, is_done) = mpsc::channel::<()>();
    let worker = scope.spawn(move || {
        let listener = |stage: &'static str, fraction: f64| status.update(stage, fraction);
        let result = running.in_pool(|| work(Progress::new(&listener)));
        drop(done);
        result
    });
    let mut raised = None;
    while let Err(RecvTimeoutError::Timeout) = is_done.recv_timeout(POLL) {
        if raised.is_none() {
            raised = Python::attach(|py| running.hear(py, status.last())).err();
            status.is_stopped.store(raised.is_some(), Ordering::Relaxed);
        }
    }
    match worker.join() {
        Ok(result) => (result, raised),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

impl Running {
    /// Handles signals and calls the listener.
    fn hear(&self, py: Python<'_>, (stage, fraction): (&'static str, f64)) -> PyResult<()> {
        py.check_signals()?;
        let Some(progress) = self.progress.as_ref().filter(|_| !stage.is_empty()) else { return Ok(()) };
        let answer = progress.bind(py).call1((stage, fraction))?;
        let goes_on = answer.is_none() || answer.is_truthy()?;
        if goes_on { Ok(()) } else { Err(exception(py, &Error::Cancelled)) }
    }

    /// Does work on the requested number of threads.
    fn in_pool<T: Send>(&self, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
        let Some(threads) = self.threads else { return pool()?.install(work) };
        let wrong = |why: &str| Error::invalid(format!("threads {threads}"), why);
        if !(1..=1024).contains(&threads) {
            return Err(wrong("use 1 to 1024, or None for all of the machine's"));
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map_err(|_| wrong("the system cannot start that many; use fewer"))?.install(work)
    }
}

/// Does short work without the interpreter's lock, on all of the machine's threads.
///
/// # Errors
/// Those of the work; [`Error::Limit`] if the system cannot start the threads.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T> + Send) -> PyResult<T> {
    py.detach(|| pool()?.install(work)).map_err(|error| exception(py, &error))
}

/// The threads for all work of a process, and the process. A child made by `fork` has none of its parent's threads:
/// work would wait for them forever, as it would in Rayon's global pool.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Returns the threads of this process, started on the first call.
fn pool() -> Result<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = &*kept
        && *owner == process
    {
        return Ok(Arc::clone(pool));
    }
    let threads = taotie_io::most_threads().unwrap_or(0);
    let started = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Error::limit("the number of threads", format!("the system cannot start more ({error}); use fewer"))
    })?;
    let pool = Arc::new(started);
    // The parent's pool is not dropped: its state is that of threads which do not exist here.
    std::mem::forget(kept.replace((process, Arc::clone(&pool))));
    Ok(pool)
}

/// Warnings for Python: each message with its count.
pub type Listed = Vec<(String, usize)>;

/// Converts warnings for Python.
pub fn listed(warnings: &Warnings) -> Listed {
    warnings.iter().map(|(what, count)| (what.to_owned(), count)).collect()
}
