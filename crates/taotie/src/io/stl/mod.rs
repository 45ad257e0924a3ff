//! STL: separate triangles, ASCII or binary, welded if positions are bitwise equal.

mod facets;
mod solids;

use super::loaded::{Loaded, checked};
use super::obj::neutral;
use super::reading::Reading;
use super::text;
use crate::error::{Error, Result, Warnings};
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, MeshData, first};
use crate::parallel;
use crate::scene::{Instance, SceneData};
use crate::surface::{Classes, bits};
use solids::not_finite;
use std::path::Path;

/// Bytes before the first triangle of a binary file: an 80-byte header and a count.
const BINARY_START: usize = 84;
/// Bytes per triangle in a binary file.
const BINARY_TRIANGLE: usize = 50;
/// Bytes needed per byte of a binary file, as if no triangles shared corners: only reading them would show that.
const BINARY_MADE: u64 = 4;
/// The same for an ASCII file, whose shortest triangles have ninety bytes.
const ASCII_MADE: u64 = 3;

/// Reads an STL file into one mesh without normals, since those in the file are per triangle.
///
/// All solids of an ASCII file are combined. A file is binary if its length matches its triangle count, whatever it
/// starts with; otherwise it is ASCII if it starts with `solid`.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Limit`] if it does not fit in memory, [`Error::Parse`] with the
/// first unusable triangle, or if there are no triangles.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let bytes = reading.read_own(path)?;
    let is_ascii = is_ascii(&bytes);
    reading.count_file(path, if is_ascii { ASCII_MADE } else { BINARY_MADE })?;
    let mut warnings = Warnings::default();
    let data = if is_ascii {
        let corners = ascii(path, &text::decode(bytes))?;
        welded(corners.len(), |c| corners[c])
    } else {
        binary(path, &bytes, &mut warnings)?
    };
    if data.triangles.is_empty() {
        return Err(Error::parse(path, "whole file", "no triangles; re-export the model"));
    }
    let mesh = Mesh::new(data)?;
    warnings.note("triangles without area", mesh.degenerate_triangles());
    let scene = SceneData {
        meshes: vec![mesh],
        materials: vec![neutral("")],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    };
    Ok(Loaded::new(checked(path, scene)?, warnings, "STL"))
}

fn is_ascii(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let says_solid = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    says_solid && declared(bytes).is_none_or(|count| BINARY_START + count * BINARY_TRIANGLE != bytes.len())
}

/// Returns the triangle count of a binary file.
fn declared(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..BINARY_START)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize)
}

/// Returns the mesh of a binary file.
fn binary(path: &Path, bytes: &[u8], warnings: &mut Warnings) -> Result<MeshData> {
    let Some(count) = declared(bytes) else {
        let what = format!("{} bytes are too few for an STL file", bytes.len());
        return Err(Error::parse(path, "header", what));
    };
    let (there, _) = bytes[BINARY_START..].as_chunks::<BINARY_TRIANGLE>();
    let Some(triangles) = there.get(..count) else {
        let there = there.len();
        let what = format!("{count} triangles declared, but the file ends after {there}; it is truncated");
        return Err(Error::parse(path, "header", what));
    };
    warnings
        .note("bytes after the last triangle", bytes.len() - BINARY_START - triangles.as_flattened().len());
    let is_bad = |t: &[u8; BINARY_TRIANGLE]| (0..3).any(|corner| !stored_corner(t, corner).is_finite());
    match first(triangles, is_bad) {
        Some(i) => Err(not_finite(path, format!("triangle {i}"))),
        None => Ok(welded(3 * count, |c| stored_corner(&triangles[c / 3], c % 3))),
    }
}

/// Returns a corner of a triangle in a binary file; the normal precedes the first.
fn stored_corner(triangle: &[u8; BINARY_TRIANGLE], corner: usize) -> Vec3 {
    let (words, _) = triangle[12 * (corner + 1)..].as_chunks::<4>();
    Vec3::new(f32::from_le_bytes(words[0]), f32::from_le_bytes(words[1]), f32::from_le_bytes(words[2]))
}

/// Returns the corners of all triangles of an ASCII file.
fn ascii(path: &Path, text: &str) -> Result<Vec<Vec3>> {
    match facets::read(text) {
        Some(corners) => Ok(corners),
        None => solids::read(path, text),
    }
}

/// Welds triangle corners at equal positions into one vertex.
fn welded(corners: usize, corner: impl Fn(usize) -> Vec3 + Sync) -> MeshData {
    let places = Classes::by(corners, |c| bits(corner(c).to_array()));
    MeshData {
        positions: parallel::collect(places.firsts.len(), |i| corner(places.firsts[i] as usize)),
        triangles: places.of.as_chunks::<3>().0.to_vec(),
        ..MeshData::default()
    }
}
