//! Writes meshes as accessors, with a primitive for each alpha mode: in full precision, or compact, with quantised
//! numbers (KHR_mesh_quantization) and streams compressed by meshoptimizer (EXT_meshopt_compression or
//! KHR_meshopt_compression).

use super::draft::{Component, GltfDraft, MOST_OF_U16};
use super::format::VertexBits;
use super::stream::{Octahedron, PackedTriangles, PowerOfTwo, Stream};
use serde_json::{Value, json};
use std::borrow::Cow;
use taotie_engine::error::Result;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::AlphaMode;

/// The largest 16-bit number.
const MOST: f64 = 65535.0;

/// Adds a mesh and returns one primitive per part; all share its vertices.
pub(super) fn add(draft: &mut GltfDraft, mesh: &Mesh, parts: &[MeshPart]) -> Vec<Value> {
    let attributes = attributes(draft, mesh);
    let primitive = |part: &MeshPart| {
        let indices = indices(draft, &part.triangles, mesh.positions().len());
        json!({ "attributes": attributes, "indices": indices, "material": part.material })
    };
    parts.iter().map(primitive).collect()
}

fn attributes(draft: &mut GltfDraft, mesh: &Mesh) -> Value {
    let mut attributes = json!({ "POSITION": draft.bounded_floats(&arrays(mesh.positions())) });
    if !mesh.normals().is_empty() {
        attributes["NORMAL"] = draft.floats(&arrays(mesh.normals())).into();
        if !mesh.tangents().is_empty() {
            attributes["TANGENT"] = draft.floats(mesh.tangents()).into();
        }
    }
    for (set, uvs) in mesh.uvs().iter().enumerate() {
        let uvs: Vec<[f32; 2]> = uvs.iter().map(|uv| [uv.x, uv.y]).collect();
        attributes[semantic("TEXCOORD", set)] = draft.floats(&uvs).into();
    }
    if !mesh.colors().is_empty() {
        attributes[semantic("COLOR", 0)] = draft.floats(mesh.colors()).into();
    }
    let accessors = attributes.as_object().into_iter().flatten().filter_map(|(_, a)| a.as_u64());
    accessors.for_each(|accessor| draft.mark_vertices(accessor as usize));
    attributes
}

/// Returns the name of one of several attributes of a kind.
fn semantic(kind: &str, set: usize) -> String {
    format!("{kind}_{set}")
}

fn arrays(vectors: &[Vec3]) -> Vec<[f32; 3]> {
    vectors.iter().map(|v| v.to_array()).collect()
}

fn indices(draft: &mut GltfDraft, triangles: &[[u32; 3]], vertices: usize) -> usize {
    let indices = triangles.as_flattened().iter();
    let (bytes, component): (Vec<u8>, _) = if vertices <= MOST_OF_U16 {
        (indices.flat_map(|index| (*index as u16).to_le_bytes()).collect(), Component::U16)
    } else {
        (indices.flat_map(|index| index.to_le_bytes()).collect(), Component::U32)
    };
    let accessor = draft.elements(&bytes, component, 1);
    draft.mark_indices(accessor);
    accessor
}

/// Triangles of a mesh that become one primitive.
pub(super) struct MeshPart<'a> {
    pub triangles: Cow<'a, [[u32; 3]]>,
    /// The index of its material.
    pub material: usize,
}

impl<'a> MeshPart<'a> {
    /// Returns a whole mesh, with material 0.
    pub fn whole(mesh: &'a Mesh) -> Self {
        Self { triangles: Cow::Borrowed(mesh.triangles()), material: 0 }
    }

