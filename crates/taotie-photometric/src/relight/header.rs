//! The text at the start of a binary file: words between white space, then one line end.

use std::path::Path;
use std::str::FromStr;
use taotie_engine::error::{Error, Result};

/// The rest of a file whose start was read.
pub struct Header<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Header<'a> {
    /// Starts at the first byte. `path` is named in errors.
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, bytes, at: 0 }
    }

    /// Skips lines that start with `#`.
    pub fn skip_comments(&mut self) {
        while self.bytes.get(self.at) == Some(&b'#') {
            let line = self.bytes[self.at..].iter().position(|byte| *byte == b'\n');
            self.at = line.map_or(self.bytes.len(), |length| self.at + length + 1);
        }
    }

    /// Returns the next word.
    ///
    /// # Errors
    /// [`Error::Parse`] if there is none of at most 64 ASCII characters.
    pub fn word(&mut self, what: &str) -> Result<&'a str> {
        const LONGEST: usize = 64;
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let rest = &rest[start..];
        let length = rest.iter().take(LONGEST + 1).position(u8::is_ascii_whitespace);
        let word = length.and_then(|length| std::str::from_utf8(&rest[..length]).ok());
        let word = word.filter(|word| !word.is_empty() && word.is_ascii());
        let word = word.ok_or_else(|| self.error(format!("expected {what}; the header is damaged")))?;
        self.at += start + word.len();
        Ok(word)
    }

    /// Returns the next word as a number.
    ///
    /// # Errors
    /// [`Error::Parse`] if it is not one.
    pub fn number<T: FromStr>(&mut self, what: &str) -> Result<T> {
        let word = self.word(what)?;
        word.parse().map_err(|_| self.error(format!("expected {what}, found '{word}'")))
    }

    /// Returns the next words as numbers.
    ///
    /// # Errors
    /// As [`Header::number`].
    pub fn numbers<T: FromStr>(&mut self, count: usize, what: &str) -> Result<Vec<T>> {
        (0..count).map(|_| self.number(what)).collect()
    }

    /// Ends the text, with its line end, which spaces may precede.
    pub fn end(&mut self) {
        for expected in [b' ', b'\r', b'\n'] {
            self.at += usize::from(self.bytes.get(self.at) == Some(&expected));
        }
    }

    /// Takes bytes after the text.
    ///
    /// # Errors
    /// [`Error::Parse`] if the file is too short.
    pub fn take(&mut self, length: u64) -> Result<&'a [u8]> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let taken = usize::try_from(length).ok().and_then(|length| rest.get(..length));
        let taken = taken.ok_or_else(|| {
            self.error(format!("unexpected end of file: expected {length} more bytes, found {}", rest.len()))
        })?;
        self.at += taken.len();
        Ok(taken)
    }

    /// Returns an error at the current place.
    pub fn error(&self, what: String) -> Error {
        Error::parse(self.path, format!("byte {}", self.at), what)
    }
}
