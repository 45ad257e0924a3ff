//! Values that users choose by name: one list of names for the command line, files, tests and errors.

use crate::error::{Error, Result};

/// A closed set of values, each with the name that users write.
pub trait Named: Copy + PartialEq + 'static {
    /// The name of the set in messages, such as `shading model`.
    const WHAT: &'static str;
    /// Every value with its name.
    const NAMES: &'static [(&'static str, Self)];

    /// Returns the name of this value.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, value)| *value == self).map_or("", |(name, _)| name)
    }

    /// Returns the value with this name.
    ///
    /// # Errors
    /// [`Error::Invalid`] listing the valid names.
    fn from_name(name: &str) -> Result<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, value)| *value).ok_or_else(|| {
            let known: Vec<&str> = Self::NAMES.iter().map(|(known, _)| *known).collect();
            Error::invalid(
                format!("unknown {} `{name}`", Self::WHAT),
                format!("expected one of: {}", known.join(", ")),
            )
        })
    }
}
