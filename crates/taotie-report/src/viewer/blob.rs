//! Named bytes of a page: embedded as base64, or as a file next to it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;

/// Named bytes of a page.
pub(super) struct Blob {
    name: &'static str,
    bytes: Vec<u8>,
}

/// A file next to the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageFile {
    /// Its name.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl Blob {
    pub fn new(name: &'static str, bytes: Vec<u8>) -> Self {
        Self { name, bytes }
    }

    /// Returns the element that contains it, compressed.
    pub fn element(&self) -> String {
        let text = STANDARD.encode(gzip(&self.bytes, self.compression()));
        format!("<script type=\"application/gzip\" id=\"taotie-{}\">{text}</script>\n", self.name)
    }

    fn is_model(&self) -> bool {
        matches!(self.name, "asset" | "scan")
    }

    /// Returns the compression level. Models are already packed, so a thorough search would gain next to nothing.
    fn compression(&self) -> Compression {
        if self.is_model() { Compression::fast() } else { Compression::default() }
    }

    /// Returns the file that contains it: models unchanged, everything else compressed.
    pub fn file(&self) -> PageFile {
        let (name, bytes) = (self.name, &self.bytes);
        match self.is_model() {
            true => PageFile { name: format!("{name}.glb"), bytes: bytes.clone() },
            false => PageFile { name: format!("{name}.bin"), bytes: gzip(bytes, self.compression()) },
        }
    }
}

/// Compresses bytes as gzip, without a timestamp.
fn gzip(bytes: &[u8], compression: Compression) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), compression);
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("writing to memory cannot fail")
}

/// Converts numbers to little-endian bytes.
pub(super) fn bytes_of_words(words: impl Iterator<Item = u16>) -> Vec<u8> {
    words.flat_map(u16::to_le_bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::GzDecoder;
    use std::io::Read;

    #[test]
    fn bytes_are_restored() {
        let blob = Blob::new("tables", vec![7; 1000]);
        let file = blob.file();
        assert_eq!(file.name, "tables.bin");
        let mut bytes = Vec::new();
        GzDecoder::new(&file.bytes[..]).read_to_end(&mut bytes).unwrap();
        assert_eq!(bytes, vec![7; 1000]);
        let element = blob.element();
        assert!(element.contains(&STANDARD.encode(&file.bytes)), "{element}");
    }

    #[test]
    fn the_model_is_a_separate_file() {
        let file = Blob::new("asset", vec![1, 2]).file();
        assert_eq!((file.name.as_str(), file.bytes), ("asset.glb", vec![1, 2]));
    }
}
