//! The header of a PLY file, with plain error messages; and the meaning of the elements and properties that it names.

use super::super::text::quote;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Header, PropertyType, ScalarType};
use std::io::{Cursor, ErrorKind};
use std::path::Path;
use taotie_engine::error::{Error, Result};

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

/// The slots for the numbers of a vertex.
pub(super) mod slot {
    pub const POSITION: usize = 0;
    pub const NORMAL: usize = 3;
    pub const UV: usize = 6;
    pub const COLOR: usize = 8;
    pub const COUNT: usize = 12;
}

/// The use of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Skipped.
    Ignored,
    /// One of the numbers of [`slot`].
    Slot(usize),
    /// The vertices of a face, or of strips.
    Corners,
    /// A uv for each corner of a face.
    Uvs,
    /// The number of the face's texture.
    Texture,
}

/// Returns the slot of a vertex property, by the common names.
fn vertex_slot(name: &str) -> Option<usize> {
    Some(match name {
        "x" => slot::POSITION,
        "y" => slot::POSITION + 1,
        "z" => slot::POSITION + 2,
        "nx" | "normal_x" => slot::NORMAL,
        "ny" | "normal_y" => slot::NORMAL + 1,
        "nz" | "normal_z" => slot::NORMAL + 2,
        "s" | "u" | "texture_u" | "texture_s" => slot::UV,
        "t" | "v" | "texture_v" | "texture_t" => slot::UV + 1,
        name => slot::COLOR + color_slot(name)?,
    })
}

/// Returns 0 to 3 for the names of red, green, blue and alpha.
fn color_slot(name: &str) -> Option<usize> {
    Some(match name {
        "red" | "r" | "diffuse_red" => 0,
        "green" | "g" | "diffuse_green" => 1,
        "blue" | "b" | "diffuse_blue" => 2,
        "alpha" | "a" | "diffuse_alpha" => 3,
        _ => return None,
    })
}

/// Returns the use of the property `name` of an element.
pub(super) fn role(element: &str, name: &str, data_type: &PropertyType) -> std::result::Result<Role, String> {
    let is_list = matches!(data_type, PropertyType::List(..));
    let slot = match (element, name) {
        ("face" | "tristrips", "vertex_indices" | "vertex_index") if is_list => return Ok(Role::Corners),
        ("face" | "tristrips", "texcoord") if is_list => return Ok(Role::Uvs),
        ("face", "texnumber") if !is_list => return Ok(Role::Texture),
        ("face" | "tristrips", "vertex_indices" | "vertex_index" | "texcoord") => {
            return Err(format!("property {name} must be a list; re-export the mesh"));
        }
        ("vertex", name) => vertex_slot(name),
        ("face", name) => color_slot(name).map(|slot| slot::COLOR + slot),
        _ => None,
    };
    Ok(slot.filter(|_| !is_list).map_or(Role::Ignored, Role::Slot))
}

/// The encoding of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColorCode {
    /// Integers: sRGB-encoded.
    Encoded,
    /// Floats: linear.
    Linear,
}

/// The attributes declared by the header.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Attributes {
    /// `true` if x, y and z exist.
    pub positions: bool,
    /// A normal per vertex.
    pub normals: bool,
    /// A uv per vertex.
    pub uvs: bool,
    /// A colour per vertex.
    pub colors: Option<ColorCode>,
    /// A colour per face.
    pub face_colors: Option<ColorCode>,
    /// A texture number per face.
    pub face_textures: bool,
}

impl Attributes {
    /// Reads the declarations.
    pub fn of(header: &Header) -> Self {
        let slots = |name: &str| header.elements.get(name).map(declared).unwrap_or_default();
        let (vertex, face) = (slots("vertex"), slots("face"));
        let has = |slots: std::ops::Range<usize>| slots.into_iter().all(|s| vertex[s].is_some());
        Self {
            positions: has(slot::POSITION..slot::NORMAL),
            normals: has(slot::NORMAL..slot::UV),
            uvs: has(slot::UV..slot::COLOR),
            colors: color_code(&vertex),
            face_colors: color_code(&face),
            face_textures: header.elements.get("face").is_some_and(names_textures),
        }
    }
}

/// Returns true if each face has the number of its texture.
fn names_textures(element: &ElementDef) -> bool {
    let of = |name: &str, property: &PropertyType| role(&element.name, name, property);
    element.properties.iter().any(|(name, property)| of(name, &property.data_type) == Ok(Role::Texture))
}

/// The declaration of each slot: `None` if absent, else its colour encoding.
type Declared = [Option<ColorCode>; slot::COUNT];

fn declared(element: &ElementDef) -> Declared {
    let mut declared = Declared::default();
    for (name, property) in &element.properties {
        if let Ok(Role::Slot(slot)) = role(&element.name, name, &property.data_type) {
            let float = matches!(&property.data_type, PropertyType::Scalar(s) if is_float(s));
            declared[slot] = Some(if float { ColorCode::Linear } else { ColorCode::Encoded });
        }
    }
    declared
}

fn color_code(declared: &Declared) -> Option<ColorCode> {
    let rgb = &declared[slot::COLOR..slot::COLOR + 3];
    let linear = rgb.contains(&Some(ColorCode::Linear));
    rgb.iter().all(Option::is_some).then_some(if linear { ColorCode::Linear } else { ColorCode::Encoded })
}

/// Returns `true` for floating-point types.
pub(super) fn is_float(scalar: &ScalarType) -> bool {
    matches!(scalar, ScalarType::Float | ScalarType::Double)
}

/// Returns the number that represents full intensity in a colour.
pub(super) fn full_intensity(scalar: &ScalarType) -> f64 {
    match scalar {
        ScalarType::Char => 127.0,
        ScalarType::Short => 32767.0,
        ScalarType::UShort => 65535.0,
        ScalarType::UChar | ScalarType::Int | ScalarType::UInt => 255.0,
        ScalarType::Float | ScalarType::Double => 1.0,
    }
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
