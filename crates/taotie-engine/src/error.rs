//! Errors, grouped by who can fix them, and counted warnings about what was corrected without an error.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The result of anything that processes user input.
pub type Result<T> = std::result::Result<T, Error>;

/// An error, grouped by who can fix it. Its message states the place, the problem and the remedy in one line: control
/// characters, which names in files may contain, are shown as `\u{fffd}`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused: check the path, the disk or the permissions.
    ///
    /// The message already includes the system's text, so this error has no [`source`](std::error::Error::source):
    /// printing the message or printing the whole chain gives the same text, once.
    #[error("{}: {}", plain(path.display()), plain(cause))]
    Io {
        /// The file or folder concerned.
        path: PathBuf,
        /// The error of the operating system.
        cause: std::io::Error,
    },
    /// A file violates its format: the file needs fixing.
    #[error("{}: {}: {}", plain(path.display()), plain(at), plain(what))]
    Parse {
        /// The file concerned.
        path: PathBuf,
        /// The place in the file: a line, a byte offset, or an element such as `mesh 0, primitive 2, POSITION`.
        at: String,
        /// The problem and its remedy.
        what: String,
    },
    /// A value is outside its valid range: the caller needs to change it.
    #[error("{}: {}", plain(what), plain(why))]
    Invalid {
        /// The value or argument.
        what: String,
        /// Why it is invalid, and what is valid.
        why: String,
    },
    /// A file is valid but requires something this program does not do.
    #[error("{} is not supported: {}", plain(what), plain(why))]
    Unsupported {
        /// The requested feature.
        what: String,
        /// The alternative.
        why: String,
    },
    /// The request is valid but exceeds what this program accepts.
    #[error("{} is too large: {}", plain(what), plain(why))]
    Limit {
        /// The thing that is too large.
        what: String,
        /// The limit, and what to do.
        why: String,
    },
    /// A result does not meet what was required of it: improve the result, or require less.
    #[error("not met: {}", plain(what))]
    Unmet {
        /// Each unmet requirement with its value and limit.
        what: String,
    },
    /// The caller cancelled the work: see [`crate::progress::Progress`]. Nothing is left half done.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    /// Creates an operating-system error at `path`.
    pub fn io(path: impl AsRef<Path>, cause: std::io::Error) -> Self {
        Self::Io { path: path.as_ref().to_path_buf(), cause }
    }

    /// Creates a format error in `path`, at the place `at`.
    pub fn parse(path: impl AsRef<Path>, at: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Parse { path: path.as_ref().to_path_buf(), at: at.into(), what: what.into() }
    }

    /// Creates an error for an invalid value.
    pub fn invalid(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Invalid { what: what.into(), why: why.into() }
    }

    /// Creates an error for an unsupported feature.
    pub fn unsupported(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Unsupported { what: what.into(), why: why.into() }
    }

    /// Creates an error for something that needs a cargo feature missing from this build.
    pub fn needs_feature(what: impl Into<String>, feature: &str) -> Self {
        Self::unsupported(
            what,
            format!("this build lacks it; enable the feature `{feature}` of the crate taotie"),
        )
    }

    /// Creates an error for a request beyond a stated limit.
    pub fn limit(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Limit { what: what.into(), why: why.into() }
    }

    /// Returns the same error prefixed with its place, such as the file that holds the invalid value. Errors that
    /// already name their file are unchanged.
    ///
    /// ```
    /// let error = taotie_engine::Error::invalid("roughness", "it must lie between 0 and 1");
    /// assert_eq!(error.within("m.toml").to_string(), "m.toml: roughness: it must lie between 0 and 1");
    /// ```
    #[must_use]
    pub fn within(self, place: impl std::fmt::Display) -> Self {
        let placed = |what: String| format!("{place}: {what}");
        match self {
            Self::Invalid { what, why } => Self::Invalid { what: placed(what), why },
            Self::Unsupported { what, why } => Self::Unsupported { what: placed(what), why },
            Self::Limit { what, why } => Self::Limit { what: placed(what), why },
            named @ (Self::Io { .. } | Self::Parse { .. } | Self::Unmet { .. } | Self::Cancelled) => named,
        }
    }
}

/// Returns a text on one line, with control characters replaced.
fn plain(text: impl Display) -> String {
    one_line(text.to_string()).into_owned()
}

fn one_line<'a>(text: impl Into<Cow<'a, str>>) -> Cow<'a, str> {
    let text = text.into();
    if text.contains(char::is_control) { text.replace(char::is_control, "\u{fffd}").into() } else { text }
}

/// A kind of problem that could be worked around, and its count.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Warning {
    /// The number of occurrences.
    pub count: usize,
    /// The warning.
    pub what: String,
}

impl std::fmt::Display for Warning {
    /// Writes the warning, with its count if there are several.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.count {
            1 => f.write_str(&self.what),
            count => write!(f, "{} ({count} times)", self.what),
        }
    }
}

/// Problems that could be worked around, each kind with its count, in order of first occurrence. Each is one line,
/// like the message of an [`Error`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Warnings {
    entries: Vec<(String, usize)>,
    /// The index of each kind among the entries, so that a file may have any number of kinds of problems.
    places: HashMap<String, usize>,
}

impl Warnings {
    /// Adds `count` occurrences of `what`; a count of zero adds no entry.
    pub fn note(&mut self, what: impl Into<String>, count: usize) {
        if count == 0 {
            return;
        }
        let what = one_line(what.into()).into_owned();
        match self.places.get(&what) {
            Some(place) => self.entries[*place].1 += count,
            None => {
                self.places.insert(what.clone(), self.entries.len());
                self.entries.push((what, count));
            }
        }
    }

    /// Adds all of `other`.
    pub fn absorb(&mut self, other: Warnings) {
        for (what, count) in other.entries {
            self.note(what, count);
        }
    }

    /// Returns the kinds and how often each occurred.
    pub fn iter(&self) -> impl Iterator<Item = (&str, usize)> {
        self.entries.iter().map(|(what, count)| (what.as_str(), *count))
    }

    /// Lists the kinds of problems in order of first occurrence.
    ///
    /// ```
    /// let mut warnings = taotie_engine::Warnings::default();
    /// warnings.note("open edges", 3);
    /// let listed = warnings.list();
    /// assert_eq!((listed[0].count, listed[0].what.as_str()), (3, "open edges"));
    /// ```
    pub fn list(&self) -> Vec<Warning> {
        self.iter().map(|(what, count)| Warning { count, what: what.to_owned() }).collect()
    }

    /// Returns true if nothing was noted.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_one_line_whatever_a_file_names() {
        let (name, plain) = ("\u{1b}[31m\nx", "\u{fffd}[31m\u{fffd}x");
        let cause = std::io::Error::other(name);
        let errors = [
            Error::io(name, cause),
            Error::parse(name, name, name),
            Error::invalid(name, name),
            Error::unsupported(name, name),
            Error::limit(name, name),
        ];
        for error in errors {
            let text = error.to_string();
            assert!(text.contains(plain) && !text.contains(char::is_control), "{text:?}");
        }
        let mut warnings = Warnings::default();
        warnings.note(name, 1);
        assert!(warnings.iter().all(|(what, count)| what == plain && count == 1));
    }
}
