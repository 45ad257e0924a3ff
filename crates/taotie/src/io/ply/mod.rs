//! PLY: polygons with arbitrary properties, ASCII or binary.
//!
//! Headers are read by `ply-rs-bw`. Its payloads are one object per row, which is too much for a scan with millions
//! of rows, and its ASCII is stricter than real exporters; so payloads are read here, in blocks and, if rows allow
//! it, in parallel.

mod ascii;
mod build;
mod faces;
mod header;
mod names;
mod payload;
mod split;
mod texture;
mod vertices;

use super::file;
use super::loaded::{Loaded, checked};
use super::obj::neutral;
use super::reading::Reading;
use crate::error::{Result, Warnings};
use crate::math::Mat4;
use crate::scene::{Instance, Scene, SceneData};
use ascii::Tokens;
use build::Elements;
use faces::FaceElement;
use header::read_header;
use names::Attributes;
use payload::Element;
use ply_rs_bw::ply::{Encoding, Header};
use std::path::Path;

/// Reads a PLY file into one mesh.
///
/// Colours stored as integers are taken as sRGB-encoded, colours stored as floats as linear. Uvs come from vertices
/// (`s t`, `u v`, `texture_u texture_v`) or from a `texcoord` list per face, with the origin bottom left; a `comment
/// TextureFile` specifies the base colour texture. Normals are absent if the file has none, or if some are invalid.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, [`crate::Error::Parse`] if its header or payload is invalid, and
/// for point clouds, which cannot be drawn.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let mut warnings = Warnings::default();
    let mut bytes = file::read(path)?;
    let (header, start, line) = read_header(path, &mut bytes)?;
    let elements = locate(path, &header, &bytes[start..], line)?;
    let mesh = build::build(path, &elements, &mut warnings)?;
    let mut material = neutral("");
    if !mesh.colors().is_empty() {
        material.base_color = [1.0; 4];
    }
    let has_uvs = !mesh.uvs().is_empty();
    let instance = Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY };
    let mut parts = SceneData { meshes: vec![mesh], instances: vec![instance], ..SceneData::default() };
    let mut loaded = Loaded::new(Scene::default(), warnings, "PLY");
    if has_uvs
        && let Some(name) = texture::name(&header, &mut loaded.warnings)
        && let Some(texture) = texture::load(reading, name, &mut loaded)
    {
        material.base_color = [1.0; 4];
        material.base_color_texture = Some(texture::whole());
        parts.textures.push(texture);
    }
    parts.materials.push(material);
    loaded.scene = checked(path, parts)?;
    Ok(loaded)
}

/// Locates the drawable elements; the others are skipped.
fn locate<'a>(path: &Path, header: &Header, payload: &'a [u8], line: usize) -> Result<Elements<'a>> {
    let mut elements = Elements { attributes: Attributes::of(header), ..Elements::default() };
    let mut tokens = Tokens::new(path, payload, line);
    let mut rest = payload;
    for (_, definition) in header.elements.iter().filter(|(_, e)| !e.properties.is_empty()) {
        let rows = if header.encoding == Encoding::Ascii {
            Element::ascii(path, definition, &mut tokens)?
        } else {
            let big_endian = header.encoding == Encoding::BinaryBigEndian;
            let (rows, length) = Element::binary(path, definition, rest, big_endian)?;
            rest = &rest[length..];
            rows
        };
        match definition.name.as_str() {
            "vertex" => elements.vertices = Some(rows),
            "face" => elements.faces.push(FaceElement { rows, strips: false }),
            "tristrips" => elements.faces.push(FaceElement { rows, strips: true }),
            _ => {}
        }
    }
    Ok(elements)
}
