//! Signals that end the command: its outputs are as they were before, and no temporary files are left.

use crate::console;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::time::{Duration, Instant};
use taotie_io::{FileSet, Stopper};

/// The sets of files being written. Global, because a signal can reach only globals.
static SETS: Mutex<Vec<Stopper>> = Mutex::new(Vec::new());

/// Held by work that stops on its own when the command is ending: the last message waits for it.
static HELD: Mutex<()> = Mutex::new(());

/// Maximum time that the end waits for such work.
const PATIENCE: Duration = Duration::from_secs(10);

/// Set when a signal ends the command.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Creates a set of files that signals stop.
pub fn files() -> FileSet {
    let files = FileSet::new();
    SETS.lock().unwrap_or_else(PoisonError::into_inner).push(files.stopper());
    files
}

/// Starts listening to the signals that end the command: interrupt (Ctrl-C), terminate and hangup. A second one ends
/// the process immediately.
pub fn listen() {
    static LISTENING: OnceLock<()> = OnceLock::new();
    // If this fails, signals still end the process; the next run removes any leftovers.
    LISTENING.get_or_init(|| drop(signals::listen()));
}

/// Returns true if a signal is ending the command; errors of the work are then meaningless.
pub fn is_ending() -> bool {
    ENDING.load(Ordering::SeqCst)
}

/// Delays the end by a signal, for at most ten seconds, until the returned guard is dropped. Its holder polls
/// [`is_ending`].
pub fn hold() -> MutexGuard<'static, ()> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the process as a signal does, without a message: nobody would read it.
pub fn end_quietly() -> ! {
    ENDING.store(true, Ordering::SeqCst);
    let sets = SETS.lock().unwrap_or_else(PoisonError::into_inner);
    sets.iter().for_each(Stopper::stop);
    std::process::exit(143)
}

/// Waits for the end by a signal, whose thread ends the process with the signal's own code.
pub fn wait() -> ! {
    loop {
        std::thread::park();
    }
}

/// Ends the process with this code.
#[cfg_attr(not(any(unix, windows)), allow(dead_code, reason = "WebAssembly has no signals"))]
fn end(code: i32) -> ! {
    ENDING.store(true, Ordering::SeqCst);
    let start = Instant::now();
    while matches!(HELD.try_lock(), Err(TryLockError::WouldBlock)) && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(5));
    }
    // Locked until the end, so that no further set is created.
    let sets = SETS.lock().unwrap_or_else(PoisonError::into_inner);
    sets.iter().for_each(Stopper::stop);
    console::complain("taotie: interrupted; no file is half-written");
    std::process::exit(code)
}

#[cfg(unix)]
mod signals {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;
    use std::io;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    pub fn listen() -> io::Result<()> {
        // Exceeding the file size limit becomes a write error instead of ending the process.
        flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
        let is_ending = Arc::new(AtomicBool::new(false));
        let mut wanted = vec![SIGINT, SIGTERM];
        if !outlives_terminal() {
            wanted.push(SIGHUP);
        }
        for signal in &wanted {
            flag::register_conditional_shutdown(*signal, 128 + signal, Arc::clone(&is_ending))?;
        }
        // Without a listener, the first signal ends the process immediately.
        listener(&wanted, Arc::clone(&is_ending)).inspect_err(|_| is_ending.store(true, Ordering::SeqCst))
    }

    /// Starts a thread that waits for the first signal.
    fn listener(wanted: &[i32], is_ending: Arc<AtomicBool>) -> io::Result<()> {
        let mut signals = Signals::new(wanted)?;
        let wait = move || {
            if let Some(signal) = signals.forever().next() {
                is_ending.store(true, Ordering::SeqCst);
                super::end(128 + signal);
            }
        };
        std::thread::Builder::new().spawn(wait).map(drop)
    }

    /// Returns true if the process should outlive its terminal, as with `nohup`. Only Linux reports it without unsafe
    /// code.
    fn outlives_terminal() -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
        (ignored >> (SIGHUP - 1)) & 1 == 1
    }
}

#[cfg(windows)]
mod signals {
    pub fn listen() -> Result<(), ctrlc::Error> {
        ctrlc::set_handler(|| super::end(130))
    }
}

/// WebAssembly has no signals: its host ends the module.
#[cfg(not(any(unix, windows)))]
mod signals {
    pub fn listen() -> std::io::Result<()> {
        Ok(())
    }
}
