//! The header of a PLY file, with plain error messages.

use super::super::text::quote;
use crate::error::{Error, Result};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Header};
use std::io::{Cursor, ErrorKind};
use std::path::Path;

/// Maximum length of a header.
const MAX_HEADER: usize = 1 << 20;

/// Returns the header, and the start of the payload: its first byte and its line.
///
/// # Errors
/// [`Error::Parse`] with the line of an invalid header statement, or with what the header lacks.
pub(super) fn read_header(path: &Path, bytes: &mut [u8]) -> Result<(Header, usize, usize)> {
    mend_header(bytes);
    let mut reader = Reader::new(Cursor::new(&*bytes));
    let header = Parser::<DefaultElement>::new().read_header(&mut reader);
    let header = header.map_err(|e| Error::parse(path, place(&e), fault(&e, bytes)))?;
    Ok((header, reader.get_ref().position() as usize, reader.line()))
}

/// Makes the header acceptable to the parser: replaces non-ASCII bytes with question marks, since it requires UTF-8
/// even in comments, and lone carriage returns at line ends with line feeds.
fn mend_header(bytes: &mut [u8]) {
    const LAST: &[u8] = b"end_header";
    let start = &bytes[..bytes.len().min(MAX_HEADER)];
    let Some(end) = start.windows(LAST.len()).position(|w| w == LAST).map(|i| i + LAST.len()) else { return };
    if bytes.starts_with(b"ply\r") && bytes.get(4) != Some(&b'\n') {
        let end = bytes.len().min(end + 1);
        bytes[..end].iter_mut().filter(|b| **b == b'\r').for_each(|b| *b = b'\n');
    }
    if std::str::from_utf8(&bytes[..end]).is_err() {
        bytes[..end].iter_mut().filter(|b| !b.is_ascii()).for_each(|b| *b = b'?');
    }
}

fn place(error: &ParseError) -> String {
    error.line().map_or("header".to_owned(), |line| format!("line {line}"))
}

/// Returns the fault; the parser's own message uses the rule names of its grammar.
fn fault(error: &ParseError, bytes: &[u8]) -> String {
    match (error.kind(), error.line()) {
        (ErrorKind::UnexpectedEof, _) => {
            "missing end_header: the file is truncated; download or re-export it".into()
        }
        (ErrorKind::InvalidData, _) => "the header is not text; download or re-export the file".into(),
        (_, Some(1)) => "the file does not start with ply; download or re-export it".into(),
        (_, Some(line)) => of_statement(&line_of(bytes, line)),
        (_, None) => "missing format with a version, such as `format ascii 1.0`".into(),
    }
}

/// Returns why a header statement is invalid.
fn of_statement(statement: &str) -> String {
    let why = match statement.split_whitespace().next().unwrap_or_default() {
        "format" => {
            "is not ascii, binary_little_endian or binary_big_endian with 1.0, or contradicts another"
        }
        "element" => "is not an element with a name and a count, such as `element vertex 8`",
        "property" => {
            "is not a property of a preceding element with a type and a name, e.g. `property float x`"
        }
        _ => "is not one of format, element, property, comment, obj_info or end_header",
    };
    format!("{} {why}; fix the file or re-export it", quote(statement))
}

/// Returns a line of the file, starting at 1.
fn line_of(bytes: &[u8], line: usize) -> String {
    let line = bytes.split(|byte| *byte == b'\n').nth(line.saturating_sub(1)).unwrap_or_default();
    String::from_utf8_lossy(line).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_told_in_plain_words() {
        let cases = [
            ("plyx\n", "line 1: the file does not start with ply"),
            ("ply\nformat ascii 1.0\nelement vertex 3\n", "missing end_header: the file is truncated"),
            ("ply\nelement vertex 0\nend_header\n", "header: missing format with a version"),
            (
                "ply\nformat text 1.0\nend_header\n",
                "line 2: 'format text 1.0' is not ascii, binary_little_endian",
            ),
            (
                "ply\nformat ascii 1.0\nelement vertex\nend_header\n",
                "line 3: 'element vertex' is not an element",
            ),
            (
                "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
                "line 3: 'property float x' is not a property",
            ),
            (
                "ply\nformat ascii 1.0\nelement v 1\nproperty big x\nend_header\n",
                "line 4: 'property big x' is not",
            ),
            (
                "ply\nformat ascii 1.0\nelephant\nend_header\n",
                "line 3: 'elephant' is not one of format, element",
            ),
        ];
        for (header, why) in cases {
            let error = read_header(Path::new("a.ply"), &mut header.as_bytes().to_vec()).unwrap_err();
            let said = error.to_string();
            assert!(said.starts_with("a.ply: ") && said.contains(why), "{header:?}: {said}");
            assert!(said.len() < 200 && !said.contains("LineCol"), "{said}");
        }
    }
}
