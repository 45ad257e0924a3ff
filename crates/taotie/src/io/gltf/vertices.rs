//! The vertex arrays of a primitive, as they are stored.

use super::accessor::Accessor;
use super::document::Document;
use super::reason::Reason;
use crate::error::Warnings;
use crate::math::{Vec2, Vec3};
use crate::mesh::MeshData;
use crate::parallel;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// The most uv sets of a mesh that are read.
pub(super) const MAX_UV_SETS: u32 = 8;

/// Reads the attributes of one primitive, for the vertices `used` only.
pub(super) struct Vertices<'a> {
    document: &'a Document,
    /// The primitive that is read.
    pub primitive: &'a Primitive,
    /// The number of vertices that the file has for the primitive.
    pub count: usize,
    positions: Accessor<'a>,
}

impl<'a> Vertices<'a> {
    /// Opens POSITION; `None` where the primitive has none.
    pub fn open(document: &'a Document, primitive: &'a Primitive) -> Reason<Option<Self>> {
        let Some(index) = attribute(primitive, Semantic::Positions) else { return Ok(None) };
        let positions = Accessor::open(document, index).map_err(|why| format!("POSITION: {why}"))?;
        if positions.width != 3 {
            return Err("POSITION: it must have 3 components".into());
        }
        if positions.count > u32::MAX as usize {
            return Err(format!("POSITION: {} vertices; at most 2^32 - 1", positions.count));
        }
        if positions.is_implicit() && primitive_is_compressed(primitive) {
            return Err("POSITION: it is compressed by an extension that is not supported".into());
        }
        Ok(Some(Self { document, primitive, count: positions.count, positions }))
    }

    /// Reads every attribute of the vertices `used`. Attributes other than POSITION that cannot be read are left
    /// out, with a warning that starts with `place`.
    pub fn read(&self, used: &[u32], place: &str, warnings: &mut Warnings) -> MeshData {
        let mut optional = |semantic: Semantic| {
            let name = semantic.to_string();
            let index = attribute(self.primitive, semantic)?;
            self.open_optional(index)
                .map_err(|w| warnings.note(format!("{place}: {name} left out: {w}"), 1))
                .ok()
        };
        let mut data = MeshData {
            positions: parallel::collect(used.len(), |i| vec3(&self.positions, used[i])),
            ..MeshData::default()
        };
        if let Some(normals) = optional(Semantic::Normals) {
            data.normals = parallel::collect(used.len(), |i| vec3(&normals, used[i]));
            if let Some(tangents) = optional(Semantic::Tangents) {
                data.tangents = parallel::collect(used.len(), |i| tangents.floats(used[i] as usize));
            }
        }
        let sets = (0..MAX_UV_SETS).map(|set| optional(Semantic::TexCoords(set))).collect::<Vec<_>>();
        data.uvs = read_uvs(&sets, used);
        if let Some(colors) = optional(Semantic::Colors(0)) {
            data.colors = parallel::collect(used.len(), |i| color(&colors, used[i]));
        }
        data
    }

    /// Opens an accessor with one element a vertex.
    pub fn open_optional(&self, index: usize) -> Reason<Accessor<'a>> {
        let accessor = Accessor::open(self.document, index)?;
        if accessor.count == self.count {
            Ok(accessor)
        } else {
            Err(format!("{} elements for {} positions", accessor.count, self.count))
        }
    }
}

/// The accessor index of an attribute.
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

/// The uv sets up to the last that exists; one that is missing between others is zero.
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
