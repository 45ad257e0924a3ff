//! The bytes that a document refers to: buffers and their views, decompressed where necessary; and what URIs name, in
//! data or in files next to the model. The network is never accessed.

use super::meshopt::{self, Packed};
use crate::reading::{Reading, Reason, no_such};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json::Root;
use gltf::json::accessor::ComponentType;
use gltf::json::buffer::View;
use percent_encoding::percent_decode_str;
use std::collections::BTreeMap;
use std::path::PathBuf;
use taotie_engine::error::{Error, Result, Warnings};

/// Maximum number of bytes that all compressed views unpack to, per byte of the buffers, plus a constant for small
/// files. Several views may share the same packed bytes, so a limit per view would not bound their sum.
const MAX_UNPACKED_PER_BYTE: usize = 64;
const MAX_UNPACKED_OF_SMALL: usize = 1 << 28;

/// The content of the file's buffers.
pub(super) struct Buffers {
    /// The bytes of each buffer; `None` for one that has no source.
    buffers: Vec<Option<Vec<u8>>>,
    /// The bytes of compressed views, or the reason why they are unavailable.
    unpacked: BTreeMap<usize, Reason<Vec<u8>>>,
}

impl Buffers {
    /// Reads every buffer of `root`; `blob` is the binary chunk of the container.
    ///
    /// # Errors
    /// Fails if a buffer cannot be read. [`Self::view`] reports a damaged compressed view.
    pub fn load(
        reading: &Reading,
        root: &Root,
        mut blob: Option<Vec<u8>>,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let bytes = match &buffer.uri {
                _ if meshopt::is_fallback(buffer) => None,
                Some(name) => Some(load_buffer(reading, name, i)?),
                None if i == 0 => blob.take(),
                None => None,
            };
            if let Some(bytes) = &bytes
                && (bytes.len() as u64) < buffer.byte_length.0
            {
                warnings.note(format!("buffer {i} has {} bytes, fewer than declared", bytes.len()), 1);
            }
            buffers.push(bytes);
        }
        let mut buffers = Self { buffers, unpacked: BTreeMap::new() };
        if root.buffer_views.iter().any(|view| meshopt::of_view(view).is_some()) {
            buffers.unpack(root, usize::try_from(reading.left()).unwrap_or(usize::MAX));
        }
        let unpacked = buffers.unpacked.values().flatten().map(Vec::len).sum::<usize>();
        if !reading.take(unpacked as u64) {
            reading.check()?;
        }
        Ok(buffers)
    }

    /// Returns the bytes of view `index`, which is `view`.
    pub fn view(&self, index: usize, view: &View) -> Reason<&[u8]> {
        let start = view.byte_offset.map_or(0, |o| o.0);
        let bytes = match self.unpacked.get(&index) {
            Some(unpacked) => unpacked.as_deref().map_err(Clone::clone),
            None => self.range(view.buffer.value(), start, view.byte_length.0),
        };
        bytes.map_err(|why| format!("buffer view {index}: {why}"))
    }

    /// Returns the number of bytes, counting compressed views as unpacked.
    pub fn total_bytes(&self) -> usize {
        let unpacked = self.unpacked.values().flatten();
        self.buffers.iter().flatten().chain(unpacked).map(Vec::len).sum()
    }

    fn range(&self, buffer: usize, start: u64, length: u64) -> Reason<&[u8]> {
        let bytes = self
            .buffers
            .get(buffer)
            .ok_or_else(|| no_such("buffer", buffer))?
            .as_ref()
            .ok_or_else(|| format!("buffer {buffer} has no data except from an extension"))?;
        let end = start.saturating_add(length);
        if end > bytes.len() as u64 {
            return Err(format!("ends at byte {end}, but buffer {buffer} has {} bytes", bytes.len()));
        }
        Ok(&bytes[start as usize..end as usize])
    }

    /// Unpacks compressed views to at most `most` bytes.
    fn unpack(&mut self, root: &Root, most: usize) {
        let mut budget = most.min(MAX_UNPACKED_OF_SMALL + MAX_UNPACKED_PER_BYTE * self.total_bytes());
        for (index, view) in root.buffer_views.iter().enumerate() {
            let Some(json) = meshopt::of_view(view) else { continue };
            let unpacked = Packed::read(json).and_then(|packed| {
                let bytes = self.range(packed.buffer, packed.offset, packed.length)?;
                let rest = budget.checked_sub(packed.size());
                budget = rest.ok_or("the compressed views of the file unpack to too many bytes")?;
                packed.unpack(bytes)
            });
            self.unpacked.insert(index, unpacked);
        }
    }
}

