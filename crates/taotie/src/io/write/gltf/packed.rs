//! Compact meshes: quantised numbers (KHR_mesh_quantization), and streams compressed by meshoptimizer
//! (EXT_meshopt_compression or KHR_meshopt_compression).
//!
//! The filter is our own, as in the reader: the library's bits would depend on the compiler.

use super::draft::{Component, GltfDraft};
use super::format::VertexBits;
use super::mesh::semantic;
use super::parts::MeshPart;
use super::stream::{Octahedron, PackedTriangles, PowerOfTwo, Stream};
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, MeshData};
use serde_json::{Value, json};

/// The largest 16-bit number.
const MOST: f64 = 65535.0;

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
pub(super) fn add(draft: &mut GltfDraft, packed: PackedMesh) -> Result<Vec<Value>> {
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
