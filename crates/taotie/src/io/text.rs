//! Text files of unknown encoding, as numbered lines.

use super::file;
use crate::error::{Error, Result};
use std::borrow::Cow;
use std::path::Path;

/// Reads the text of a file, see [`decode`].
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Limit`] if it is so long that counts of its contents may not
/// fit 32 bits.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let bytes = file::read(path)?;
    if bytes.len() >= u32::MAX as usize {
        return Err(Error::limit(path.display().to_string(), "the maximum is 4 GiB of text; split the file"));
    }
    Ok(decode(bytes))
}

/// Decodes text from UTF-16 (with a byte order mark, or with a zero in the first two bytes), UTF-8, or else Latin-1,
/// in which any bytes are valid. Lone carriage returns, the line ends of classic Mac OS, become line feeds.
pub(super) fn decode(bytes: Vec<u8>) -> String {
    let text = match bytes.as_slice() {
        [0xFF, 0xFE, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0, second, ..] if *second != 0 => utf16(&bytes, u16::from_be_bytes),
        [first, 0, ..] if *first != 0 => utf16(&bytes, u16::from_le_bytes),
        _ => match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(e) => e.into_bytes().into_iter().map(char::from).collect(),
        },
    };
    let text = if text.contains('\n') { text } else { text.replace('\r', "\n") };
    match text.strip_prefix('\u{FEFF}') {
        Some(rest) => rest.to_owned(),
        None => text,
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

/// Returns the trimmed, non-empty lines of `text` with their numbers, starting at 1. A line that ends in a backslash
/// continues on the next one; a line that starts with `#` is skipped and never continues.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut rest = text.lines().enumerate();
    std::iter::from_fn(move || {
        loop {
            let (number, line) = rest.next()?;
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let Some(head) = line.strip_suffix('\\') else {
                return Some((number + 1, Cow::Borrowed(line)));
            };
            let mut joined = head.to_owned();
            for (_, next) in rest.by_ref() {
                joined.push(' ');
                match next.trim().strip_suffix('\\') {
                    Some(part) => joined.push_str(part),
                    None => {
                        joined.push_str(next.trim());
                        break;
                    }
                }
            }
            return Some((number + 1, Cow::Owned(joined)));
        }
    })
}

/// Quotes words of a file for an error: escaped and at most 40 characters long.
pub(super) fn quote(what: &str) -> String {
    let mut start: String = what.chars().take(40).collect::<String>().escape_debug().collect();
    if what.chars().nth(40).is_some() {
        start.push('…');
    }
    format!("'{start}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_what_editors_write() {
        assert_eq!(decode(b"v\r\n1".to_vec()), "v\r\n1");
        assert_eq!(decode(b"v\r1".to_vec()), "v\n1");
        assert_eq!(decode(vec![0xEF, 0xBB, 0xBF, b'v']), "v");
        assert_eq!(decode(vec![0xFE, 0xFF, 0, b'v', 0x9F, 0x0E]), "v鼎");
        assert_eq!(decode(vec![b'v', 0, b' ', 0]), "v ");
        assert_eq!(decode(vec![0, b'v', 0, b' ']), "v ");
        assert_eq!(decode(vec![b'd', 0xE4, b'k']), "däk");
        assert_eq!(decode(Vec::new()), "");
    }

    #[test]
    fn joins_continued_lines_and_counts_from_one() {
        let text = "# c:\\\nf 1 2 \\\n  3 \\\r\n4\n\n  g a\\";
        let found: Vec<_> = lines(text).map(|(n, l)| (n, l.into_owned())).collect();
        assert_eq!(found, [(2, "f 1 2  3  4".to_owned()), (6, "g a".to_owned())]);
    }
}
