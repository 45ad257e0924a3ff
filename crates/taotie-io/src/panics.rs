//! Runs third-party decoders and converts their panics to values.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    /// `true` while a decoder runs on this thread and its panics are caught.
    static CAUGHT_HERE: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder that may panic; returns `None` if it did. Nothing is printed then, since the caller returns an
/// error. The decoder must stay on this thread.
pub(super) fn caught<T>(decode: impl FnOnce() -> T) -> Option<T> {
    keep_quiet_here();
    let before = CAUGHT_HERE.replace(true);
    // A half-finished decoder is dropped with all its state: it owns everything it changes.
    let attempt = panic::catch_unwind(AssertUnwindSafe(decode));
    CAUGHT_HERE.set(before);
    attempt.ok()
}

/// Wraps the process's panic hook, once, with one that ignores panics caught here.
fn keep_quiet_here() {
    static WRAPPED: Once = Once::new();
    WRAPPED.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |about| {
            if !CAUGHT_HERE.get() {
                usual(about);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_nothing_and_leaves_no_mark() {
        assert_eq!(caught(|| 7), Some(7));
        assert_eq!(caught(|| caught(|| -> u8 { panic!("inner") }).map_or(1, |_| 2)), Some(1));
        assert_eq!(caught(|| -> u8 { panic!("outer") }), None);
        assert!(!CAUGHT_HERE.get(), "later panics are reported again");
    }
}
