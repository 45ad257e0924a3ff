//! The JSON of a file or of a GLB, and what follows it.

use serde_json::Value;

/// The bytes of a GLB before its JSON: its own header, and that of the chunk.
const HEADER: usize = 20;

/// A file with its parsed JSON.
pub struct Document {
    /// The JSON.
    pub json: Value,
    /// The rest of a GLB after the JSON; `None` for a file that is only JSON.
    rest: Option<Vec<u8>>,
}

impl Document {
    /// Parses a file; `None` if it contains no JSON.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if !bytes.starts_with(b"glTF") {
            let is_json = matches!(bytes.trim_ascii_start().first(), Some(b'{' | b'['));
            let json = is_json.then(|| serde_json::from_slice(bytes).ok())??;
            return Some(Self { json, rest: None });
        }
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        let (text, rest) = bytes.get(HEADER..)?.split_at_checked(length)?;
        Some(Self { json: serde_json::from_slice(text).ok()?, rest: Some(rest.to_vec()) })
    }

    /// Returns the file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut text = self.json.to_string().into_bytes();
        let Some(rest) = &self.rest else { return text };
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = |length: usize| (length as u32).to_le_bytes();
        let all = length(HEADER + text.len() + rest.len());
        [b"glTF\x02\0\0\0", &all[..], &length(text.len()), b"JSON", &text, rest].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn json_is_read_from_either_form_and_written_back() {
        for rest in [None, Some(b"\x04\0\0\0BIN\0abcd".to_vec())] {
            let bytes = Document { json: json!({ "a": [1, 2] }), rest: rest.clone() }.bytes();
            let mut document = Document::of(&bytes).unwrap();
            assert_eq!((document.json["a"][1].as_u64(), &document.rest), (Some(2), &rest));
            document.json["a"] = json!("longer than before");
            let bytes = document.bytes();
            assert_eq!(Document::of(&bytes).unwrap().json, document.json);
            if rest.is_some() {
                assert_eq!(bytes[8..12], (bytes.len() as u32).to_le_bytes());
            }
        }
        assert!(Document::of(b"v 0 0 0").is_none() && Document::of(b"glTF").is_none());
    }
}
