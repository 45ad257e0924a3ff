//! The GLB container: a header, the JSON and one chunk of binary data. Source: glTF 2.0, 4.4.

use crate::error::{Error, Result};
use std::io::{self, Write};

/// Writes the container to `out`. `json` is padded with spaces; the length of `binary` is a multiple of four.
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

/// Returns the container for JSON and binary data, whose length is a multiple of four.
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
    /// Measures the container of `json` and `binary` bytes.
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