    /// Returns the parts of a mesh whose triangles have the modes `each`, in the order of `materials`, which are the
    /// modes of the materials; the whole mesh if there is only one material.
    pub fn by_mode(mesh: &'a Mesh, each: &[AlphaMode], materials: &[AlphaMode]) -> Vec<Self> {
        if materials.len() < 2 {
            return vec![Self::whole(mesh)];
        }
        let of = |(material, mode): (usize, &AlphaMode)| {
            let triangles = mesh.triangles().iter().zip(each);
            let triangles = triangles.filter(|(_, own)| *own == mode).map(|(triangle, _)| *triangle);
            Self { triangles: triangles.collect(), material }
        };
        materials.iter().enumerate().map(of).filter(|part| !part.triangles.is_empty()).collect()
    }
}

/// Returns each mode used by the triangles of all levels once: opaque, masks by their cutoffs, blended; the
/// material's own if there are none.
pub(super) fn distinct_modes(levels: &[Vec<AlphaMode>], own: AlphaMode) -> Vec<AlphaMode> {
    let mut modes = Vec::new();
    for mode in levels.iter().flatten() {
        if !modes.contains(mode) {
            modes.push(*mode);
        }
    }
    modes.sort_by(|a, b| mode_order(*a).total_cmp(&mode_order(*b)));
    if modes.is_empty() { vec![own] } else { modes }
}

fn mode_order(mode: AlphaMode) -> f32 {
    match mode {
        AlphaMode::Opaque => -1.0,
        AlphaMode::Mask(cutoff) => cutoff,
        AlphaMode::Blend => f32::INFINITY,
    }
}

/// The cube of steps that positions are rounded to. All axes have the same step, so that normals keep their
/// directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    origin: Vec3,
    step: f32,
    /// Steps along a side.
    most: f64,
}

impl Grid {
    /// Returns the smallest grid around all meshes, with 2^`bits` − 1 steps per side.
    pub fn around<'a>(meshes: impl Iterator<Item = &'a Mesh>, bits: u8) -> Self {
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for point in meshes.flat_map(Mesh::positions) {
            for (axis, value) in point.to_array().into_iter().enumerate() {
                least[axis] = least[axis].min(value);
                most[axis] = most[axis].max(value);
            }
        }
        let extents = least.iter().zip(most).map(|(least, most)| f64::from(most) - f64::from(*least));
        let most = f64::from((1u32 << bits) - 1);
        let step = (extents.fold(0.0, f64::max) / most) as f32;
        Self { origin: Vec3::from_array(least), step: if step > 0.0 { step.next_up() } else { 1.0 }, most }
    }

    /// Gives a node the transform from steps to model units.
    pub fn place(&self, node: &mut Value) {
        node["translation"] = json!(self.origin.to_array());
        node["scale"] = json!([self.step, self.step, self.step]);
    }

    /// Returns the nearest point, in steps.
    fn steps(&self, point: Vec3) -> [u16; 4] {
        let [x, y, z] = ((point.to_f64() - self.origin.to_f64()) * (1.0 / f64::from(self.step))).to_array();
        let nearest = |v: f64| (v + 0.5).clamp(0.0, self.most) as u16;
        [nearest(x), nearest(y), nearest(z), 0]
    }
}

/// A mesh in parts, and the precision of its vertices.
#[derive(Clone, Copy)]
pub(super) struct PackedMesh<'a> {
    pub mesh: &'a Mesh,
    pub parts: &'a [MeshPart<'a>],
    pub grid: &'a Grid,
    pub bits: VertexBits,
}

/// Adds a mesh and returns one primitive per part; all share its vertices. Vertices, and the triangles of each part,
/// are reordered.
///
/// # Errors
/// [`Error::Invalid`] if meshoptimizer fails.
pub(super) fn add_packed(draft: &mut GltfDraft, packed: PackedMesh) -> Result<Vec<Value>> {
    draft.require("KHR_mesh_quantization");
    draft.require(draft.codecs.meshopt());
    let PackedMesh { mesh, parts, grid, bits } = packed;
    let lists: Vec<&[[u32; 3]]> = parts.iter().map(|part| &*part.triangles).collect();
    let (order, lists) = sorted(&lists, mesh.positions().len());
    let data = in_order(mesh, &order);
    let mut attributes = json!({});
    for stream in streams(&data, grid, bits) {
        attributes[&stream.name] = add_stream(draft, &stream)?.into();
    }
    let primitive = |(part, triangles): (&MeshPart, Vec<[u32; 3]>)| -> Result<Value> {
        let indices = add_triangles(draft, &triangles, data.positions.len())?;
        Ok(json!({ "attributes": attributes, "indices": indices, "material": part.material }))
    };
    parts.iter().zip(lists).map(primitive).collect()
}