/// Reads the buffer that a URI refers to.
pub(super) fn load_buffer(reading: &Reading, name: &str, index: usize) -> Result<Vec<u8>> {
    let wrong = |what: String| Err(Error::parse(reading.path(), format!("buffer {index}"), what));
    let short = shortened(name);
    match locate(name, reading) {
        Ok(ByteSource::Data { bytes, .. }) => Ok(bytes),
        Ok(ByteSource::File(path)) if path.exists() => reading.read(&path),
        Ok(ByteSource::File(path)) => {
            wrong(format!("the file '{short}' is missing; put it at {}", path.display()))
        }
        Err(why) => wrong(format!("'{short}': {why}")),
    }
}

/// The elements of an accessor, without gaps, in their packed type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Supplied {
    /// The type of a component.
    pub component: ComponentType,
    /// The number of components of an element.
    pub width: usize,
    /// The elements, little-endian.
    pub bytes: Vec<u8>,
}

impl Supplied {
    /// Returns the number of elements.
    pub fn count(&self) -> usize {
        self.bytes.len() / (self.width * self.component.size())
    }
}

/// The accessor elements that replace those of buffer views, or the reason why they are unavailable.
pub(super) type Supply = BTreeMap<usize, Reason<Supplied>>;

/// A Base64 decoder that does not require padding, which is often missing.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The source of bytes.
#[derive(Debug, PartialEq)]
pub(super) enum ByteSource {
    /// In the URI itself.
    Data {
        /// The media type, such as `image/png`; may be empty.
        media_type: String,
        /// The decoded bytes.
        bytes: Vec<u8>,
    },
    /// A file that may or may not exist.
    File(PathBuf),
}

/// Locates the source that `uri` refers to; a file must be in the model's folder unless other locations are allowed.
pub(super) fn locate(uri: &str, reading: &Reading) -> Reason<ByteSource> {
    if let Some(data) = strip_scheme(uri, "data:") {
        return decode_data(data);
    }
    if has_scheme(uri) {
        return Err("URIs with a scheme are not fetched; put the file next to the model".into());
    }
    if uri.starts_with(['/', '\\']) {
        return Err("absolute paths are not followed; put the file next to the model".into());
    }
    let decoded = percent_decode_str(uri).decode_utf8().map_err(|_| "not valid UTF-8")?;
    // Names written without encoding, or with Windows separators, are common.
    let candidates =
        [decoded.as_ref(), uri, &decoded.replace('\\', "/")].map(|name| reading.folder().join(name));
    let mut allowed = candidates.iter().filter(|path| reading.allows(path).is_ok());
    if let Some(found) = allowed.find(|path| path.exists()) {
        return Ok(ByteSource::File(found.clone()));
    }
    let refused = candidates.iter().find_map(|path| reading.allows(path).err());
    refused.map_or_else(|| Ok(ByteSource::File(candidates[0].clone())), Err)
}

/// Returns the file that `uri` refers to, if it exists and may be read.
pub(super) fn file(uri: &str, reading: &Reading) -> Option<PathBuf> {
    if strip_scheme(uri, "data:").is_some() {
        return None;
    }
    match locate(uri, reading) {
        Ok(ByteSource::File(path)) => path.is_file().then_some(path),
        _ => None,
    }
}

/// Returns a URI shortened for a one-line message.
pub(super) fn shortened(uri: &str) -> String {
    let start: String = uri.chars().filter(|c| !c.is_control()).take(80).collect();
    if start.len() < uri.len() { format!("{start}…") } else { start }
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let (start, rest) = uri.split_at_checked(scheme.len())?;
    start.eq_ignore_ascii_case(scheme).then_some(rest)
}

/// Returns `true` if a URI has a scheme. RFC 3986, 3.1. A single letter counts too: it is a Windows drive, hence an
/// absolute path.
fn has_scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else { return false };
    scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}

