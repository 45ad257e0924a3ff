//! The text of whole shaders, apart from the recorded functions.

pub(crate) mod declarations;
pub(crate) mod entry;
pub(crate) mod environment;
pub(crate) mod fetch;
pub(crate) mod geometry;
pub(crate) mod pixel;
mod translate;
mod wrap;

pub(crate) use translate::translated;
pub(crate) use wrap::wrapped;
