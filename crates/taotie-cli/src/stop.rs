//! Signals that end the command: what it was to write is as it was before, and nothing temporary is left.

use crate::console;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::time::{Duration, Instant};
use taotie::io::{FileSet, Stopper};

/// The sets of files that are being written. A signal can reach nothing but what is global.
static SETS: Mutex<Vec<Stopper>> = Mutex::new(Vec::new());

/// Held by work that ends by itself when it sees that the command is ending: what is told waits for it.
static HELD: Mutex<()> = Mutex::new(());

/// The longest time that the end waits for such work.
const PATIENCE: Duration = Duration::from_secs(10);

/// Set when a signal ends the command.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Makes a set of files that signals stop.
pub fn files() -> FileSet {
    let files = FileSet::new();
    SETS.lock().unwrap_or_else(PoisonError::into_inner).push(files.stopper());
    files
}

/// Lets signals end the command from now on: Ctrl-C, a request to end and the end of the terminal. A second one ends the
/// process at once.
pub fn listen() {
    static LISTENING: OnceLock<()> = OnceLock::new();
    // Where the system refuses, signals go on ending the process; the next run removes what that leaves.
    LISTENING.get_or_init(|| drop(signals::listen()));
}

/// Says whether a signal is ending the command: errors of the work mean nothing then.
pub fn is_ending() -> bool {
    ENDING.load(Ordering::SeqCst)
}

/// Lets the end by a signal wait, at most ten seconds, until what is returned is dropped. Who holds it asks
/// [`is_ending`] now and then.
pub fn hold() -> MutexGuard<'static, ()> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the process as a signal does, without a word: nobody is there to hear it.
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
fn end(code: i32) -> ! {
    ENDING.store(true, Ordering::SeqCst);
    let start = Instant::now();
    while matches!(HELD.try_lock(), Err(TryLockError::WouldBlock)) && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(5));
    }
    // Kept until the end, so that no further set comes to be.
    let sets = SETS.lock().unwrap_or_else(PoisonError::into_inner);
    sets.iter().for_each(Stopper::stop);
    console::complain("taotie: interrupted; no file is half written");
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
        // A file above the limit is an error of writing, and not the end of the process.
        flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
        let is_ending = Arc::new(AtomicBool::new(false));
        let mut wanted = vec![SIGINT, SIGTERM];
        if !outlives_terminal() {
            wanted.push(SIGHUP);
        }
        for signal in &wanted {
            flag::register_conditional_shutdown(*signal, 128 + signal, Arc::clone(&is_ending))?;
        }
        // Where nobody listens, the first signal ends the process at once.
        listener(&wanted, Arc::clone(&is_ending)).inspect_err(|_| is_ending.store(true, Ordering::SeqCst))
    }

    /// Begins a thread that waits for the first signal.
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

    /// Says whether the process is to outlive its terminal, as `nohup` asks for. Only Linux tells without unsafe code.
    fn outlives_terminal() -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
        (ignored >> (SIGHUP - 1)) & 1 == 1
    }
}

#[cfg(not(unix))]
mod signals {
    pub fn listen() -> Result<(), ctrlc::Error> {
        ctrlc::set_handler(|| super::end(130))
    }
}
