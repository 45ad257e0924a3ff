//! ASCII payloads, converted to binary ones. `ply-rs-bw` reads one row per line with a grammar that rejects `.5`,
//! `1.` and `nan`, which exporters do write, so words are read individually here: in parallel if each row has its own
//! line, else regardless of line ends.

use super::super::text::{line_ends, quote};
use super::header::is_float;
use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::parallel;

/// Bytes of text that a thread reads at a time; a piece may be one line longer.
const PIECE: usize = 1 << 18;

/// The words of a payload, with their current line.
pub(super) struct Tokens<'a> {
    path: &'a Path,
    rest: &'a [u8],
    line: usize,
    /// `true` if words after the end of the line are ignored.
    in_line: bool,
}

impl<'a> Tokens<'a> {
    /// Creates a reader for the words of `payload`, which starts at the given line of the file.
    pub(super) fn new(path: &'a Path, payload: &'a [u8], line: usize) -> Self {
        Self { path, rest: payload, line, in_line: false }
    }

    /// Returns the rows of an element as little-endian numbers, and the element with their actual types.
    ///
    /// Lists are widened, since exporters declare narrower indices than they write.
    pub(super) fn rows(&mut self, element: &ElementDef) -> Result<(Vec<u8>, ElementDef)> {
        let mut widened = element.clone();
        for (_, property) in widened.properties.iter_mut() {
            if let PropertyType::List(_, scalar) = &property.data_type {
                let scalar = if is_float(scalar) { ScalarType::Double } else { ScalarType::UInt };
                property.data_type = PropertyType::List(ScalarType::UInt, scalar);
            }
        }
        let rows = match self.rows_by_line(&widened) {
            Some(rows) => rows,
            None => self.rows_by_word(&widened)?,
        };
        Ok((rows, widened))
    }

    /// Returns the rows of an element, regardless of line ends.
    fn rows_by_word(&mut self, element: &ElementDef) -> Result<Vec<u8>> {
        let mut rows = Vec::new();
        for i in 0..element.count {
            self.row(element, &mut rows).map_err(|what| {
                let what = format!("{what} in {} {i} of {}", element.name, element.count);
                Error::parse(self.path, format!("line {}", self.line), what)
            })?;
        }
        Ok(rows)
    }

    /// Returns the rows of an element with one row per line, read in parallel; `None` if it has a different layout or
    /// any error, in which case nothing is consumed.
    fn rows_by_line(&mut self, element: &ElementDef) -> Option<Vec<u8>> {
        let start = self.rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let (space, text) = self.rest.split_at(start);
        let (lines, rest) = text.split_at(length_of_lines(text, element.count)?);
        let pieces = pieces(lines);
        let mut rows = Vec::new();
        for group in pieces.chunks(4 * rayon::current_num_threads()) {
            for piece in parallel::tasks(group.len(), &|i| self.rows_of_lines(group[i], element)) {
                let mut piece = piece?;
                if rows.is_empty() {
                    rows.reserve_exact(piece.len() * pieces.len());
                }
                rows.append(&mut piece);
            }
        }
        self.line += line_ends(space) + element.count - 1;
        self.rest = rest;
        Some(rows)
    }

    /// Returns the rows of these lines, one per line.
    fn rows_of_lines(&self, lines: &'a [u8], element: &ElementDef) -> Option<Vec<u8>> {
        let mut tokens = Self { rest: lines, in_line: true, ..*self };
        let mut rows = Vec::with_capacity(lines.len());
        while !tokens.rest.is_empty() {
            tokens.row(element, &mut rows).ok()?;
            tokens.skip_space();
            match tokens.rest {
                [] => {}
                [b'\n', rest @ ..] => tokens.rest = rest,
                _ => return None,
            }
        }
        Some(rows)
    }

    #[inline]
    fn row(&mut self, element: &ElementDef, row: &mut Vec<u8>) -> std::result::Result<(), String> {
        for (_, property) in &element.properties {
            self.property(&property.data_type, row)?;
        }
        Ok(())
    }

