//! The GLB container: a header, the JSON and at most one chunk of binary data.

use crate::error::{Error, Result};
use std::path::Path;

/// Returns the JSON text and, for GLB, the binary chunk (empty if there is none).
pub(super) fn split(path: &Path, mut bytes: Vec<u8>) -> Result<(Vec<u8>, Option<Vec<u8>>)> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let version = little_endian(&bytes, 4).ok_or_else(|| truncated(path, "header"))?;
    if version != 2 {
        return Err(Error::unsupported(
            format!("{}: GLB container version {version}", path.display()),
            "save the model as glTF 2.0",
        ));
    }
    let mut at = 12;
    let mut json = None;
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (little_endian(&bytes, at), bytes.get(at + 4..at + 8)) else {
            return Err(truncated(path, &format!("chunk header at byte {at}")));
        };
        let (start, end) = (at + 8, at + 8 + length as usize);
        if end > bytes.len() {
            return Err(truncated(path, &format!("chunk at byte {at}")));
        }
        match (kind, &json) {
            (b"JSON", None) => json = Some(bytes[start..end].to_vec()),
            (b"BIN\0", Some(_)) => {
                bytes.truncate(end);
                bytes.drain(..start);
                return Ok((json.unwrap_or_default(), Some(bytes)));
            }
            (_, None) => return Err(Error::parse(path, "GLB container", "the first chunk is not JSON")),
            _ => {}
        }
        at = end;
    }
    let json = json.ok_or_else(|| truncated(path, "JSON chunk"))?;
    Ok((json, Some(Vec::new())))
}

fn truncated(path: &Path, what: &str) -> Error {
    Error::parse(path, "GLB container", format!("the file ends within the {what}; download it again"))
}

fn little_endian(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}
