//! Ctrl-C: work stops at the next point where nothing is half written.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set when the user asks to stop. A signal can reach nothing but what is global.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C stop the work instead of the process. A second one ends the process at once.
pub fn listen() {
    static LISTENING: OnceLock<()> = OnceLock::new();
    LISTENING.get_or_init(|| {
        // Where the system has no signals, Ctrl-C goes on ending the process.
        let _ = ctrlc::set_handler(|| {
            if STOPPED.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
    });
}

/// Returns whether to go on.
pub fn go_on() -> bool {
    !STOPPED.load(Ordering::Relaxed)
}
