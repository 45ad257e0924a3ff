//! glTF 2.0.
use super::Loaded;
use crate::error::Result;
pub(super) fn read(path: &std::path::Path) -> Result<Loaded> {
    todo!("{path:?}")
}
