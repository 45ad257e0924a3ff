//! The reasons why something in a file cannot be read.

/// A value, or the reason why it cannot be read; the caller knows the place in the file.
pub(super) type Reason<T> = std::result::Result<T, String>;

/// Returns the standard message for an index out of range.
pub(super) fn no_such(what: &str, index: usize) -> String {
    format!("{what} {index} does not exist")
}
