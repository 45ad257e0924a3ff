//! The progress of long work, and its cancellation.

use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

/// False for WebAssembly, which has one thread: loops and [`Progress::apart`] run on it.
pub const HAS_THREADS: bool = !cfg!(target_family = "wasm");

/// How often a listener is asked whether to continue while work runs on other threads.
const POLL: Duration = Duration::from_millis(20);

/// A caller's function: takes the stage and its completed fraction, in [0, 1], and returns whether to continue.
///
/// It may be called from any thread, and concurrently.
pub type Listener<'a> = dyn Fn(&'static str, f64) -> bool + Sync + 'a;

/// Reports progress to the caller and lets the caller cancel.
///
/// ```
/// use taotie_engine::{Error, progress::Progress};
///
/// let listener = |stage: &'static str, done: f64| {
///     println!("{stage}: {:.0} %", done * 100.0);
///     done < 0.5
/// };
/// let progress = Progress::new(&listener).stage("simplify");
/// assert!(progress.at(0.25).is_ok());
/// assert!(matches!(progress.at(0.5), Err(Error::Cancelled)));
/// ```
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    listener: Option<&'a Listener<'a>>,
    stage: &'static str,
    /// The fractions of the stage at which this work begins and ends.
    range: [f64; 2],
}

impl<'a> Progress<'a> {
    /// Reports to no listener and never stops.
    pub const SILENT: Progress<'static> = Progress { listener: None, stage: "", range: [0.0, 1.0] };

    /// Reports to `listener`.
    pub fn new(listener: &'a Listener<'a>) -> Self {
        Self { listener: Some(listener), ..Progress::SILENT }
    }

    /// Returns the same progress reporter for a separate stage, from 0 to 1.
    pub fn stage(self, stage: &'static str) -> Self {
        Self { stage, range: [0.0, 1.0], ..self }
    }

    /// Begins a stage: reports 0 for it and returns its progress reporter.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the listener cancels the work.
    pub fn begin(self, stage: &'static str) -> Result<Self> {
        let begun = self.stage(stage);
        begun.at(0.0).map(|()| begun)
    }

    /// Returns the progress reporter for work that takes this stage from the fraction `from` to the fraction `to`.
    pub fn part(self, from: f64, to: f64) -> Self {
        Self { range: [from, to].map(|fraction| self.overall(fraction)), ..self }
    }

    /// Reports that the fraction `done` of the work, in [0, 1], is complete.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the listener cancels the work.
    pub fn at(&self, done: f64) -> Result<()> {
        match self.listener {
            Some(listener) if !listener(self.stage, self.overall(done)) => Err(Error::Cancelled),
            _ => Ok(()),
        }
    }

    /// Runs work on separate threads, as many as the caller's pool has, and asks the listener about every 20 ms
    /// whether to continue, even if the work reports nothing for longer. Long calls that cannot be split thus do not
    /// delay cancellation.
    ///
    /// The listener is called only from the caller's thread. Without a listener, or on a system without threads, that
    /// thread does the work itself.
    ///
    /// # Errors
    /// Those of the work; [`Error::Cancelled`], immediately, if the listener cancels: the work then stops at its next
    /// progress report, and its result is dropped. [`Error::Limit`] if the system cannot start more threads.
    pub fn apart<T: Send + 'static>(
        self,
        work: impl FnOnce(Progress<'_>) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        let Some(listener) = self.listener.filter(|_| HAS_THREADS) else { return work(self) };
        let (news, received) = mpsc::channel();
        let stopped = Arc::new(AtomicBool::new(false));
        let begin = Begin { stage: self.stage, range: self.range, threads: rayon::current_num_threads() };
        let is_stopped = Arc::clone(&stopped);
        let thread = std::thread::Builder::new()
            .spawn(move || begin.work(work, &news, &is_stopped))
            .map_err(|error| no_threads(&error))?;
        let mut reported = Report { stage: self.stage, fraction: self.overall(0.0) };
        loop {
            match received.recv_timeout(POLL) {
                Ok(News::Done(result)) => return result,
                Ok(News::Report(news)) => reported = news,
                Err(RecvTimeoutError::Timeout) => {}
                // The thread ended without a result, so it panicked: propagate that panic.
                Err(RecvTimeoutError::Disconnected) => match thread.join() {
                    Err(panic) => std::panic::resume_unwind(panic),
                    Ok(()) => return Err(Error::Cancelled),
                },
            }
            if !listener(reported.stage, reported.fraction) {
                stopped.store(true, Ordering::Relaxed);
                return Err(Error::Cancelled);
            }
        }
    }

