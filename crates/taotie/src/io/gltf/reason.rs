//! Why something in a file cannot be read.

/// Why something cannot be read; the caller knows where in the file that is.
pub(super) type Reason<T> = std::result::Result<T, String>;

/// Returns the usual words for an index out of range.
pub(super) fn no_such(what: &str, index: usize) -> String {
    format!("it names {what} {index}, which does not exist")
}