/// Returns the vertices in order of first use, and lists of triangles on them, each ordered so that neighbours are
/// adjacent.
pub(super) fn sorted(lists: &[&[[u32; 3]]], vertices: usize) -> (Vec<usize>, Vec<Vec<[u32; 3]>>) {
    let mut place = vec![None; vertices];
    let mut order = Vec::with_capacity(vertices);
    let sort = |triangles: &&[[u32; 3]]| {
        let mut indices = meshopt::optimize_vertex_cache_strip(triangles.as_flattened(), vertices);
        for index in &mut indices {
            let new = *place[*index as usize].get_or_insert_with(|| {
                order.push(*index as usize);
                order.len() as u32 - 1
            });
            *index = new;
        }
        indices.as_chunks::<3>().0.to_vec()
    };
    let lists = lists.iter().map(sort).collect();
    (order, lists)
}

/// Returns the vertices of a mesh in this order.
fn in_order(mesh: &Mesh, order: &[usize]) -> MeshData {
    MeshData {
        positions: taken(mesh.positions(), order),
        normals: taken(mesh.normals(), order),
        tangents: taken(mesh.tangents(), order),
        uvs: mesh.uvs().iter().map(|uvs| taken(uvs, order)).collect(),
        colors: taken(mesh.colors(), order),
        triangles: Vec::new(),
    }
}

fn taken<T: Copy>(values: &[T], order: &[usize]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { order.iter().map(|i| values[*i]).collect() }
}

fn streams(data: &MeshData, grid: &Grid, bits: VertexBits) -> Vec<Stream> {
    let steps: Vec<[u16; 4]> = data.positions.iter().map(|p| grid.steps(*p)).collect();
    let extreme = |of: fn(u16, u16) -> u16| {
        [0, 1, 2].map(|axis| steps.iter().map(|v| v[axis]).reduce(of).unwrap_or_default())
    };
    let positions = Stream {
        bounds: Some([extreme(u16::min), extreme(u16::max)].map(|all| all.map(Value::from).to_vec())),
        normalized: false,
        ..words("POSITION", &steps, 3)
    };
    let mut streams = vec![positions];
    if !data.normals.is_empty() {
        let normals = data.normals.iter().map(|n| [n.x, n.y, n.z, 0.0]);
        streams.push(Octahedron { bits: bits.normals }.stream("NORMAL", normals, 3));
        if !data.tangents.is_empty() {
            let signed = |[x, y, z, sign]: [f32; 4]| [x, y, z, if sign < 0.0 { -1.0 } else { 1.0 }];
            let tangents = data.tangents.iter().map(|tangent| signed(*tangent));
            streams.push(Octahedron { bits: bits.tangents() }.stream("TANGENT", tangents, 4));
        }
    }
    let sets = data.uvs.iter().enumerate();
    streams.extend(sets.map(|(set, uvs)| uv_stream(&semantic("TEXCOORD", set), uvs, bits.uvs)));
    if !data.colors.is_empty() {
        streams.push(fractions(semantic("COLOR", 0), &data.colors));
    }
    streams
}

fn uv_stream(name: &str, uvs: &[Vec2], bits: u8) -> Stream {
    let uvs: Vec<[f32; 2]> = uvs.iter().map(|uv| [uv.x, uv.y]).collect();
    let few = PowerOfTwo::within(1.0, bits).stream(name, uvs.as_flattened(), 2).filter(|_| bits < 16);
    few.unwrap_or_else(|| fractions(name.to_owned(), &uvs))
}

