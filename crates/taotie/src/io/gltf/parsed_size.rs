//! The memory that the JSON of a document takes, foretold from its text.

/// Bytes that a byte of JSON takes while it is parsed: values, then types made of them.
const PARSED: u64 = 16;
/// Bytes that a byte of a `data:` URI takes beside its text. While it is parsed that is a string, one byte. Later the text
/// is gone, and there are the string, at most one byte of Base64 without blanks, and three quarters of a byte of content.
const OF_DATA: u64 = 2;
/// The first bytes of a URI that count as any others: what its string takes beside its letters, and a short one does not
/// count apart.
const HEAD: usize = 64;

/// Returns the bytes that a document takes beside its text, which is a copy of a part of the file where `is_copied`.
pub(super) fn parsed_size(text: &[u8], is_copied: bool) -> u64 {
    let data = data_uris(text);
    let all = text.len() as u64;
    (all - data) * PARSED + data * (OF_DATA + u64::from(is_copied))
}

/// Returns the bytes of `data:` URIs, without their heads. Where a string has an escape, the parser copies it once more, and
/// it does not count.
fn data_uris(text: &[u8]) -> u64 {
    let mut is_escaped = false;
    let mut bytes = 0;
    // In JSON a piece that begins with these letters is a string, unless the mark before it is escaped.
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
    fn what_might_be_numbers_counts_whole() {
        let long = "0,".repeat(100);
        let texts = [
            format!("[{long}0]"),
            // The marks within a string do not end it.
            format!(r#"["a\"data:{long}"]"#),
            format!(r#"["data:{long}\u0041"]"#),
            format!(r#"["data:{long}\""]"#),
            r#"["data:,abc"]"#.repeat(50),
        ];
        for text in texts {
            assert_eq!(size(&text), text.len() as u64 * 16, "{text}");
        }
    }
}
