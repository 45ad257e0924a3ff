//! The lines of a collection's file, for error messages.

use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::Path;
use taotie_engine::{Error, Result};

/// The text of a file, for converting positions to lines.
#[derive(Debug, Clone, Copy)]
pub struct Lines<'a> {
    /// The whole text.
    pub text: &'a str,
    /// Its file.
    pub path: &'a Path,
}

impl Lines<'_> {
    /// Reads the file's text.
    ///
    /// # Errors
    /// [`Error::Parse`] with the line.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T> {
        toml::from_str(self.text).map_err(|error| self.of(&error))
    }

    fn of(&self, error: &toml::de::Error) -> Error {
        self.parse(error.span().unwrap_or(0..0), error.message())
    }

    /// Returns an error at a position in the text.
    pub fn parse(&self, span: Range<usize>, what: &str) -> Error {
        let before = self.text.get(..span.start).unwrap_or_default();
        Error::parse(self.path, format!("line {}", before.matches('\n').count() + 1), what.replace('\n', " "))
    }

    /// Returns an error about values at a position in the text.
    pub fn within(&self, span: Range<usize>, error: Error) -> Error {
        self.parse(span, &error.to_string())
    }
}
