//! Meshes packed small: numbers of few bits (KHR_mesh_quantization), and streams by meshoptimizer
//! (EXT_meshopt_compression).
//!
//! The filter is ours, as it is where files are read: the library's bits would depend on the compiler.

use super::draft::{Component, GltfDraft, INDICES, Packing, VERTICES};
use super::mesh::{MOST_OF_U16, semantic};
use super::parts::MeshPart;
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, MeshData};
use serde_json::{Value, json};

/// The largest of 16 bits.
const MOST: f64 = 65535.0;

/// The most bits of a normal's coordinates that fit into bytes.
const BITS_OF_BYTES: u8 = 8;

/// The cube of steps that positions are rounded to. It has one step for all axes, so that normals keep their directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    origin: Vec3,
    step: f32,
    /// Steps along a side.
    most: f64,
}

impl Grid {
    /// Returns the least grid around all meshes, of 2^`bits` − 1 steps along a side.
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

    /// Gives a node the transform that takes steps to model units.
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

/// A mesh in parts, and what its vertices are rounded to.
#[derive(Clone, Copy)]
pub(super) struct PackedMesh<'a> {
    pub mesh: &'a Mesh,
    pub parts: &'a [MeshPart<'a>],
    pub grid: &'a Grid,
    /// Bits of normals and tangents, as in [`VertexBits`](super::VertexBits).
    pub normal_bits: u8,
}

/// Adds a mesh and returns the primitive of each part; all share its vertices. Vertices, and the triangles of each part,
/// are sorted anew.
///
/// # Errors
/// [`Error::Invalid`] where meshoptimizer refuses.
pub(super) fn add(draft: &mut GltfDraft, packed: PackedMesh) -> Result<Vec<Value>> {
    draft.require("KHR_mesh_quantization");
    draft.require("EXT_meshopt_compression");
    let PackedMesh { mesh, parts, grid, normal_bits } = packed;
    let (data, parts) = sorted(mesh, parts);
    let mut attributes = json!({});
    for stream in streams(&data, grid, Octahedron { bits: normal_bits }) {
        attributes[&stream.name] = add_stream(draft, &stream)?.into();
    }
    let primitive = |part: &MeshPart| -> Result<Value> {
        let indices = add_triangles(draft, &part.triangles, data.positions.len())?;
        Ok(json!({ "attributes": attributes, "indices": indices, "material": part.material }))
    };
    parts.iter().map(primitive).collect()
}

/// Returns the vertices in the order of their first use, and the parts with their triangles in an order in which
/// neighbours follow one another.
fn sorted(mesh: &Mesh, parts: &[MeshPart]) -> (MeshData, Vec<MeshPart<'static>>) {
    let count = mesh.positions().len();
    let mut place = vec![None; count];
    let mut order = Vec::with_capacity(count);
    let sort = |part: &MeshPart| {
        let mut indices = meshopt::optimize_vertex_cache_strip(part.triangles.as_flattened(), count);
        for index in &mut indices {
            let new = *place[*index as usize].get_or_insert_with(|| {
                order.push(*index as usize);
                order.len() as u32 - 1
            });
            *index = new;
        }
        MeshPart { triangles: indices.as_chunks::<3>().0.to_vec().into(), material: part.material }
    };
    let parts = parts.iter().map(sort).collect();
    let data = MeshData {
        positions: taken(mesh.positions(), &order),
        normals: taken(mesh.normals(), &order),
        tangents: taken(mesh.tangents(), &order),
        uvs: mesh.uvs().iter().map(|uvs| taken(uvs, &order)).collect(),
        colors: taken(mesh.colors(), &order),
        triangles: Vec::new(),
    };
    (data, parts)
}

fn taken<T: Copy>(values: &[T], order: &[usize]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { order.iter().map(|i| values[*i]).collect() }
}

/// An attribute, each vertex of it in `stride` bytes.
struct Stream {
    name: String,
    bytes: Vec<u8>,
    stride: usize,
    component: Component,
    width: usize,
    normalized: bool,
    filter: Option<&'static str>,
    bounds: Option<[[u16; 3]; 2]>,
}

fn streams(data: &MeshData, grid: &Grid, octahedron: Octahedron) -> Vec<Stream> {
    let steps: Vec<[u16; 4]> = data.positions.iter().map(|p| grid.steps(*p)).collect();
    let extreme = |of: fn(u16, u16) -> u16| {
        [0, 1, 2].map(|axis| steps.iter().map(|v| v[axis]).reduce(of).unwrap_or_default())
    };
    let positions = Stream {
        bounds: Some([extreme(u16::min), extreme(u16::max)]),
        normalized: false,
        ..words("POSITION", &steps, 3)
    };
    let mut streams = vec![positions];
    if !data.normals.is_empty() {
        let normals = data.normals.iter().map(|n| octahedron.codes(n.to_array(), 0.0));
        streams.push(octahedron.stream("NORMAL", normals, 3));
        if !data.tangents.is_empty() {
            let tangents = data.tangents.iter().map(|[x, y, z, handedness]| {
                octahedron.codes([*x, *y, *z], if *handedness < 0.0 { -1.0 } else { 1.0 })
            });
            streams.push(octahedron.stream("TANGENT", tangents, 4));
        }
    }
    let sets = data.uvs.iter().enumerate();
    streams.extend(sets.map(|(set, uvs)| uv_stream(semantic("TEXCOORD", set), uvs)));
    if !data.colors.is_empty() {
        streams.push(fractions(semantic("COLOR", 0), &data.colors));
    }
    streams
}

