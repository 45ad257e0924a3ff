//! The provenance of an asset, as it says itself.

use super::made::Made;
use super::packing::Packing;
use super::parameters::Parameters;
use crate::error::{Error, Result};
use crate::io::{self, Json, Provenance};
use serde_json::{Map, Value};
use std::path::Path;

/// Returns the XMP metadata of the scan, with what the packing adds, extended by what was done.
///
/// # Errors
/// Fails where a file cannot be read, or is no JSON object.
pub(super) fn packet(made: &Made, packing: &Packing) -> Result<Json> {
    let about = &made.about;
    let name = about.path.file_name().unwrap_or_default().to_string_lossy();
    let parameters = Parameters::new(&made.options, packing).with_names(&made.options);
    let done = Provenance {
        source: &name,
        sha256: &about.sha256()?,
        tool: concat!("taotie ", env!("CARGO_PKG_VERSION")),
        parameters: &format!("taotie bake {parameters}"),
    };
    let mut packet = about.xmp.clone().unwrap_or_else(|| Json(Value::Object(Map::new())));
    if let Some(path) = &packing.provenance {
        merge(&mut packet.0, properties(path)?);
    }
    Ok(done.extend(Some(&packet)))
}

fn properties(path: &Path) -> Result<Map<String, Value>> {
    let bytes = io::read_bytes(path)?;
    let no_json = |error: serde_json::Error| {
        Error::parse(path, format!("line {}, column {}", error.line(), error.column()), error.to_string())
    };
    match serde_json::from_slice(&bytes).map_err(no_json)? {
        Value::Object(properties) => Ok(properties),
        _ => Err(Error::invalid(
            path.display().to_string(),
            "XMP properties are a JSON object, such as {\"dc:title\": \"…\"}",
        )),
    }
}

/// Merges metadata into that of the scan: values given go before those of the scan; contexts are joined.
fn merge(packet: &mut Value, given: Map<String, Value>) {
    let Value::Object(packet) = packet else { return };
    for (name, value) in given {
        match (packet.get_mut(&name), value) {
            (Some(Value::Object(known)), Value::Object(more)) if name == "@context" => known.extend(more),
            (_, value) => {
                packet.insert(name, value);
            }
        }
    }
}
