//! PLY: polygons with any properties, ascii or binary.
//!
//! Headers and binary payloads are read by `ply-rs-bw`; see `ascii` for why ascii payloads are not.

mod ascii;
mod build;
mod rows;

use super::Loaded;
use super::file;
use super::locate;
use super::obj::neutral;
use super::read_bitmap;
use crate::error::{Error, Result, Warnings};
use crate::image::{Encoding, Sampler, Texture};
use crate::math::Mat4;
use crate::scene::{Instance, Scene, TextureRef, UvTransform};
use build::Attributes;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding as Format, Header, PropertyAccess, PropertyType, ScalarType};
use rows::{FaceRow, Ignored, VertexRow};
use std::io::Cursor;
use std::path::Path;

/// The longest header that is looked at.
const MAX_HEADER: usize = 1 << 20;

/// Reads a PLY file into one mesh.
///
/// Colours stored as whole numbers are taken as sRGB-encoded, colours stored as floats as linear. Uvs come from
/// vertices (`s t`, `u v`, `texture_u texture_v`) or from a `texcoord` list at each face, with the origin bottom left;
/// a `comment TextureFile` names the base colour texture. Normals are absent where the file has none, or has some
/// that are no directions.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read, [`Error::Parse`] where its header or payload is wrong, and for point
/// clouds, which cannot be drawn.
pub(super) fn read(path: &Path) -> Result<Loaded> {
    let mut warnings = Warnings::default();
    let table = Table::read(path, file::read(path)?)?;
    let mesh = build::build(path, &table.attributes, table.vertices, &table.faces, &mut warnings)?;
    let mut material = neutral("");
    if !mesh.colors().is_empty() {
        material.base_color = [1.0; 4];
    }
    let has_uvs = !mesh.uvs().is_empty();
    let instance = Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY };
    let scene = Scene { meshes: vec![mesh], instances: vec![instance], ..Scene::default() };
    let mut loaded = Loaded::new(scene, warnings, "PLY");
    if has_uvs && let Some(name) = texture_name(&table.header, &mut loaded.warnings) {
        material.base_color_texture = load_texture(path, name, &mut loaded);
        if material.base_color_texture.is_some() {
            material.base_color = [1.0; 4];
        }
    }
    loaded.scene.materials.push(material);
    Ok(loaded)
}

/// What the file holds that can be drawn.
struct Table {
    header: Header,
    attributes: Attributes,
    vertices: Vec<VertexRow>,
    faces: Vec<FaceRow>,
}

impl Table {
    fn read(path: &Path, mut bytes: Vec<u8>) -> Result<Self> {
        mend_header(&mut bytes);
        let length = bytes.len();
        let mut reader = Reader::new(Cursor::new(bytes));
        let header = Parser::<Ignored>::new().read_header(&mut reader).map_err(|e| parse_error(path, &e))?;
        let start = reader.get_ref().position() as usize;
        let mut table = Self {
            attributes: Attributes::of(&header),
            header: Header { comments: header.comments.clone(), ..Header::default() },
            vertices: Vec::new(),
            faces: Vec::new(),
        };
        if header.encoding == Format::Ascii {
            let line = reader.line();
            let payload = reader.into_inner().into_inner();
            let mut tokens = ascii::Tokens::new(path, &payload[start..], line);
            for (_, element) in &header.elements {
                table.take(element, &mut |rows| rows.ascii(&mut tokens, element))?;
            }
        } else {
            for (_, element) in &header.elements {
                let left = length.saturating_sub(reader.get_ref().position() as usize);
                check_length(path, element, left)?;
                table.take(element, &mut |rows| rows.binary(path, &mut reader, element, &header))?;
            }
        }
        Ok(table)
    }

