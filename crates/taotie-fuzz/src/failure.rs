//! The failure of a run.

use serde::{Deserialize, Serialize};

/// The failure of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// How it failed.
    pub kind: FailureKind,
    /// The panic's message and location, the broken promise, or the last output of the process.
    pub message: String,
}

/// The ways a run can fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FailureKind {
    /// A panic reached the caller.
    Panic,
    /// An allocation would have exceeded the limit.
    Memory,
    /// The run did not end in time.
    Time,
    /// The process died.
    Abort,
    /// The library broke a promise.
    Promise,
}

impl Failure {
    /// Returns `true` if both are the same fault, judging by kind and message; digits in the message are ignored.
    pub fn is_like(&self, other: &Self) -> bool {
        let words = |failure: &Self| failure.message.replace(|c: char| c.is_ascii_digit(), "");
        self.kind == other.kind && (self.kind == FailureKind::Time || words(self) == words(other))
    }

    /// Returns the kind as a word.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            FailureKind::Panic => "panic",
            FailureKind::Memory => "memory",
            FailureKind::Time => "time",
            FailureKind::Abort => "abort",
            FailureKind::Promise => "promise",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_do_not_make_a_fault_another() {
        let failure = |kind, message: &str| Failure { kind, message: message.into() };
        let panic = failure(FailureKind::Panic, "index 7 of 3 at a.rs:1");
        assert!(panic.is_like(&failure(FailureKind::Panic, "index 9 of 0 at a.rs:12")));
        assert!(!panic.is_like(&failure(FailureKind::Panic, "index 7 of 3 at b.rs:1")));
        assert!(!panic.is_like(&failure(FailureKind::Abort, "index 7 of 3 at a.rs:1")));
    }
}
