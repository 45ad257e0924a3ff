//! The vertex arrays of a primitive, as stored.

use super::accessor::Accessor;
use super::document::Document;
use super::reason::Reason;
use crate::error::Warnings;
use crate::math::{Vec2, Vec3};
use crate::mesh::MeshData;
use crate::parallel;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

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