    fn take(&mut self, element: &ElementDef, read: &mut dyn FnMut(&mut Rows) -> Result<()>) -> Result<()> {
        if element.properties.is_empty() {
            return Ok(());
        }
        let mut rows = match element.name.as_str() {
            "vertex" => Rows::Vertices(Vec::new()),
            "face" => Rows::Faces(Vec::new()),
            "tristrips" => Rows::Strips(Vec::new()),
            _ => Rows::Ignored(Vec::new()),
        };
        read(&mut rows)?;
        match rows {
            Rows::Vertices(vertices) => self.vertices = vertices,
            Rows::Faces(mut faces) => self.faces.append(&mut faces),
            Rows::Strips(strips) => self.faces.extend(strips.iter().flat_map(FaceRow::strip_triangles)),
            Rows::Ignored(_) => {}
        }
        Ok(())
    }
}

enum Rows {
    Vertices(Vec<VertexRow>),
    Faces(Vec<FaceRow>),
    Strips(Vec<FaceRow>),
    Ignored(Vec<Ignored>),
}

impl Rows {
    fn ascii(&mut self, tokens: &mut ascii::Tokens, element: &ElementDef) -> Result<()> {
        match self {
            Self::Vertices(rows) => tokens.rows(element, rows),
            Self::Faces(rows) | Self::Strips(rows) => tokens.rows(element, rows),
            Self::Ignored(rows) => tokens.rows(element, rows),
        }
    }

    fn binary(
        &mut self,
        path: &Path,
        reader: &mut Reader<Cursor<Vec<u8>>>,
        element: &ElementDef,
        header: &Header,
    ) -> Result<()> {
        match self {
            Self::Vertices(rows) => *rows = binary_rows(path, reader, element, header)?,
            Self::Faces(rows) | Self::Strips(rows) => *rows = binary_rows(path, reader, element, header)?,
            Self::Ignored(rows) => *rows = binary_rows(path, reader, element, header)?,
        }
        Ok(())
    }
}

fn binary_rows<E: PropertyAccess>(
    path: &Path,
    reader: &mut Reader<Cursor<Vec<u8>>>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>> {
    let rows = Parser::<E>::new().read_payload_for_element(reader, element, header);
    rows.map_err(|e| Error::parse(path, format!("element {}", element.name), one_line(&e)))
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

/// Refuses a count that the rest of the file is too short for, before anything is allocated.
fn check_length(path: &Path, element: &ElementDef, left: usize) -> Result<()> {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let least = |property: &PropertyType| match property {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
    };
    let row: usize = element.properties.iter().map(|(_, p)| least(&p.data_type)).sum();
    if element.count.saturating_mul(row) <= left {
        return Ok(());
    }
    let what = format!(
        "{} of at least {row} bytes each, but only {left} bytes follow; the file is cut short or damaged",
        element.count
    );
    Err(Error::parse(path, format!("element {}", element.name), what))
}

fn parse_error(path: &Path, error: &ParseError) -> Error {
    let at = error.line().map_or("header".to_owned(), |line| format!("line {line}"));
    Error::parse(path, at, one_line(error))
}

/// The parser's message, which may span lines and hold a whole line of the file, in one short line.
fn one_line(error: &ParseError) -> String {
    let text = error.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().filter(|c| !c.is_control()).take(200).collect()
}

fn texture_name<'a>(header: &'a Header, warnings: &mut Warnings) -> Option<&'a str> {
    let mut names = header.comments.iter().filter_map(|c| c.trim().strip_prefix("TextureFile"));
    let first = names.next()?.trim();
    warnings.note("texture files beyond the first are not used", names.count());
    Some(first)
}

fn load_texture(path: &Path, name: &str, loaded: &mut Loaded) -> Option<TextureRef> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let Some(file) = locate::find(name, &[folder]) else {
        loaded.warnings.note(format!("texture '{name}' is left out: it is not there"), 1);
        loaded.missing_files.push(name.to_owned());
        return None;
    };
    match read_bitmap(&file) {
        Ok(bitmap) => {
            loaded.scene.textures.push(Texture::new(bitmap, Encoding::Srgb));
            loaded.texture_names.push(name.to_owned());
            let (sampler, transform) = (Sampler::default(), UvTransform::default());
            Some(TextureRef { texture: 0, uv_set: 0, sampler, transform })
        }
        Err(error) => {
            loaded.warnings.note(format!("texture '{name}' is left out: {error}"), 1);
            None
        }
    }
}
