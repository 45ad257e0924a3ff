//! The provenance that an asset records about itself.

use super::made::Made;
use super::packing::Packing;
use super::parameters::Parameters;
use crate::error::Result;
use crate::io::{Json, Provenance, XmpProperties};

/// Returns the XMP metadata of the scan, merged with that of the packing and extended by the record of the bake.
///
/// # Errors
/// Fails if a file cannot be read, or has no valid XMP properties.
pub(super) fn packet(made: &Made, packing: &Packing) -> Result<Json> {
    let about = &made.about;
    let name = about.path.file_name().unwrap_or_default().to_string_lossy();
    let parameters = Parameters::new(&made.options, &made.about.options, packing).with_low(&made.options);
    let done = Provenance {
        source: &name,
        sha256: &about.sha256()?,
        tool: concat!("taotie ", env!("CARGO_PKG_VERSION")),
        parameters: &parameters.record(),
    };
    let given = packing.provenance.as_deref().map(XmpProperties::read).transpose()?;
    let merged = given.map(|given| given.merged_into(about.xmp.as_ref()));
    Ok(done.extend(merged.as_ref().or(about.xmp.as_ref())))
}
