//! Builds a mesh from vertices and faces.

use super::faces::{Block, FaceElement, Wanted};
use super::names::Attributes;
use super::payload::Element;
use super::split::Splitter;
use super::vertices::{Decoder, Vertices, upright};
use crate::error::{Error, Result, Warnings};
use crate::math::Vec3;
use crate::mesh::{Mesh, MeshData, first};
use crate::parallel;
use std::path::Path;

/// The drawable elements.
#[derive(Default)]
pub(super) struct Elements<'a> {
    /// The attributes of the elements.
    pub attributes: Attributes,
    /// The vertices, if any.
    pub vertices: Option<Element<'a>>,
    /// Polygons and strips.
    pub faces: Vec<FaceElement<'a>>,
}

/// Builds the mesh. Vertices are split if faces give them different uvs or colours.
pub(super) fn build(path: &Path, elements: &Elements, warnings: &mut Warnings) -> Result<Mesh> {
    let vertices = read_vertices(path, elements)?;
    let attributes = &elements.attributes;
    let with_uvs: usize = elements.faces.iter().filter(|f| !f.strips).map(|f| f.rows.with_uvs).sum();
    let lack_normals = vertices.lack_normals();
    let wanted = Wanted {
        positions: &vertices.positions,
        lack_normals: &lack_normals,
        uvs: with_uvs > 0,
        colors: attributes.colors.is_none() && attributes.face_colors.is_some(),
    };
    let mut gathered = Gathered::new(path, &wanted);
    for element in &elements.faces {
        if let Some(block) = element.triangles(&wanted) {
            gathered.take(block)?;
            continue;
        }
        gathered.triangles.reserve(element.rows.corners.saturating_sub(2 * element.rows.count));
        element
            .rows
            .blocks(|rows| Block::read(rows, element.strips, &wanted), |block| gathered.take(block))?;
    }
    gathered.finish(with_uvs, vertices.positions.len(), warnings)?;
    let Gathered { triangles, splitter, without_normal, .. } = gathered;
    let mut data = match splitter {
        Some(splitter) => split(vertices, splitter, attributes),
        None => plain(vertices),
    };
    if without_normal > 0 {
        data.normals.clear();
    }
    data.triangles = triangles;
    let mesh = Mesh::new(data)?;
    warnings.note("triangles without area", mesh.degenerate_triangles());
    Ok(mesh)
}

fn read_vertices(path: &Path, elements: &Elements) -> Result<Vertices> {
    let whole = |what: &str| Err(Error::parse(path, "whole file", what));
    let Some(rows) = elements.vertices.as_ref().filter(|rows| rows.count > 0) else {
        return whole("no vertices; re-export the mesh");
    };
    if !elements.attributes.positions {
        return whole("the vertices lack x, y or z; re-export the mesh");
    }
    if elements.faces.iter().all(|faces| faces.rows.count == 0) {
        return Err(cloud(path, rows.count));
    }
    let vertices = Vertices::read(rows, &elements.attributes)?;
    match first(&vertices.positions, |p| !p.is_finite()) {
        Some(i) => {
            Err(Error::parse(path, format!("vertex {i}"), "the position is infinite or NaN; fix the file"))
        }
        None => Ok(vertices),
    }
}

fn cloud(path: &Path, points: usize) -> Error {
    let what =
        format!("point cloud ({points} points, no faces); reconstruct its surface first, e.g. in MeshLab");
    Error::parse(path, "whole file", what)
}

/// The combined content of the blocks of faces.
struct Gathered<'a> {
    path: &'a Path,
    triangles: Vec<[u32; 3]>,
    splitter: Option<Splitter>,
    faces: usize,
    too_few: usize,
    crossing: usize,
    without_normal: usize,
}

impl<'a> Gathered<'a> {
    fn new(path: &'a Path, wanted: &Wanted) -> Self {
        Self {
            path,
            triangles: Vec::new(),
            splitter: wanted.splits().then(|| Splitter::new(wanted)),
            faces: 0,
            too_few: 0,
            crossing: 0,
            without_normal: 0,
        }
    }

    fn take(&mut self, mut block: Block) -> Result<()> {
        if let Some((face, what)) = block.error {
            return Err(Error::parse(self.path, format!("face {}", self.faces + face), what));
        }
        match &mut self.splitter {
            None if self.triangles.capacity() == 0 => self.triangles = block.triangles,
            None => self.triangles.append(&mut block.triangles),
            Some(splitter) => {
                let triangles = block.triangles.iter();
                self.triangles.extend(triangles.map(|t| t.map(|i| splitter.index(&block, i as usize))));
            }
        }
        self.faces += block.faces;
        self.too_few += block.too_few;
        self.crossing += block.crossing;
        self.without_normal += block.without_normal;
        Ok(())
    }

    fn finish(&self, with_uvs: usize, points: usize, warnings: &mut Warnings) -> Result<()> {
        if self.faces == 0 {
            return Err(cloud(self.path, points));
        }
        let lacking = if with_uvs > 0 { self.faces - with_uvs } else { 0 };
        warnings.note("faces without uvs among faces with uvs", lacking);
        let normals = "corners with zero or NaN normals; dropped all normals";
        warnings.note(normals, self.without_normal);
        warnings.note("skipped faces with fewer than three corners", self.too_few);
        warnings.note("self-intersecting polygons, triangulated approximately", self.crossing);
        if self.triangles.is_empty() {
            let what = "no faces with three or more corners; export triangles";
            return Err(Error::parse(self.path, "whole file", what));
        }
        Ok(())
    }
}

/// Returns the vertices unsplit, with unit normals.
fn plain(vertices: Vertices) -> MeshData {
    let Vertices { positions, mut normals, uvs, colors } = vertices;
    parallel::change(&mut normals, |_, n| *n = unit(*n));
    let uvs = if uvs.is_empty() { Vec::new() } else { vec![uvs] };
    MeshData { positions, normals, uvs, colors, ..MeshData::default() }
}

/// Returns the vertices as split by faces.
fn split(vertices: Vertices, splitter: Splitter, attributes: &Attributes) -> MeshData {
    fn gather<T: Copy>(from: &[T], splitter: &Splitter) -> Vec<T> {
        if from.is_empty() { Vec::new() } else { splitter.vertices().map(|v| from[v]).collect() }
    }
    let mut data = plain(Vertices {
        positions: gather(&vertices.positions, &splitter),
        normals: gather(&vertices.normals, &splitter),
        uvs: gather(&vertices.uvs, &splitter),
        colors: gather(&vertices.colors, &splitter),
    });
    if splitter.uvs {
        data.uvs = vec![splitter.own_uvs().map(|[u, v]| upright(u, v)).collect()];
    }
    if let Some(code) = attributes.face_colors.filter(|_| splitter.colors) {
        let decoder = Decoder::new(code);
        data.colors = splitter.own_colors().map(|color| decoder.linear(color)).collect();
    }
    data
}

fn unit(normal: Vec3) -> Vec3 {
    normal.to_f64().normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_f32()
}
