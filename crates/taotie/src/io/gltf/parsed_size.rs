//! The memory needed for the JSON of a document, estimated from its text.

/// Bytes needed per byte of JSON during parsing: values, then the types built from them.
const PARSED: u64 = 16;
/// Bytes of a list or object with its first few members, and the bytes of text for which [`PARSED`] covers one of
/// them.
const LIST: [u64; 2] = [144, 32];
const OBJECT: [u64; 2] = [640, 48];
/// Number of lists and of objects that are not counted in any text.
const FREE: u64 = 8;
/// Bytes needed per byte of a `data:` URI in addition to its text. During parsing, this is a string, one byte. Later
/// the text is freed, and there are the string, at most one byte of Base64 without whitespace, and three quarters of
/// a byte of content.
const OF_DATA: u64 = 2;
/// The first bytes of a URI, which count like other text: they cover the overhead of its string, and a short URI is
/// not counted separately.
const HEAD: usize = 64;

/// Returns the bytes that a document needs in addition to its text, which is a copy of part of the file if
/// `is_copied`.
pub(super) fn parsed_size(text: &[u8], is_copied: bool) -> u64 {
    let data = data_uris(text);
    let values = text.len() as u64 - data;
    let beyond = |mark: u8, [bytes, covered]: [u64; 2]| {
        let count = text.iter().filter(|byte| **byte == mark).count() as u64;
        count.saturating_sub(values / covered + FREE) * bytes
    };
    values * PARSED + beyond(b'[', LIST) + beyond(b'{', OBJECT) + data * (OF_DATA + u64::from(is_copied))
}

/// Returns the bytes of `data:` URIs, without their heads. Strings with an escape are not included, since the parser
/// copies them again.
fn data_uris(text: &[u8]) -> u64 {
    let mut is_escaped = false;
    let mut bytes = 0;
    // In JSON, a piece that starts with these letters is a string, unless the preceding quote is escaped.
    for piece in text.split(|byte| *byte == b'"') {
        if !is_escaped && piece.starts_with(b"data:") && !piece.contains(&b'\\') {
            bytes += piece.len().saturating_sub(HEAD) as u64;
        }
        is_escaped = piece.ends_with(b"\\");
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(text: &str) -> u64 {
        parsed_size(text.as_bytes(), false)
    }

    #[test]
    fn the_content_of_data_uris_counts_apart() {
        let data = "data:;base64,".to_owned() + &"AAAA".repeat(1000);
        let text = format!(r#"{{"buffers":[{{"uri":"{data}"}}]}}"#);
        let apart = (data.len() - HEAD) as u64;
        assert_eq!(size(&text), (text.len() as u64 - apart) * 16 + apart * 2);
        assert_eq!(parsed_size(text.as_bytes(), true), size(&text) + apart);
        assert!(size(&text) < text.len() as u64 * 3);
    }

    #[test]
    fn lists_in_lists_and_small_objects_count_beside_their_text() {
        let nested = "[".repeat(100) + &"]".repeat(100);
        assert_eq!(size(&nested), 200 * 16 + (100 - 200 / 32 - 8) * 144);
        let objects = format!("[{}0]", r#"{"":0},"#.repeat(100));
        assert_eq!(size(&objects), 703 * 16 + (100 - 703 / 48 - 8) * 640);
        let node = r#"{"mesh":0,"translation":[10.25,20.5,30.75],"name":"n"},"#;
        assert_eq!(size(&node.repeat(100)), node.len() as u64 * 100 * 16, "as in real files");
    }

    #[test]
    fn what_might_be_numbers_counts_whole() {
        let long = "0,".repeat(100);
        let texts = [
            format!("[{long}0]"),
            // Quotes within a string do not end it.
            format!(r#"["a\"data:{long}"]"#),
            format!(r#"["data:{long}\u0041"]"#),
            format!(r#"["data:{long}\""]"#),
            format!("[{}0]", r#""data:,abc","#.repeat(50)),
        ];
        for text in texts {
            assert_eq!(size(&text), text.len() as u64 * 16, "{text}");
        }
    }
}
