//! The geometry of a primitive as stored: its vertex arrays, and its triangles from modes and indices.

use super::accessor::Accessor;
use super::document::Document;
use crate::reading::Reason;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use taotie_engine::error::Warnings;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{MeshData, first};
use taotie_engine::parallel;

/// Maximum number of uv sets read per mesh.
pub(super) const MAX_UV_SETS: u32 = 8;

/// Reads the attributes of one primitive, only for the vertices `used`.
pub(super) struct Vertices<'a> {
    document: &'a Document,
    /// The primitive being read.
    pub primitive: &'a Primitive,
    /// The number of vertices that the file has for the primitive.
    pub count: usize,
    positions: Accessor<'a>,
}

impl<'a> Vertices<'a> {
    /// Opens POSITION; returns `None` if the primitive has none.
    pub fn open(document: &'a Document, primitive: &'a Primitive) -> Reason<Option<Self>> {
        let Some(index) = attribute(primitive, Semantic::Positions) else { return Ok(None) };
        let positions = Accessor::open(document, index).map_err(|why| format!("POSITION: {why}"))?;
        if positions.width != 3 {
            return Err("POSITION must have 3 components".into());
        }
        if positions.count > u32::MAX as usize {
            return Err(format!("POSITION: {} vertices; the maximum is 2^32 - 1", positions.count));
        }
        if positions.is_implicit() && primitive_is_compressed(primitive) {
            return Err("POSITION: compressed by an unsupported extension".into());
        }
        Ok(Some(Self { document, primitive, count: positions.count, positions }))
    }

    /// Reads every attribute of the vertices `used`. Attributes other than POSITION that cannot be read are skipped,
    /// with a warning that starts with `place`.
    pub fn read(&self, used: &[u32], place: &str, warnings: &mut Warnings) -> MeshData {
        let mut optional = |semantic: Semantic| {
            let name = semantic.to_string();
            let index = attribute(self.primitive, semantic)?;
            self.open_optional(index)
                .map_err(|w| warnings.note(format!("{place}: skipped {name}: {w}"), 1))
                .ok()
        };
        let mut data = MeshData {
            positions: parallel::collect(used.len(), |i| vec3(&self.positions, used[i])),
            ..MeshData::default()
        };
        let mut wrong = (String::new(), 0);
        if let Some(normals) = optional(Semantic::Normals) {
            data.normals = parallel::collect(used.len(), |i| vec3(&normals, used[i]));
            if let Some(tangents) = optional(Semantic::Tangents) {
                data.tangents = parallel::collect(used.len(), |i| tangents.floats(used[i] as usize));
                let is_wrong = |[.., w]: &&[f32; 4]| (w.abs() - 1.0).abs() > 0.01;
                let what =
                    format!("{place}: tangents whose w is neither 1 nor -1; viewers show a wrong relief");
                wrong = (what, data.tangents.iter().filter(is_wrong).count());
            }
        }
        let sets = (0..MAX_UV_SETS).map(|set| optional(Semantic::TexCoords(set))).collect::<Vec<_>>();
        data.uvs = read_uvs(&sets, used);
        if let Some(colors) = optional(Semantic::Colors(0)) {
            data.colors = parallel::collect(used.len(), |i| color(&colors, used[i]));
        }
        let is_further = |semantic: &&Checked<Semantic>| match semantic {
            Checked::Valid(Semantic::TexCoords(set)) => *set >= MAX_UV_SETS,
            Checked::Valid(Semantic::Colors(set)) => *set > 0,
            _ => false,
        };
        let further = self.primitive.attributes.keys().filter(is_further).count();
        warnings.note("ignored uv sets beyond the first 8, and colour sets beyond the first", further);
        let (what, count) = wrong;
        warnings.note(what, count);
        data
    }

    /// Opens an accessor with one element per vertex.
    pub fn open_optional(&self, index: usize) -> Reason<Accessor<'a>> {
        let accessor = Accessor::open(self.document, index)?;
        if accessor.count == self.count {
            Ok(accessor)
        } else {
            Err(format!("{} elements for {} positions", accessor.count, self.count))
        }
    }
}

/// Returns the accessor index of an attribute.
pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|i| i.value())
}

fn primitive_is_compressed(primitive: &Primitive) -> bool {
    primitive.extensions.as_ref().is_some_and(|e| e.others.keys().any(|k| k.contains("compression")))
}

pub(super) fn vec3(accessor: &Accessor, i: u32) -> Vec3 {
    Vec3::from_array(accessor.floats(i as usize))
}

fn color(accessor: &Accessor, i: u32) -> [f32; 4] {
    let [r, g, b, a] = accessor.floats(i as usize);
    [r, g, b, if accessor.width < 4 { 1.0 } else { a }]
}

/// Reads the uv sets up to the last existing one; missing sets in between are zero.
fn read_uvs(sets: &[Option<Accessor>], used: &[u32]) -> Vec<Vec<Vec2>> {
    let count = sets.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let uv = |accessor: &Accessor, i: u32| {
        let [u, v] = accessor.floats(i as usize);
        Vec2::new(u, v)
    };
    let read = |set: &Option<Accessor>| match set {
        Some(accessor) => parallel::collect(used.len(), |i| uv(accessor, used[i])),
        None => vec![Vec2::default(); used.len()],
    };
    sets[..count].iter().map(read).collect()
}

