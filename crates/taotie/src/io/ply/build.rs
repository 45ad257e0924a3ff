//! PLY rows into a mesh.

use super::super::polygon::{Cutter, Outline};
use super::rows::{FaceRow, VertexRow, color_slot, slot, vertex_slot};
use crate::error::{Error, Result, Warnings};
use crate::math::srgb::linear_from_srgb;
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, MeshData};
use ply_rs_bw::ply::{Header, PropertyType, ScalarType};
use std::collections::HashMap;
use std::path::Path;

/// Which attributes the header declares.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Attributes {
    /// x, y and z are there.
    positions: bool,
    /// A normal at each vertex.
    normals: bool,
    /// A uv at each vertex.
    uvs: bool,
    /// A colour at each vertex.
    colors: Option<ColorCode>,
    /// A colour at each face.
    face_colors: Option<ColorCode>,
}

/// What colour numbers mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ColorCode {
    /// Whole numbers: sRGB-encoded.
    Encoded,
    /// Floats: linear.
    Linear,
}

impl Attributes {
    /// Reads the declarations.
    pub(super) fn of(header: &Header) -> Self {
        let mut found = Self::default();
        if let Some(vertex) = header.elements.get("vertex") {
            let has = |slots: std::ops::Range<usize>| {
                slots.into_iter().all(|s| vertex.properties.iter().any(|(n, _)| vertex_slot(n) == Some(s)))
            };
            found.positions = has(slot::POSITION..slot::NORMAL);
            found.normals = has(slot::NORMAL..slot::UV);
            found.uvs = has(slot::UV..slot::COLOR);
            let types = vertex.properties.iter().map(|(name, p)| (name.as_str(), &p.data_type));
            found.colors = color_code(types);
        }
        if let Some(face) = header.elements.get("face") {
            found.face_colors = color_code(face.properties.iter().map(|(n, p)| (n.as_str(), &p.data_type)));
        }
        found
    }
}

fn color_code<'a>(properties: impl Iterator<Item = (&'a str, &'a PropertyType)>) -> Option<ColorCode> {
    let mut seen = [false; 3];
    let mut code = ColorCode::Encoded;
    for (name, data_type) in properties {
        if let Some(slot @ 0..3) = color_slot(name) {
            seen[slot] = true;
            if matches!(data_type, PropertyType::Scalar(ScalarType::Float | ScalarType::Double)) {
                code = ColorCode::Linear;
            }
        }
    }
    (seen == [true; 3]).then_some(code)
}

/// Makes the mesh. Vertices are split where faces give them different uvs or colours of their own.
pub(super) fn build(
    path: &Path,
    attributes: &Attributes,
    vertices: Vec<VertexRow>,
    faces: &[FaceRow],
    warnings: &mut Warnings,
) -> Result<Mesh> {
    check(path, attributes, &vertices, faces)?;
    let mut builder = Builder::new(attributes, vertices, faces, warnings);
    let mut cutter = Cutter::default();
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (i, face) in faces.iter().enumerate() {
        if face.corners.len() < 3 {
            warnings.note("faces of fewer than three corners are left out", 1);
            continue;
        }
        check_corners(path, i, face, builder.vertices.len())?;
        points.clear();
        points.extend(face.corners.iter().map(|c| position(&builder.vertices[*c as usize])));
        triangles.clear();
        if cutter.cut(&points, &mut triangles) == Outline::Crossing {
            warnings.note("polygons that cross themselves are drawn only roughly", 1);
        }
        builder.add(face, &triangles);
    }
    builder.finish(path, warnings)
}

fn check(path: &Path, attributes: &Attributes, vertices: &[VertexRow], faces: &[FaceRow]) -> Result<()> {
    let whole = |what: String| Err(Error::parse(path, "whole file", what));
    if vertices.is_empty() {
        return whole("no vertices; export the mesh again".to_owned());
    }
    if !attributes.positions {
        return whole("the vertices lack x, y or z; export the mesh again".to_owned());
    }
    if faces.is_empty() {
        return whole(format!(
            "a cloud of {} points without faces; reconstruct its surface first, for instance in MeshLab",
            vertices.len()
        ));
    }
    match vertices.iter().position(|v| !position(v).is_finite()) {
        Some(i) => {
            Err(Error::parse(path, format!("vertex {i}"), "its position is infinite or NaN; mend the file"))
        }
        None => Ok(()),
    }
}

fn check_corners(path: &Path, i: usize, face: &FaceRow, count: usize) -> Result<()> {
    let error = |what| Err(Error::parse(path, format!("face {i}"), what));
    if face.corners.len() > Cutter::MAX_CORNERS {
        return error(format!("{} corners; at most {}", face.corners.len(), Cutter::MAX_CORNERS));
    }
    match face.corners.iter().find(|c| **c as usize >= count) {
        Some(&u32::MAX) => error("a negative vertex index; mend the file".to_owned()),
        Some(c) => error(format!("vertex index {c} is out of range, there are {count}; mend the file")),
        None => Ok(()),
    }
}

fn position(vertex: &VertexRow) -> Vec3 {
    let [x, y, z, ..] = vertex.values;
    Vec3::new(x, y, z)
}

