//! (to come)
use super::Loaded;
use crate::error::{Error, Result};
use std::path::Path;
pub(super) fn read(path: &Path) -> Result<Loaded> {
    Err(Error::unsupported(path.display().to_string(), "to come"))
}