    #[inline]
    fn property(&mut self, data_type: &PropertyType, row: &mut Vec<u8>) -> std::result::Result<(), String> {
        let scalar = match data_type {
            PropertyType::Scalar(scalar) => {
                push_number(self.number()?, scalar, row);
                return Ok(());
            }
            PropertyType::List(_, scalar) => scalar,
        };
        let count = self.number()?;
        if index(count).is_none() && (count < 0.0 || count != count.floor()) {
            return Err(format!("invalid list length {count}"));
        }
        row.extend((count as u32).to_le_bytes());
        for _ in 0..count as u64 {
            let value = self.number()?;
            match scalar {
                // An invalid index is replaced by one that is out of range.
                ScalarType::UInt => row.extend(index(value).unwrap_or(u32::MAX).to_le_bytes()),
                _ => push_number(value, scalar, row),
            }
        }
        Ok(())
    }

    #[inline]
    fn number(&mut self) -> std::result::Result<f64, String> {
        self.skip_space();
        let end = self.rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        if word.is_empty() {
            return Err("unexpected end of file".to_owned());
        }
        self.rest = rest;
        let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        value.ok_or_else(|| format!("{} is not a number", quote(&String::from_utf8_lossy(word))))
    }

    #[inline]
    fn skip_space(&mut self) {
        while let [space, rest @ ..] = self.rest
            && space.is_ascii_whitespace()
            && !(self.in_line && *space == b'\n')
        {
            self.line += usize::from(*space == b'\n');
            self.rest = rest;
        }
    }
}

/// Converts a number to an index; `None` if it is not a valid index.
#[inline]
fn index(value: f64) -> Option<u32> {
    let index = value as u32;
    (f64::from(index) == value).then_some(index)
}

/// Returns the length in bytes of the first `count` lines, without the last line end; `None` if there are fewer, or
/// the last is empty.
fn length_of_lines(text: &[u8], count: usize) -> Option<usize> {
    let end = end_of_lines(text, count)?;
    (!text[..end].ends_with(b"\n")).then_some(end)
}

fn end_of_lines(text: &[u8], count: usize) -> Option<usize> {
    /// Bytes whose lines are counted together.
    const BLOCK: usize = 1 << 12;
    let mut left = count.checked_sub(1)?;
    for (block, bytes) in text.chunks(BLOCK).enumerate() {
        let lines = line_ends(bytes);
        if lines > left {
            let mut ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
            return ends.nth(left).map(|(i, _)| block * BLOCK + i);
        }
        left -= lines;
    }
    (left == 0).then_some(text.len())
}

/// Splits text after line ends.
fn pieces(mut text: &[u8]) -> Vec<&[u8]> {
    let mut pieces = Vec::new();
    while !text.is_empty() {
        let from = PIECE.min(text.len());
        let end = text[from..].iter().position(|b| *b == b'\n').map_or(text.len(), |i| from + i + 1);
        let (piece, rest) = text.split_at(end);
        pieces.push(piece);
        text = rest;
    }
    pieces
}

