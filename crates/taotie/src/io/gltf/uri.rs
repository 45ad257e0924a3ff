//! Locates a buffer or image: in a data URI or in a file next to the model. The network is never accessed.

use super::reason::Reason;
use crate::io::reading::Reading;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use std::path::PathBuf;

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
    use crate::io::limits::Limits;
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
