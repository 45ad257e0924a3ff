//! XMP metadata as JSON-LD: the rights, sources and history of a model.
//!
//! Source: KHR_xmp_json_ld; XMP specification part 1 (ISO 16684-1), 8, for the properties.

mod context;
mod packet;
mod properties;
mod provenance;
mod values;

pub use packet::{XmpEvent, xmp_history, xmp_rights, xmp_sources};
pub use provenance::Provenance;

pub(super) use packet::{EXTENSION, packets};
pub(crate) use properties::XmpProperties;
