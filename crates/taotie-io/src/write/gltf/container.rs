//! The two kinds of glTF files: a GLB, or JSON with external files, whose names are relative URIs.
//!
//! A GLB has a header, the JSON and one chunk of binary data. Source: glTF 2.0, 4.4.

use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use std::io::{self, Write};
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// The kinds of glTF files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Container {
    /// One binary file.
    Glb,
    /// JSON with external files.
    Gltf,
}

impl Container {
    /// Returns the kind of a file by its extension.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for another extension.
    pub fn of(path: &Path) -> Result<Self> {
        let extension =
            path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "glb" => Ok(Self::Glb),
            "gltf" => Ok(Self::Gltf),
            _ => Err(Error::unsupported(
                format!("{}: the file extension '{extension}'", path.display()),
                "use .glb or .gltf",
            )),
        }
    }
}

/// Writes a GLB to `out`. `json` is padded with spaces; the length of `binary` is a multiple of four.
pub(super) fn write(out: &mut dyn Write, head: &Head, binary: &[u8]) -> io::Result<()> {
    out.write_all(b"glTF\x02\0\0\0")?;
    out.write_all(&head.length.to_le_bytes())?;
    out.write_all(&(head.json.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&head.json)?;
    if !binary.is_empty() {
        out.write_all(&(binary.len() as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(binary)?;
    }
    Ok(())
}

/// Returns the GLB for JSON and binary data, whose length is a multiple of four.
///
/// # Errors
/// [`Error::Limit`] if it would be 4 GiB or more.
pub(super) fn encoded(json: Vec<u8>, binary: &[u8]) -> Result<Vec<u8>> {
    let head = Head::new(json, binary.len())?;
    let mut bytes = Vec::with_capacity(head.length as usize);
    write(&mut bytes, &head, binary).map_err(|e| Error::invalid("glTF document", e.to_string()))?;
    Ok(bytes)
}

/// The JSON chunk's data and the length of the whole file, which is known to fit.
#[derive(Debug)]
pub(super) struct Head {
    json: Vec<u8>,
    length: u32,
}

impl Head {
    /// Measures the GLB of `json` and `binary` bytes.
    ///
    /// # Errors
    /// [`Error::Limit`] if its length does not fit 32 bits.
    pub fn new(mut json: Vec<u8>, binary: usize) -> Result<Self> {
        json.resize(json.len().next_multiple_of(4), b' ');
        let chunk = if binary == 0 { 0 } else { 8 + binary as u64 };
        let length = 20 + json.len() as u64 + chunk;
        let too_large = |_| {
            let why = "the limit is 4 GiB; write .gltf, or use smaller textures or fewer triangles";
            Error::limit(format!("a GLB of {length} bytes"), why)
        };
        Ok(Self { length: u32::try_from(length).map_err(too_large)?, json })
    }
}

/// Characters that must be escaped in a relative URI.
const RESERVED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// Returns the relative URI of a file.
pub(super) fn uri(name: &str) -> String {
    utf8_percent_encode(name, RESERVED).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_gibibytes_are_refused_with_advice() {
        let error = Head::new(vec![b'{', b'}'], u32::MAX as usize - 31).unwrap_err().to_string();
        assert!(error.contains("4294967296 bytes") && error.contains("write .gltf"), "{error}");
        assert_eq!(Head::new(vec![b'{', b'}'], u32::MAX as usize - 35).unwrap().length, u32::MAX - 3);
    }
}