fn uv_stream(name: String, uvs: &[Vec2]) -> Stream {
    let uvs: Vec<[f32; 2]> = uvs.iter().map(|uv| [uv.x, uv.y]).collect();
    fractions(name, &uvs)
}

/// Numbers of [0, 1] in 16 bits; others stay floats.
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

/// Unsigned words that mean [0, 1], of which `width` count.
fn words<const N: usize>(name: &str, values: &[[u16; N]], width: usize) -> Stream {
    let bytes = values.as_flattened().iter().copied().flat_map(u16::to_le_bytes).collect();
    let (name, component) = (name.to_owned(), Component::U16);
    Stream { name, bytes, stride: 2 * N, component, width, normalized: true, filter: None, bounds: None }
}

/// How the octahedral filter stores unit vectors. Source: EXT_meshopt_compression, Filter 1.
#[derive(Debug, Clone, Copy)]
struct Octahedron {
    /// Bits of a coordinate, with sign.
    bits: u8,
}

impl Octahedron {
    fn is_of_bytes(self) -> bool {
        self.bits <= BITS_OF_BYTES
    }

    /// Returns a direction on the octahedron whose lower half is folded over the corners of the upper, the one of it, and
    /// a sign, which the filter keeps, as the largest number of its type.
    fn codes(self, direction: [f32; 3], sign: f32) -> [i16; 4] {
        let [x, y, z] = direction.map(f64::from);
        let sum = x.abs() + y.abs() + z.abs();
        let (x, y) = if sum > 0.0 { (x / sum, y / sum) } else { (0.0, 0.0) };
        let (x, y) =
            if z < 0.0 { ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)) } else { (x, y) };
        let one = (1i16 << (self.bits - 1)) - 1;
        let stored = |v: f64| (v * f64::from(one)).round() as i16;
        let most = if self.is_of_bytes() { i16::from(i8::MAX) } else { i16::MAX };
        [stored(x), stored(y), one, (f32::from(most) * sign) as i16]
    }

    fn stream(self, name: &str, codes: impl Iterator<Item = [i16; 4]>, width: usize) -> Stream {
        let (bytes, component, stride) = match self.is_of_bytes() {
            true => (codes.flatten().map(|code| code as i8 as u8).collect(), Component::I8, 4),
            false => (codes.flatten().flat_map(i16::to_le_bytes).collect(), Component::I16, 8),
        };
        let (name, filter) = (name.to_owned(), Some("OCTAHEDRAL"));
        Stream { name, bytes, stride, component, width, normalized: true, filter, bounds: None }
    }
}

fn add_stream(draft: &mut GltfDraft, stream: &Stream) -> Result<usize> {
    let count = stream.bytes.len() / stream.stride;
    let packed = match stream.stride {
        4 => encode::<4>(&stream.bytes),
        8 => encode::<8>(&stream.bytes),
        _ => encode::<16>(&stream.bytes),
    }?;
    let (stride, filter) = (stream.stride, stream.filter);
    let packing = Packing { count, stride, mode: "ATTRIBUTES", filter, target: VERTICES };
    let view = draft.packed_view(&packed, &packing);
    let mut accessor = draft.accessor_json(view, (stream.component, stream.width), count);
    if stream.normalized {
        accessor["normalized"] = true.into();
    }
    if let Some([least, most]) = stream.bounds {
        accessor["min"] = json!(least);
        accessor["max"] = json!(most);
    }
    Ok(draft.push_accessor(accessor))
}

/// Encodes vertices as version 0, the only one that the extension knows.
fn encode<const N: usize>(bytes: &[u8]) -> Result<Vec<u8>> {
    meshopt::encode_vertex_buffer_level(bytes.as_chunks::<N>().0, 2, Some(0)).map_err(refused)
}

fn add_triangles(draft: &mut GltfDraft, triangles: &[[u32; 3]], vertices: usize) -> Result<usize> {
    let indices = triangles.as_flattened();
    let packed = meshopt::encode_index_buffer(indices, vertices).map_err(refused)?;
    let small = vertices <= MOST_OF_U16;
    let (component, stride) = if small { (Component::U16, 2) } else { (Component::U32, 4) };
    let count = indices.len();
    let packing = Packing { count, stride, mode: "TRIANGLES", filter: None, target: INDICES };
    let view = draft.packed_view(&packed, &packing);
    let accessor = draft.accessor_json(view, (component, 1), count);
    Ok(draft.push_accessor(accessor))
}

fn refused(error: meshopt::Error) -> Error {
    Error::invalid("a mesh to be packed", format!("{error}; write it without"))
}