fn decode_data(data: &str) -> Reason<ByteSource> {
    let (header, body) = data.split_once(',').ok_or("data URI without a comma")?;
    let mut parts = header.split(';');
    let media_type = parts.next().unwrap_or_default().to_ascii_lowercase();
    let bytes = if parts.any(|p| p.trim().eq_ignore_ascii_case("base64")) {
        let is_plain = |byte: u8| byte != b'%' && !byte.is_ascii_whitespace();
        let decoded = match body.bytes().all(is_plain) {
            true => BASE64.decode(body),
            false => BASE64.decode(unescaped(body, |byte| !byte.is_ascii_whitespace())),
        };
        decoded.map_err(|e| format!("invalid base64: {e}"))?
    } else {
        unescaped(body, |_| true)
    };
    Ok(ByteSource::Data { media_type, bytes })
}

/// Percent-decodes a text, keeping only the wanted bytes. Uses no more memory than the text.
fn unescaped(text: &str, is_wanted: impl Fn(u8) -> bool) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    bytes.extend(percent_decode_str(text).filter(|byte| is_wanted(*byte)));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use std::path::Path;

    fn of(folder: &Path) -> Reading {
        Reading::new(&folder.join("m.gltf"), &Limits::default())
    }

    fn data(uri: &str) -> Vec<u8> {
        match locate(uri, &of(Path::new(""))).unwrap() {
            ByteSource::Data { bytes, .. } => bytes,
            ByteSource::File(path) => panic!("{path:?}"),
        }
    }

    #[test]
    fn data_uris() {
        assert_eq!(data("data:application/octet-stream;base64,AQID"), [1, 2, 3]);
        assert_eq!(data("DATA:;base64,AQI="), [1, 2]);
        assert_eq!(data("data:;base64,AQI"), [1, 2]);
        assert_eq!(data("data:;base64,A%51 I\n="), [1, 2]);
        assert_eq!(data("data:text/plain,a%20b"), b"a b");
        assert!(locate("data:;base64,A*", &of(Path::new(""))).is_err());
        assert!(locate("data:;base64", &of(Path::new(""))).is_err());
    }

    #[test]
    fn files_with_spaces_and_backslashes() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("a b")).unwrap();
        let there = folder.path().join("a b/c%20d.bin");
        std::fs::write(&there, "").unwrap();
        for name in ["a%20b/c%2520d.bin", "a b/c%20d.bin"] {
            assert_eq!(locate(name, &of(folder.path())).unwrap(), ByteSource::File(there.clone()), "{name}");
        }
        std::fs::write(folder.path().join("a b/e.bin"), "").unwrap();
        let Ok(ByteSource::File(found)) = locate("a b\\e.bin", &of(folder.path())) else { panic!("a file") };
        assert!(found.exists());
    }

    #[test]
    fn files_are_those_that_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let there = folder.path().join("a b.bin");
        std::fs::write(&there, "").unwrap();
        assert_eq!(file("a%20b.bin", &of(folder.path())), Some(there));
        for uri in ["absent.bin", "data:,a%20b.bin", "file:///etc/passwd"] {
            assert_eq!(file(uri, &of(folder.path())), None, "{uri}");
        }
    }

    #[test]
    fn files_outside_are_refused_by_name() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("m");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("secret.bin"), "").unwrap();
        for uri in ["../secret.bin", "%2e%2e/secret.bin", "..\\secret.bin", "a/../../secret.bin"] {
            let why = locate(uri, &of(&folder)).unwrap_err();
            assert!(why.contains("secret.bin") && why.contains("--allow-outside"), "{why}");
            assert_eq!(file(uri, &of(&folder)), None);
        }
        let limits = Limits { allow_outside: true, ..Limits::default() };
        let allowed = Reading::new(&folder.join("m.gltf"), &limits);
        assert!(file("../secret.bin", &allowed).is_some());
    }

    #[test]
    fn nothing_is_fetched() {
        for uri in ["http://x/y.bin", "HTTPS://x", "file:///etc/passwd", "/etc/passwd", "C:\\x.bin"] {
            assert!(locate(uri, &of(Path::new(""))).is_err(), "{uri}");
        }
    }
}