/// Returns numbers in [0, 1] in 16 bits; others remain floats.
fn fractions<const N: usize>(name: String, values: &[[f32; N]]) -> Stream {
    if values.as_flattened().iter().all(|v| (0.0..=1.0).contains(v)) {
        let small: Vec<[u16; N]> =
            values.iter().map(|v| v.map(|v| (f64::from(v) * MOST + 0.5) as u16)).collect();
        return words(&name, &small, N);
    }
    let bytes = values.as_flattened().iter().copied().flat_map(f32::to_le_bytes).collect();
    let (component, stride) = (Component::F32, 4 * N);
    Stream { name, bytes, stride, component, width: N, normalized: false, filter: None, bounds: None }
}

/// Returns unsigned words that represent [0, 1], `width` of which are used.
fn words<const N: usize>(name: &str, values: &[[u16; N]], width: usize) -> Stream {
    let bytes = values.as_flattened().iter().copied().flat_map(u16::to_le_bytes).collect();
    let (name, component) = (name.to_owned(), Component::U16);
    Stream { name, bytes, stride: 2 * N, component, width, normalized: true, filter: None, bounds: None }
}

/// Adds an attribute; returns the index of its accessor.
fn add_stream(draft: &mut GltfDraft, stream: &Stream) -> Result<usize> {
    let view = draft.packed_view(&stream.packed(draft.codecs)?, &stream.packing(draft.codecs));
    Ok(draft.push_accessor(stream.accessor(view)))
}

fn add_triangles(draft: &mut GltfDraft, triangles: &[[u32; 3]], vertices: usize) -> Result<usize> {
    let packed = PackedTriangles::new(triangles, vertices, draft.codecs)?;
    let view = draft.packed_view(&packed.bytes, &packed.packing);
    Ok(draft.push_accessor(packed.accessor(view)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODES: [AlphaMode; 4] =
        [AlphaMode::Opaque, AlphaMode::Mask(0.25), AlphaMode::Mask(0.5), AlphaMode::Blend];

    #[test]
    fn each_mode_has_one_part_in_a_fixed_order() {
        let mesh = Mesh::sphere(1.0, 8, 4);
        let count = mesh.triangles().len();
        let each: Vec<AlphaMode> = (0..count).map(|t| MODES[(t * 3 + 2) % 4]).collect();
        let materials = distinct_modes(std::slice::from_ref(&each), AlphaMode::Opaque);
        assert_eq!(materials, MODES);
        let parts = MeshPart::by_mode(&mesh, &each, &materials);
        assert_eq!(parts.iter().map(|part| part.triangles.len()).sum::<usize>(), count);
        for (part, mode) in parts.iter().zip(MODES) {
            let own = mesh.triangles().iter().zip(&each).filter(|(_, own)| **own == mode);
            assert!(own.map(|(triangle, _)| triangle).eq(part.triangles.iter()), "{mode:?}");
        }
        // A level that does not use a mode has no part for it.
        let opaque = vec![AlphaMode::Opaque; count];
        let parts = MeshPart::by_mode(&mesh, &opaque, &materials);
        assert_eq!((parts.len(), parts[0].material, parts[0].triangles.len()), (1, 0, count));
    }

    #[test]
    fn one_mode_is_the_whole_mesh() {
        let mesh = Mesh::sphere(1.0, 8, 4);
        for (levels, own) in
            [(vec![], AlphaMode::Blend), (vec![vec![AlphaMode::Blend; 3]], AlphaMode::Opaque)]
        {
            let materials = distinct_modes(&levels, own);
            assert_eq!(materials, [AlphaMode::Blend]);
            let parts = MeshPart::by_mode(&mesh, &[], &materials);
            assert!(parts.len() == 1 && matches!(parts[0].triangles, Cow::Borrowed(_)));
        }
    }
}