/// Appends a number as its declared type; integers out of range are clamped.
fn push_number(value: f64, scalar: &ScalarType, row: &mut Vec<u8>) {
    match scalar {
        ScalarType::Char => row.extend((value as i8).to_le_bytes()),
        ScalarType::UChar => row.push(value as u8),
        ScalarType::Short => row.extend((value as i16).to_le_bytes()),
        ScalarType::UShort => row.extend((value as u16).to_le_bytes()),
        ScalarType::Int => row.extend((value as i32).to_le_bytes()),
        ScalarType::UInt => row.extend((value as u32).to_le_bytes()),
        ScalarType::Float => row.extend((value as f32).to_le_bytes()),
        ScalarType::Double => row.extend(value.to_le_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ply_rs_bw::ply::PropertyDef;

    fn element(count: usize) -> ElementDef {
        let mut element = ElementDef::new("face".to_owned());
        element.count = count;
        let list = PropertyType::List(ScalarType::UChar, ScalarType::Int);
        for (name, data_type) in [("list", list), ("x", PropertyType::Scalar(ScalarType::Float))] {
            element.properties.insert(name.to_owned(), PropertyDef::new(name.to_owned(), data_type));
        }
        element
    }

    /// Returns the rows of two elements, or the error; and whether the first was read by lines.
    fn read(text: &str, counts: [usize; 2]) -> (std::result::Result<Vec<Vec<u8>>, String>, bool) {
        let mut tokens = Tokens::new(Path::new("a.ply"), text.as_bytes(), 7);
        let rows = counts.map(|count| tokens.rows(&element(count)).map(|(rows, _)| rows));
        let by_line = Tokens::new(Path::new("a.ply"), text.as_bytes(), 7).rows_by_line(&element(counts[0]));
        (rows.into_iter().collect::<Result<_>>().map_err(|error| error.to_string()), by_line.is_some())
    }

    /// Rows on one line each, and the same words on other lines.
    #[test]
    fn rows_are_the_same_however_their_lines_end() {
        let rows =
            ["3 0 1 2 .5", "0 1e-3", "2 -1 1.5 nan", "1 5000000000 123456789012345678901", "1 -0 1e400"];
        let text: String = (0..200_000).map(|i| format!("{}\n", rows[i % 5])).collect();
        let (lines, by_line) = read(&text, [150_000, 50_000]);
        assert!(by_line && lines.as_ref().is_ok_and(|lines| lines[0].len() > PIECE));
        let cut = text.trim_end().replacen(" ", "  \t", 9);
        let crlf = text.replace('\n', "\r\n");
        for text in [format!("\n \r\n{text}\n"), cut, crlf] {
            assert_eq!(read(&text, [150_000, 50_000]), (lines.clone(), true));
        }
        let mut words = text.split_whitespace();
        let words: String =
            (0..).map_while(|i| Some(words.next()?.to_owned() + [" ", "\n", " "][i % 3])).collect();
        let empty = text.replacen("\n3", "\n\n3", 1000);
        for text in [text.replace('\n', " "), words, empty] {
            assert_eq!(read(&text, [150_000, 50_000]), (lines.clone(), false));
        }
    }

    #[test]
    fn an_empty_line_is_no_row() {
        let (rows, by_line) = read("1 0 1\n1 2 3\n\n1 4 5\n", [3, 0]);
        assert_eq!((rows.unwrap()[0].len(), by_line), (36, false));
        assert!(read("1 0 1\n1 2 3\n\n", [3, 0]).0.unwrap_err().contains("line 10: unexpected end of file"));
    }

    #[test]
    fn errors_name_the_same_line_however_rows_are_read() {
        let sound = "1 0 1\n".repeat(3);
        let cases = [
            ("1 0 x\n", "a.ply: line 10: 'x' is not a number in face 0 of 1"),
            ("\n1.5 0 0\n", "a.ply: line 11: invalid list length 1.5 in face 0 of 1"),
            ("-1 0\n", "a.ply: line 10: invalid list length -1 in face 0 of 1"),
            ("1 0", "a.ply: line 10: unexpected end of file in face 0 of 1"),
            ("", "a.ply: line 10: unexpected end of file in face 0 of 1"),
            ("\n", "a.ply: line 11: unexpected end of file in face 0 of 1"),
            ("1 0\n\n", "a.ply: line 12: unexpected end of file in face 0 of 1"),
            ("inf 0\n", "a.ply: line 11: unexpected end of file in face 0 of 1"),
        ];
        for (end, error) in cases {
            assert_eq!(read(&format!("{sound}{end}"), [3, 1]), (Err(error.to_owned()), true), "{end:?}");
            let words = format!("{}\n\n{end}", sound.trim_end().replacen('\n', " ", 1));
            assert_eq!(read(&words, [3, 1]), (Err(error.to_owned()), false), "{end:?}");
        }
    }
}