    fn overall(&self, done: f64) -> f64 {
        let [from, to] = self.range;
        from + done.clamp(0.0, 1.0) * (to - from)
    }
}

/// The latest progress of work on other threads.
struct Report {
    stage: &'static str,
    fraction: f64,
}

/// A message from work on other threads to its caller.
enum News<T> {
    Report(Report),
    Done(Result<T>),
}

/// The start of work on other threads: the stage, its range and the number of threads.
struct Begin {
    stage: &'static str,
    range: [f64; 2],
    threads: usize,
}

impl Begin {
    fn work<T: Send>(
        self,
        work: impl FnOnce(Progress<'_>) -> Result<T> + Send,
        news: &mpsc::Sender<News<T>>,
        stopped: &AtomicBool,
    ) {
        // If the caller has gone, sending fails and the work stops.
        let listener = |stage: &'static str, fraction: f64| {
            news.send(News::Report(Report { stage, fraction })).is_ok() && !stopped.load(Ordering::Relaxed)
        };
        let progress = Progress { listener: Some(&listener), stage: self.stage, range: self.range };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build();
        let result = match pool {
            Ok(pool) => pool.install(|| work(progress)),
            Err(error) => Err(no_threads(&error)),
        };
        let _ = news.send(News::Done(result));
    }
}

fn no_threads(error: &dyn std::error::Error) -> Error {
    Error::limit("the number of threads", format!("the system cannot start more ({error}); use fewer"))
}

impl std::fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("stage", &self.stage).field("range", &self.range).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn parts_of_parts_lie_within_their_stage() {
        let reported = Mutex::new(Vec::new());
        let listener = |stage: &'static str, done: f64| {
            reported.lock().unwrap().push((stage, done));
            true
        };
        let second_half = Progress::new(&listener).stage("bake").part(0.5, 1.0);
        second_half.at(0.5).unwrap();
        second_half.part(0.0, 0.5).at(1.0).unwrap();
        second_half.at(7.0).unwrap();
        second_half.stage("store").at(0.25).unwrap();
        assert_eq!(
            *reported.lock().unwrap(),
            [("bake", 0.75), ("bake", 0.75), ("bake", 1.0), ("store", 0.25)]
        );
    }

    #[test]
    fn work_apart_tells_all_its_stages_and_gives_its_result() {
        let reported = Mutex::new(Vec::new());
        let listener = |stage: &'static str, done: f64| {
            reported.lock().unwrap().push((stage, done));
            true
        };
        let result = Progress::new(&listener).apart(|progress| {
            progress.begin("read")?;
            progress.begin("sort")?.part(0.5, 1.0).at(0.5)?;
            Ok(rayon::current_num_threads())
        });
        assert_eq!(result.unwrap(), rayon::current_num_threads());
        let mut reported = reported.into_inner().unwrap();
        reported.dedup();
        reported.retain(|(stage, _)| !stage.is_empty());
        assert_eq!(reported, [("read", 0.0), ("sort", 0.0), ("sort", 0.75)]);
    }

    #[test]
    fn work_that_says_nothing_does_not_delay_a_cancel() {
        let (release, held) = mpsc::channel::<()>();
        let result = Progress::new(&|_, _| false).apart(move |_| {
            // The work ends only after the test has: the caller returns first.
            let _ = held.recv();
            Ok(())
        });
        assert!(matches!(result, Err(Error::Cancelled)));
        drop(release);
    }

    #[test]
    #[should_panic(expected = "the work's own panic")]
    fn a_panic_apart_goes_on_here() {
        let _ = Progress::new(&|_, _| true).apart(|_| -> Result<()> { panic!("the work's own panic") });
    }

    #[test]
    fn who_is_told_nothing_never_stops_the_work() {
        assert!(Progress::SILENT.part(0.2, 0.3).stage("any").at(0.5).is_ok());
    }
}
