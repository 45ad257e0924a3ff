//! Text of files: its encoding, its numbered lines and its words.

use super::file::read;
use std::borrow::Cow;
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// Reads the text of a file, see [`decode_text`].
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Limit`] if it is so long that counts of its contents may not
/// fit 32 bits.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let bytes = read(path)?;
    if bytes.len() >= u32::MAX as usize {
        return Err(Error::limit(path.display().to_string(), "the maximum is 4 GiB of text; split the file"));
    }
    Ok(decode_text(bytes))
}

/// Decodes text from UTF-16 (with a byte order mark, or with a zero in the first two bytes), UTF-8, or else Latin-1,
/// in which any bytes are valid. Lone carriage returns, the line ends of classic Mac OS, become line feeds.
pub fn decode_text(bytes: Vec<u8>) -> String {
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
pub fn quote(what: &str) -> String {
    let mut start: String = what.chars().take(40).collect::<String>().escape_debug().collect();
    if what.chars().nth(40).is_some() {
        start.push('…');
    }
    format!("'{start}'")
}

/// The words of plain text, read line by line: the remaining text. Anything unusual is left to the parsers that
/// report errors. Spaces, tabs and carriage returns separate words; line feeds end lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    /// Creates a reader for the words of `text`.
    #[inline]
    pub fn new(text: &'a [u8]) -> Self {
        Self { rest: text }
    }

    /// Returns the remaining text.
    #[inline]
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Skips `count` bytes.
    #[inline]
    pub fn skip(&mut self, count: usize) {
        self.rest = self.rest.get(count..).unwrap_or_default();
    }

    /// Returns `true` if no words are left on this line.
    #[inline]
    pub fn at_end_of_line(&mut self) -> bool {
        self.skip_blanks();
        matches!(self.rest, [] | [b'\n', ..])
    }

    /// Skips the end of the line; `None` if a word is left on it.
    #[inline]
    pub fn end_line(&mut self) -> Option<()> {
        let ends = self.at_end_of_line();
        self.skip(usize::from(ends));
        ends.then_some(())
    }

    /// Skips this line, whatever it contains.
    pub fn skip_line(&mut self) {
        let end = self.rest.iter().position(|byte| *byte == b'\n').map_or(self.rest.len(), |i| i + 1);
        self.skip(end);
    }

    /// Skips any following lines without words.
    pub fn skip_empty_lines(&mut self) {
        while !self.rest.is_empty() && self.end_line().is_some() {}
    }

    /// Skips the next word if it is `word`, ignoring case; `None` if it is different.
    #[inline]
    pub fn keyword(&mut self, word: &[u8]) -> Option<()> {
        self.skip_blanks();
        let found = self.rest.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
        (found && self.parts(word.len())).then(|| self.skip(word.len()))
    }

    /// Reads a number; `None` if no words are left on the line or the word is not a number.
    #[inline]
    pub fn number(&mut self) -> Option<f32> {
        self.skip_blanks();
        let length = (0..).find(|i| self.parts(*i))?;
        let value = std::str::from_utf8(self.rest.get(..length)?).ok()?.parse().ok();
        self.skip(length);
        value
    }

    /// Reads an integer of at most nine digits, which any byte may follow; `None` if there is none.
    #[inline]
    pub fn whole(&mut self) -> Option<u32> {
        let (mut value, mut length) = (0_u32, 0);
        while let Some(digit) = self.rest.get(length).map(|byte| byte.wrapping_sub(b'0'))
            && digit < 10
        {
            if length == 9 {
                return None;
            }
            value = value * 10 + u32::from(digit);
            length += 1;
        }
        self.skip(length);
        (length > 0).then_some(value)
    }

    /// Skips the next byte if it is `byte`, and returns whether it was.
    #[inline]
    pub fn byte(&mut self, byte: u8) -> bool {
        let is_next = self.rest.first() == Some(&byte);
        self.skip(usize::from(is_next));
        is_next
    }

    /// Returns `true` if a word ends here.
    #[inline]
    pub fn between_words(&self) -> bool {
        self.parts(0)
    }

    /// Skips blanks within the line.
    #[inline]
    pub fn skip_blanks(&mut self) {
        while let [b' ' | b'\t' | b'\r', rest @ ..] = self.rest {
            self.rest = rest;
        }
    }

    #[inline]
    fn parts(&self, at: usize) -> bool {
        matches!(self.rest.get(at), None | Some(b' ' | b'\t' | b'\r' | b'\n'))
    }
}

/// Returns the number of line ends in `text`.
pub(super) fn line_ends(text: &[u8]) -> usize {
    /// The range of a byte counter, so that the compiler counts in many bytes simultaneously.
    const COUNTED: usize = 255;
    let ends = |few: &[u8]| few.iter().fold(0_u8, |ends, byte| ends.wrapping_add(u8::from(*byte == b'\n')));
    text.chunks(COUNTED).map(|few| usize::from(ends(few))).sum()
}

/// The part of a name that marks an object of a low-poly mesh.
pub const LOW_MARK: &str = "_low";
/// The part of a name that marks an object of a scan.
pub const HIGH_MARK: &str = "_high";

/// Returns `true` for the name of an object that is named for baking: `wheel_low`, `wheel_high`.
pub fn is_for_baking(name: &str) -> bool {
    [LOW_MARK, HIGH_MARK].iter().any(|mark| name_before(name, mark).is_some())
}

/// Returns what is before the last `mark` in a name, in lower case, if `mark` ends a word there: `wheel` for `_low` in
/// `Wheel_low.001`; `None` in `wheel_lower`.
pub fn name_before(name: &str, mark: &str) -> Option<String> {
    let name = name.to_lowercase();
    let (before, rest) = name.rsplit_once(mark)?;
    let ends_word = rest.chars().next().is_none_or(|c| !c.is_alphanumeric());
    (!before.is_empty() && ends_word).then(|| before.to_owned())
}

/// Returns the first names of a list, and how many more there are.
pub fn listed(names: &[String]) -> String {
    /// The maximum number of names in a message.
    const MOST: usize = 4;
    let shown = names.iter().take(MOST).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = ('a'..='f').map(String::from).collect();
        assert_eq!(listed(&names[..2]), "a, b");
        assert_eq!(listed(&names), "a, b, c, d and 2 more");
    }

    #[test]
    fn decodes_what_editors_write() {
        assert_eq!(decode_text(b"v\r\n1".to_vec()), "v\r\n1");
        assert_eq!(decode_text(b"v\r1".to_vec()), "v\n1");
        assert_eq!(decode_text(vec![0xEF, 0xBB, 0xBF, b'v']), "v");
        assert_eq!(decode_text(vec![0xFE, 0xFF, 0, b'v', 0x9F, 0x0E]), "v鼎");
        assert_eq!(decode_text(vec![b'v', 0, b' ', 0]), "v ");
        assert_eq!(decode_text(vec![0, b'v', 0, b' ']), "v ");
        assert_eq!(decode_text(vec![b'd', 0xE4, b'k']), "däk");
        assert_eq!(decode_text(Vec::new()), "");
    }

    #[test]
    fn joins_continued_lines_and_counts_from_one() {
        let text = "# c:\\\nf 1 2 \\\n  3 \\\r\n4\n\n  g a\\";
        let found: Vec<_> = lines(text).map(|(n, l)| (n, l.into_owned())).collect();
        assert_eq!(found, [(2, "f 1 2  3  4".to_owned()), (6, "g a".to_owned())]);
    }

    #[test]
    fn all_ends_of_lines_count() {
        for count in [0, 1, 254, 255, 256, 10_000] {
            assert_eq!(line_ends("\n".repeat(count).as_bytes()), count);
            assert_eq!(line_ends("a\r\nb".repeat(count).as_bytes()), count);
        }
    }

    #[test]
    fn words_end_at_blanks_and_lines() {
        let mut words = Words::new(b" Facet\t1.5 nan\r\n \n\n7/8 x");
        assert_eq!(words.keyword(b"face"), None);
        assert_eq!(words.keyword(b"facet"), Some(()));
        assert_eq!(words.number(), Some(1.5));
        assert!(words.number().is_some_and(f32::is_nan) && words.at_end_of_line());
        assert_eq!(words.number(), None);
        words.skip_empty_lines();
        assert_eq!((words.whole(), words.between_words(), words.byte(b'/')), (Some(7), false, true));
        assert_eq!((words.whole(), words.between_words(), words.whole()), (Some(8), true, None));
        assert_eq!((words.end_line(), words.keyword(b"x"), words.end_line()), (None, Some(()), Some(())));
        assert!(words.rest().is_empty() && Words::new(b"1234567890").whole().is_none());
    }
}