/// The vertex a corner has in the file, and the bits of what its face says of it.
type Corner = [u32; 7];

struct Builder {
    vertices: Vec<VertexRow>,
    code: Option<ColorCode>,
    has_normals: bool,
    has_uvs: bool,
    wedge_uvs: bool,
    face_colors: bool,
    welded: HashMap<Corner, u32>,
    data: MeshData,
}

impl Builder {
    fn new(
        attributes: &Attributes,
        vertices: Vec<VertexRow>,
        faces: &[FaceRow],
        warnings: &mut Warnings,
    ) -> Self {
        let with_uvs = |f: &&FaceRow| f.uvs.len() == 2 * f.corners.len() && !f.uvs.is_empty();
        let wedges = faces.iter().filter(with_uvs).count();
        if wedges > 0 {
            warnings.note("faces without uvs beside faces with them", faces.len() - wedges);
        }
        let face_colors = attributes.colors.is_none() && attributes.face_colors.is_some();
        Self {
            code: attributes.colors.or(attributes.face_colors),
            has_normals: attributes.normals && usable_normals(&vertices, faces, warnings),
            has_uvs: attributes.uvs || wedges > 0,
            wedge_uvs: wedges > 0,
            face_colors,
            welded: HashMap::new(),
            data: MeshData { uvs: vec![Vec::new()], ..MeshData::default() },
            vertices,
        }
    }

    fn add(&mut self, face: &FaceRow, triangles: &[[u32; 3]]) {
        for triangle in triangles {
            let triangle = if self.wedge_uvs || self.face_colors {
                triangle.map(|i| self.split(face, i as usize))
            } else {
                triangle.map(|i| face.corners[i as usize])
            };
            self.data.triangles.push(triangle);
        }
    }

    /// The index of the vertex for the corner `i` of a face that has uvs or a colour of its own.
    fn split(&mut self, face: &FaceRow, i: usize) -> u32 {
        let mut row = self.vertices[face.corners[i] as usize];
        if self.wedge_uvs {
            let uv = face.uvs.get(2 * i..2 * i + 2).unwrap_or(&[0.0; 2]);
            row.values[slot::UV..slot::COLOR].copy_from_slice(uv);
        }
        if self.face_colors {
            row.values[slot::COLOR..].copy_from_slice(&face.color);
        }
        let bits = |k: usize| row.values[slot::UV + k].to_bits();
        let key = [face.corners[i], bits(0), bits(1), bits(2), bits(3), bits(4), bits(5)];
        let next = self.data.positions.len() as u32;
        let index = *self.welded.entry(key).or_insert(next);
        if index == next {
            self.push(&row);
        }
        index
    }

    fn push(&mut self, row: &VertexRow) {
        let [x, y, z, nx, ny, nz, u, v, color @ ..] = row.values;
        self.data.positions.push(Vec3::new(x, y, z));
        if self.has_normals {
            let up = Vec3::new(0.0, 0.0, 1.0);
            self.data.normals.push(Vec3::new(nx, ny, nz).to_f64().normalize_or(up).to_f32());
        }
        if self.has_uvs {
            let usable = |v: f32| if v.is_finite() { v } else { 0.0 };
            self.data.uvs[0].push(Vec2::new(usable(u), 1.0 - usable(v)));
        }
        if let Some(code) = self.code {
            self.data.colors.push(linear(color, code));
        }
    }

    fn finish(mut self, path: &Path, warnings: &mut Warnings) -> Result<Mesh> {
        if self.data.triangles.is_empty() {
            return Err(Error::parse(
                path,
                "whole file",
                "no face of three corners or more; export triangles",
            ));
        }
        if !self.wedge_uvs && !self.face_colors {
            for row in std::mem::take(&mut self.vertices) {
                self.push(&row);
            }
        }
        if !self.has_uvs {
            self.data.uvs.clear();
        }
        let mesh = Mesh::new(self.data)?;
        warnings.note("triangles without area", mesh.degenerate_triangles());
        Ok(mesh)
    }
}

/// Whether every normal that a face uses is a direction; else none is kept.
fn usable_normals(vertices: &[VertexRow], faces: &[FaceRow], warnings: &mut Warnings) -> bool {
    let is_bad = |i: &u32| {
        vertices.get(*i as usize).is_some_and(|row| {
            let [.., nx, ny, nz] = row.values[..slot::UV] else { return true };
            let length = Vec3::new(nx, ny, nz).to_f64().length();
            !(length > 1e-18 && length.is_finite())
        })
    };
    let bad = faces.iter().flat_map(|f| &f.corners).filter(|i| is_bad(i)).count();
    warnings.note("corners whose normals are zero or NaN, so that all normals are left out", bad);
    bad == 0
}

fn linear(color: [f32; 4], code: ColorCode) -> [f32; 4] {
    let usable = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
    let [r, g, b, a] = color.map(usable);
    let decode = |v: f32| match code {
        ColorCode::Encoded => linear_from_srgb(f64::from(v)) as f32,
        ColorCode::Linear => v,
    };
    [decode(r), decode(g), decode(b), a.min(1.0)]
}
