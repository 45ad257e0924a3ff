//! STL: loose triangles, ascii or binary, welded where positions are equal to the bit.

use super::file;
use super::obj::neutral;
use super::{Loaded, text};
use crate::error::{Error, Result, Warnings};
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, MeshData};
use crate::scene::{Instance, Scene};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::Path;

/// Bytes before the first triangle of a binary file: a header of 80 and a count.
const BINARY_START: usize = 84;
/// Bytes of a triangle in a binary file.
const BINARY_TRIANGLE: usize = 50;

/// Reads an STL file into one mesh without normals, since those of the file are the triangles' own.
///
/// All solids of an ascii file are taken together. A file is binary where its length is what its count demands,
/// whatever it starts with; else it is ascii where it starts with `solid`.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read, [`Error::Parse`] naming the first triangle that cannot be used, or
/// where there is none.
pub(super) fn read(path: &Path) -> Result<Loaded> {
    let bytes = file::read(path)?;
    let mut warnings = Warnings::default();
    let mut welder = Welder { path, data: MeshData::default(), welded: HashMap::new() };
    if is_ascii(&bytes) {
        welder.ascii(text::decode(bytes))?;
    } else {
        welder.binary(bytes, &mut warnings)?;
    }
    if welder.data.triangles.is_empty() {
        return Err(Error::parse(path, "whole file", "no triangles; export the model again"));
    }
    let mesh = Mesh::new(welder.data)?;
    warnings.note("triangles without area", mesh.degenerate_triangles());
    let scene = Scene {
        meshes: vec![mesh],
        materials: vec![neutral("")],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..Scene::default()
    };
    Ok(Loaded::new(scene, warnings, "STL"))
}

fn is_ascii(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let says_solid = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    says_solid && declared(bytes).is_none_or(|count| BINARY_START + count * BINARY_TRIANGLE != bytes.len())
}

/// The triangle count of a binary file.
fn declared(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..BINARY_START)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize)
}

struct Welder<'a> {
    path: &'a Path,
    data: MeshData,
    welded: HashMap<[u32; 3], u32>,
}

impl Welder<'_> {
    fn binary(&mut self, mut bytes: Vec<u8>, warnings: &mut Warnings) -> Result<()> {
        let Some(count) = declared(&bytes) else {
            let what = format!("{} bytes are too few for an STL file", bytes.len());
            return Err(Error::parse(self.path, "header", what));
        };
        let there = (bytes.len() - BINARY_START) / BINARY_TRIANGLE;
        if there < count {
            let what =
                format!("{count} triangles are declared, but the file ends after {there}; it is cut short");
            return Err(Error::parse(self.path, "header", what));
        }
        let more = bytes.len() - BINARY_START - count * BINARY_TRIANGLE;
        warnings.note("bytes behind the last triangle", more);
        // `stl_io` takes a header that starts with this word for ascii.
        bytes[..80].fill(0);
        self.take(Cursor::new(bytes.as_slice()), "triangle")
    }

    /// `stl_io` reads one solid and its key words in small letters.
    fn ascii(&mut self, text: String) -> Result<()> {
        let text = text.to_ascii_lowercase();
        let mut solids = 0;
        let mut rest = text.trim_start();
        while rest.starts_with("solid") {
            let line = rest.find('\n').unwrap_or(rest.len());
            let end =
                rest.match_indices("endsolid").map(|(i, _)| i).find(|i| *i > line).unwrap_or(rest.len());
            let mut solid = String::from("solid \n");
            solid.push_str(rest[line..end].trim());
            solid.push_str(if end < rest.len() { "\nendsolid\n" } else { "\n" });
            solids += 1;
            self.take(Cursor::new(solid.as_bytes()), &format!("solid {solids}, triangle"))?;
            let after = &rest[end..];
            rest = after[after.find('\n').unwrap_or(after.len())..].trim_start();
        }
        if rest.is_empty() {
            return Ok(());
        }
        let at = format!("behind solid {solids}");
        Err(Error::parse(self.path, at, format!("{} is no solid; mend the file", text::quote(rest))))
    }

    fn take(&mut self, mut source: Cursor<&[u8]>, at: &str) -> Result<()> {
        let refuse = |path: &Path, i: usize, what: String| Err(Error::parse(path, format!("{at} {i}"), what));
        let triangles = stl_io::create_stl_reader(&mut source)
            .map_err(|e| Error::parse(self.path, "header", one_line(&e)))?;
        for (i, triangle) in triangles.enumerate() {
            let corners = match triangle {
                Ok(triangle) => triangle.vertices.map(|v| Vec3::from_array(v.0)),
                Err(e) => return refuse(self.path, i, one_line(&e)),
            };
            if !corners.iter().all(|p| p.is_finite()) {
                return refuse(self.path, i, "a position is infinite or NaN; mend the file".to_owned());
            }
            let indices = corners.map(|p| self.vertex(p));
            self.data.triangles.push(indices);
        }
        Ok(())
    }

    fn vertex(&mut self, p: Vec3) -> u32 {
        let next = self.data.positions.len() as u32;
        // Adding zero makes −0 equal to 0.
        let index = *self.welded.entry((p + Vec3::splat(0.0)).to_array().map(f32::to_bits)).or_insert(next);
        if index == next {
            self.data.positions.push(p);
        }
        index
    }
}

fn one_line(error: &std::io::Error) -> String {
    let text = error.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().filter(|c| !c.is_control()).take(160).collect()
}