/// The triangles of a primitive, and the number of surplus indices.
pub(super) struct Triangles {
    /// The triangles, counter-clockwise, in the file's vertex indices.
    pub list: Vec<[u32; 3]>,
    /// The number of indices at the end that do not form a whole triangle.
    pub surplus: usize,
}

/// Reads the vertex indices of a primitive with `vertices` vertices; without `indices` they count up from zero.
pub(super) fn read_indices(indices: Option<&Accessor>, vertices: usize) -> Reason<Vec<u32>> {
    let Some(accessor) = indices else { return Ok((0..vertices as u32).collect()) };
    if accessor.width != 1 || !accessor.is_unsigned() {
        return Err("indices must be unsigned integer scalars".into());
    }
    let read = parallel::collect(accessor.count, |i| accessor.unsigned::<1>(i)[0]);
    match first(&read, |v| *v as usize >= vertices) {
        Some(i) => Err(format!("index {i} refers to vertex {}, but there are only {vertices}", read[i])),
        None => Ok(read),
    }
}

/// Converts strips and fans to triangles; returns `None` for points and lines.
///
/// Every second triangle of a strip is flipped, so that all keep the winding of the first. Strip and fan triangles
/// with a repeated vertex only join parts and are dropped.
/// Source: glTF 2.0, 3.7.2.1.
pub(super) fn triangulate(mode: Mode, indices: &[u32]) -> Option<Triangles> {
    let list: Vec<[u32; 3]> = match mode {
        Mode::Triangles => {
            let list = indices.as_chunks::<3>();
            return Some(Triangles { list: list.0.to_vec(), surplus: list.1.len() });
        }
        Mode::TriangleStrip => indices.windows(3).enumerate().map(|(i, w)| turned(i, w)).collect(),
        Mode::TriangleFan => match indices.split_first() {
            Some((hub, rim)) => rim.windows(2).map(|w| [w[0], w[1], *hub]).collect(),
            None => Vec::new(),
        },
        _ => return None,
    };
    let whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    Some(Triangles { list: list.into_iter().filter(whole).collect(), surplus: 0 })
}

fn turned(i: usize, window: &[u32]) -> [u32; 3] {
    let odd = i % 2;
    [window[0], window[1 + odd], window[2 - odd]]
}

/// Returns the vertices used by triangles, in ascending order, and the triangles re-indexed to them.
pub(crate) fn compact(mut triangles: Vec<[u32; 3]>, count: usize) -> (Vec<u32>, Vec<[u32; 3]>) {
    let corners = triangles.as_flattened();
    if corners.len() < count / 4 {
        // A small part of a large shared array: time and memory must depend only on the part.
        let mut used = corners.to_vec();
        used.sort_unstable();
        used.dedup();
        for index in triangles.as_flattened_mut() {
            *index = used.partition_point(|u| u < index) as u32;
        }
        return (used, triangles);
    }
    let mut new_index = vec![u32::MAX; count];
    corners.iter().for_each(|i| new_index[*i as usize] = 0);
    let mut used = Vec::with_capacity(count);
    for (i, new) in new_index.iter_mut().enumerate().filter(|(_, new)| **new == 0) {
        *new = used.len() as u32;
        used.push(i as u32);
    }
    for index in triangles.as_flattened_mut() {
        *index = new_index[*index as usize];
    }
    (used, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        let strip = triangulate(Mode::TriangleStrip, &[0, 1, 2, 3, 4]).unwrap();
        assert_eq!(strip.list, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let fan = triangulate(Mode::TriangleFan, &[9, 1, 2, 3]).unwrap();
        assert_eq!(fan.list, [[1, 2, 9], [2, 3, 9]]);
    }

    #[test]
    fn joints_of_strips_and_surplus_indices_go() {
        let strip = triangulate(Mode::TriangleStrip, &[0, 1, 2, 2, 3, 3, 4, 5]).unwrap();
        assert_eq!(strip.list, [[0, 1, 2], [3, 5, 4]]);
        let list = triangulate(Mode::Triangles, &[0, 1, 2, 3]).unwrap();
        assert_eq!((list.list, list.surplus), (vec![[0, 1, 2]], 1));
        assert!(triangulate(Mode::Lines, &[0, 1]).is_none());
        assert!(triangulate(Mode::TriangleFan, &[]).unwrap().list.is_empty());
    }

    #[test]
    fn compacting_drops_what_no_triangle_names() {
        let triangles = vec![[7, 2, 4], [4, 2, 9]];
        let expected = (vec![2, 4, 7, 9], vec![[2, 0, 1], [1, 0, 3]]);
        assert_eq!(compact(triangles.clone(), 10), expected, "dense");
        assert_eq!(compact(triangles, 1000), expected, "sparse");
        assert_eq!(compact(vec![[2, 0, 1]], 3), (vec![0, 1, 2], vec![[2, 0, 1]]), "all used: as stored");
    }
}
