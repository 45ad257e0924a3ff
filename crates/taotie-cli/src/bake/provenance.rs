//! Where an asset comes from, as it says itself.

use super::args::BakeArgs;
use super::work::Source;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use taotie::io::Provenance;

/// The packet of the scan, with what `--provenance` says, extended by what was done.
///
/// # Errors
/// Where the file of `--provenance` cannot be read or is no JSON object.
pub fn packet(args: &BakeArgs, source: &Source, sha256: &str) -> Result<Value> {
    let name = args.high.file_name().unwrap_or_default().to_string_lossy();
    let done = Provenance {
        source: &name,
        sha256,
        tool: concat!("taotie ", env!("CARGO_PKG_VERSION")),
        parameters: &command_line(args),
    };
    let mut packet = source.loaded.xmp.first().cloned().unwrap_or_else(|| Value::Object(Default::default()));
    if let Some(path) = &args.provenance {
        merge(&mut packet, properties(path)?);
    }
    Ok(done.extend(Some(&packet)))
}

fn properties(path: &Path) -> Result<serde_json::Map<String, Value>> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    match serde_json::from_str(&text).with_context(|| path.display().to_string())? {
        Value::Object(properties) => Ok(properties),
        _ => bail!("{}: XMP properties are a JSON object, such as {{\"dc:title\": \"…\"}}", path.display()),
    }
}

/// What is given goes before what the scan says; contexts are joined.
fn merge(packet: &mut Value, given: serde_json::Map<String, Value>) {
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

/// All that the result depends on, without folders: those are nobody's business.
fn command_line(args: &BakeArgs) -> String {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut parameters = super::report::parameters(args);
    parameters["low"] = args.low.as_deref().map(name).into();
    parameters["cage"] = args.cage.as_deref().map(name).into();
    format!("taotie bake {parameters}")
}

/// The SHA-256 of a file, hexadecimal.
///
/// # Errors
/// Where it cannot be read.
pub fn sha256(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let (mut hash, mut block) = (Sha256::new(), vec![0; 1 << 20]);
    loop {
        match file.read(&mut block)? {
            0 => break,
            read => hash.update(&block[..read]),
        }
    }
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}
