//! The errors, sorted by who can correct them, and the notes that count what was corrected without an error.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The result of anything that touches what a user wrote.
pub type Result<T> = std::result::Result<T, Error>;

/// An error, sorted by who can mend it. Its text says where, what was wrong and what to do, in one line: control
/// characters, as names in files may have, are shown as `\u{fffd}`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused: the path, the disk or the rights need attention.
    ///
    /// The text already holds what the system said, so this error has no [`source`](std::error::Error::source):
    /// neither who prints the text alone nor who prints the whole chain loses or repeats it.
    #[error("{}: {}", plain(path.display()), plain(cause))]
    Io {
        /// The file or folder concerned.
        path: PathBuf,
        /// The error of the operating system.
        cause: std::io::Error,
    },
    /// A file does not hold what its format demands: the file needs attention.
    #[error("{}: {}: {}", plain(path.display()), plain(at), plain(what))]
    Parse {
        /// The file concerned.
        path: PathBuf,
        /// The place in the file: a line, a byte, or an element such as `mesh 0, primitive 2, POSITION`.
        at: String,
        /// The fault and its remedy.
        what: String,
    },
    /// A value is outside what the call allows: the caller needs attention.
    #[error("{}: {}", plain(what), plain(why))]
    Invalid {
        /// The value or argument.
        what: String,
        /// Why it cannot be used, and what can.
        why: String,
    },
    /// A file is sound but asks for something this program does not do.
    #[error("{} is not supported: {}", plain(what), plain(why))]
    Unsupported {
        /// The feature asked for.
        what: String,
        /// The alternative.
        why: String,
    },
    /// The request is sound but larger than this program takes.
    #[error("{} is too large: {}", plain(what), plain(why))]
    Limit {
        /// The thing that is too large.
        what: String,
        /// The limit, and what to do.
        why: String,
    },
    /// The caller wanted the work to stop: see [`crate::progress::Progress`]. Nothing is half done.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    /// An operating-system error at `path`.
    pub fn io(path: impl AsRef<Path>, cause: std::io::Error) -> Self {
        Self::Io { path: path.as_ref().to_path_buf(), cause }
    }

    /// A format error in `path`, at the place `at`.
    pub fn parse(path: impl AsRef<Path>, at: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Parse { path: path.as_ref().to_path_buf(), at: at.into(), what: what.into() }
    }

    /// A value that cannot be used.
    pub fn invalid(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Invalid { what: what.into(), why: why.into() }
    }

    /// A feature that is not there.
    pub fn unsupported(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Unsupported { what: what.into(), why: why.into() }
    }

    /// Something that a cargo feature does which this build lacks.
    pub(crate) fn needs_feature(what: impl Into<String>, feature: &str) -> Self {
        Self::unsupported(
            what,
            format!("this build lacks it; turn on the feature `{feature}` of the crate taotie"),
        )
    }

    /// A request beyond a stated limit.
    pub fn limit(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Limit { what: what.into(), why: why.into() }
    }

    /// Returns the same error with the place before it, such as the file that holds the wrong value. Errors that name
    /// their file already stay as they are.
    ///
    /// ```
    /// let error = taotie::Error::invalid("roughness", "it must lie between 0 and 1");
    /// assert_eq!(error.within("m.toml").to_string(), "m.toml: roughness: it must lie between 0 and 1");
    /// ```
    #[must_use]
    pub fn within(self, place: impl std::fmt::Display) -> Self {
        let placed = |what: String| format!("{place}: {what}");
        match self {
            Self::Invalid { what, why } => Self::Invalid { what: placed(what), why },
            Self::Unsupported { what, why } => Self::Unsupported { what: placed(what), why },
            Self::Limit { what, why } => Self::Limit { what: placed(what), why },
            named @ (Self::Io { .. } | Self::Parse { .. } | Self::Cancelled) => named,
        }
    }
}

/// Returns a text in one line: control characters are replaced.
fn plain(text: impl Display) -> String {
    one_line(text.to_string()).into_owned()
}

fn one_line<'a>(text: impl Into<Cow<'a, str>>) -> Cow<'a, str> {
    let text = text.into();
    if text.contains(char::is_control) { text.replace(char::is_control, "\u{fffd}").into() } else { text }
}

/// Things that were wrong but could still be drawn, each counted once a kind, in order of first sight. Each is one line,
/// as the text of an [`Error`] is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Warnings {
    entries: Vec<(String, usize)>,
    /// The place of each kind among the entries, so that a file may be wrong in any number of ways.
    places: HashMap<String, usize>,
}

impl Warnings {
    /// Counts `count` more of `what`; a count of zero leaves no entry.
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

    /// Takes over all of `other`.
    pub fn absorb(&mut self, other: Warnings) {
        for (what, count) in other.entries {
            self.note(what, count);
        }
    }

    /// The kinds and how often each was seen.
    pub fn iter(&self) -> impl Iterator<Item = (&str, usize)> {
        self.entries.iter().map(|(what, count)| (what.as_str(), *count))
    }

    /// Says whether nothing was noted.
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
