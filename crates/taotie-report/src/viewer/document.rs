//! Combines the viewer page's style, script and data into one document, or into a document with files next to it.

use crate::Page;
use crate::document::{Document, WITHOUT_SCRIPT, html_with, sha256};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use rayon::prelude::*;
use std::io::Write;

const STYLE: &str = include_str!("page.css");

/// The script that defines the element `<taotie-viewer>`, built from `viewer/`.
pub const SCRIPT: &str = include_str!("bundle/viewer.js");

/// The element that shows the content of the page, and the one that shows the files next to it.
const ALONE: &str = "<taotie-viewer></taotie-viewer>";
const BESIDE: &str = "<taotie-viewer src=\"./\" linked></taotie-viewer>";

/// The self-contained page.
pub(super) fn single_file(title: &str, blobs: &[Blob]) -> String {
    page(title, ["'none'", ALONE], &elements(blobs))
}

/// The page for a folder, which fetches the files next to it, with elements that contain data.
pub(super) fn linked(title: &str, data: &str) -> String {
    page(title, ["'self'", BESIDE], data)
}

/// A report with the element as its first view.
pub(super) fn within(page: &Page, blobs: &[Blob]) -> String {
    html_with(page, SCRIPT, &elements(blobs))
}

fn elements(blobs: &[Blob]) -> String {
    blobs.par_iter().map(Blob::element).collect()
}

/// The page for an element, which may connect to `sources`.
fn page(title: &str, [sources, element]: [&str; 2], data: &str) -> String {
    let main = format!("<main>{element}{WITHOUT_SCRIPT}</main>");
    Document { title, policy: policy(sources), style: STYLE, main: &main, data, scripts: &[SCRIPT] }.html()
}

/// Allows only this style sheet and this script. The mesh decoder is compiled from bytes in the script.
fn policy(sources: &str) -> String {
    let [style, script] = [STYLE, SCRIPT].map(sha256);
    let pictures = if sources == "'self'" { "'self' " } else { "" };
    format!(
        "default-src 'none'; img-src {pictures}data: blob:; connect-src {sources}; style-src 'sha256-{style}'; \
         script-src 'sha256-{script}' 'wasm-unsafe-eval'; base-uri 'none'; form-action 'none'"
    )
}

/// Named bytes of a page: embedded as base64, or as a file next to it.
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

    /// Returns the element that contains it, compressed unless it is a picture.
    fn element(&self) -> String {
        let (kind, text) = match self.is_picture() {
            true => ("image/jpeg", STANDARD.encode(&self.bytes)),
            false => ("application/gzip", STANDARD.encode(gzip(&self.bytes, self.compression()))),
        };
        format!("<script type=\"{kind}\" id=\"taotie-{}\">{text}</script>\n", self.name)
    }

    /// Browsers that cannot unpack anything show the picture.
    fn is_picture(&self) -> bool {
        self.name == "still"
    }

    fn is_model(&self) -> bool {
        matches!(self.name, "asset" | "scan")
    }

    /// Returns the compression level. Models are already packed, so a thorough search would gain next to nothing.
    fn compression(&self) -> Compression {
        if self.is_model() { Compression::fast() } else { Compression::default() }
    }

    /// Returns the file that contains it: models and pictures unchanged, everything else compressed.
    pub fn file(&self) -> PageFile {
        let (name, bytes) = (self.name, &self.bytes);
        match (self.is_model(), self.is_picture()) {
            (true, _) => PageFile { name: format!("{name}.glb"), bytes: bytes.clone() },
            (_, true) => PageFile { name: format!("{name}.jpg"), bytes: bytes.clone() },
            _ => PageFile { name: format!("{name}.bin"), bytes: gzip(bytes, self.compression()) },
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
    fn no_text_breaks_out_of_its_place() {
        let nasty = "</title><script>alert(1)</script>{policy}";
        let document = single_file(nasty, &[Blob::new("data", b"</script>".to_vec())]);
        // The script contains drawings with their own titles.
        let (head, _) = document.split_once("<main>").unwrap();
        assert_eq!(head.matches("<title>").count(), 1);
        assert!(document.contains("&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;{policy}</title>"));
        assert!(!document.contains("alert(1)</script>"));
    }

    #[test]
    fn script_and_style_stay_in_their_elements() {
        for end in ["</script", "<!--", "\r"] {
            assert!(!SCRIPT.contains(end), "{end}");
        }
        assert!(!STYLE.contains('<') && !STYLE.contains('\r') && !STYLE.contains("url("));
    }

    #[test]
    fn the_script_fits_a_page() {
        let element = Blob::new("script", SCRIPT.as_bytes().to_vec()).file();
        assert!(element.bytes.len() <= 250_000, "{} bytes by gzip", element.bytes.len());
    }

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
    fn model_and_picture_are_files_as_they_are() {
        for (name, file_name) in [("asset", "asset.glb"), ("still", "still.jpg")] {
            let file = Blob::new(name, vec![1, 2]).file();
            assert_eq!((file.name.as_str(), file.bytes), (file_name, vec![1, 2]));
        }
        let element = Blob::new("still", vec![1, 2]).element();
        assert_eq!(element, "<script type=\"image/jpeg\" id=\"taotie-still\">AQI=</script>\n");
    }
}
