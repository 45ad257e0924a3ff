//! The header of a PLY file, and what is wrong with one in plain words.

use super::super::text::quote;
use crate::error::{Error, Result};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, Header};
use std::io::{Cursor, ErrorKind};
use std::path::Path;

/// The longest header that is looked at.
const MAX_HEADER: usize = 1 << 20;

/// Returns the header, and where the payload starts: its first byte and its line.
///
/// # Errors
/// [`Error::Parse`] with the line that is no statement of a header, or that the header lacks.
pub(super) fn read_header(path: &Path, bytes: &mut [u8]) -> Result<(Header, usize, usize)> {
    mend_header(bytes);
    let mut reader = Reader::new(Cursor::new(&*bytes));
    let header = Parser::<DefaultElement>::new().read_header(&mut reader);
    let header = header.map_err(|e| Error::parse(path, place(&e), fault(&e, bytes)))?;
    Ok((header, reader.get_ref().position() as usize, reader.line()))
}

/// Makes the header what the parser takes: question marks for what is not ASCII, since it demands UTF-8 even of
/// comments, and line feeds where the lines end in carriage returns alone.
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

/// Returns what is wrong; the parser's own message names the rules of its grammar.
fn fault(error: &ParseError, bytes: &[u8]) -> String {
    match (error.kind(), error.line()) {
        (ErrorKind::UnexpectedEof, _) => {
            "the header has no end_header: the file is cut off; fetch or export it again".into()
        }
        (ErrorKind::InvalidData, _) => "the header is no text; fetch or export the file again".into(),
        (_, Some(1)) => "the file does not begin with ply; fetch or export it again".into(),
        (_, Some(line)) => of_statement(&line_of(bytes, line)),
        (_, None) => "the header has no format with a version, such as `format ascii 1.0`".into(),
    }
}

/// Returns why a statement of a header cannot be read.
fn of_statement(statement: &str) -> String {
    let why = match statement.split_whitespace().next().unwrap_or_default() {
        "format" => {
            "is not ascii, binary_little_endian or binary_big_endian with 1.0, or contradicts another"
        }
        "element" => "is no element with a name and a number, such as `element vertex 8`",
        "property" => {
            "is no property of an element before it, with a type and a name, such as `property float x`"
        }
        _ => "is none of format, element, property, comment, obj_info and end_header",
    };
    format!("{} {why}; mend the file or export it again", quote(statement))
}

/// Returns a line of the file, from 1.
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
            ("plyx\n", "line 1: the file does not begin with ply"),
            (
                "ply\nformat ascii 1.0\nelement vertex 3\n",
                "the header has no end_header: the file is cut off",
            ),
            ("ply\nelement vertex 0\nend_header\n", "header: the header has no format with a version"),
            (
                "ply\nformat text 1.0\nend_header\n",
                "line 2: 'format text 1.0' is not ascii, binary_little_endian",
            ),
            ("ply\nformat ascii 1.0\nelement vertex\nend_header\n", "line 3: 'element vertex' is no element"),
            (
                "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
                "line 3: 'property float x' is no property",
            ),
            (
                "ply\nformat ascii 1.0\nelement v 1\nproperty big x\nend_header\n",
                "line 4: 'property big x' is no",
            ),
            (
                "ply\nformat ascii 1.0\nelephant\nend_header\n",
                "line 3: 'elephant' is none of format, element",
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
