//! The vertices and triangles of a file: simplified, which moves vertices, and stored with fewer bits.

use super::super::draft::Component;
use super::super::format::VertexBits;
use super::super::mesh::sorted;
use super::super::stream::{Octahedron, PowerOfTwo, Stream};
use crate::gltf::{StoredAttribute, StoredVertices};
use meshopt::{SimplifyOptions, SimplifyVertex};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::RELIEF_OF_VERTICES;

/// The weight of uvs in the simplification error, relative to positions in a box of side 1.
const WEIGHT_OF_UVS: f32 = 0.5;
/// Maximum number of attribute values per vertex for meshoptimizer, excluding the position.
const MOST_NUMBERS: usize = 32;
/// The weight of vertex colours.
const WEIGHT_OF_COLORS: f32 = 0.5;

/// Fewer triangles per primitive, and their moved vertices.
pub(super) struct Simplified<'a> {
    pub vertices: Cow<'a, StoredVertices>,
    pub triangles: Vec<Vec<[u32; 3]>>,
}

impl<'a> Simplified<'a> {
    /// Simplifies primitives to a fraction of their triangles; those with morph targets stay unchanged.
    pub fn new(vertices: &'a StoredVertices, locks: &[SimplifyVertex], kept: f64) -> Self {
        let triangles = vertices.primitives.iter().map(|primitive| primitive.triangles.clone()).collect();
        let own = Self { vertices: Cow::Borrowed(vertices), triangles };
        if kept >= 1.0 || !vertices.targets.is_empty() {
            return own;
        }
        let mut movable = Movable::of(vertices);
        let triangles = own.triangles.into_iter().map(|triangles| {
            let target = (triangles.len() as f64 * kept).ceil() as usize;
            movable.simplified(triangles, target, locks)
        });
        let triangles = triangles.collect();
        Self { vertices: Cow::Owned(movable.into_vertices(vertices)), triangles }
    }
}

/// Gives copies of a vertex whose positions differ only by rounding the same position, so that simplification moves them
/// together and rounding never separates them: otherwise a seam opens.
pub(super) fn join_copies(vertices: &mut StoredVertices, extent: f64) {
    /// A few roundings of 32-bit numbers, relative to the longest side.
    const SAME: f64 = 1e-6;
    let near = extent * SAME;
    if near <= 0.0 || !vertices.attributes[0].is_float() {
        return;
    }
    let mut known: HashMap<[i64; 3], [f32; 3]> = HashMap::new();
    let joined = |place: &[f32; 3]| {
        let cell = |shift: [f64; 3]| -> [i64; 3] {
            std::array::from_fn(|k| (f64::from(place[k]) / (2.0 * near) + shift[k]).floor() as i64)
        };
        let is_copy = |own: &&[f32; 3]| (0..3).all(|k| f64::from((own[k] - place[k]).abs()) <= near);
        // A copy is in one of the eight cells that the surroundings touch.
        let around = (0..8).map(|i| cell([0, 1, 2].map(|k| if i >> k & 1 == 1 { 0.5 } else { -0.5 })));
        let copy = around.filter_map(|cell| known.get(&cell)).find(is_copy).copied();
        copy.unwrap_or_else(|| *known.entry(cell([0.0; 3])).or_insert(*place))
    };
    let places: Vec<[f32; 3]> = floats(&vertices.attributes[0]).as_chunks().0.iter().map(joined).collect();
    vertices.attributes[0].replace(places.iter().map(|place| place.as_slice()));
}

/// Returns the locks of vertices that other primitives may touch: those at open edges of a primitive, and those
/// shared by several primitives. They keep all their attributes.
pub(super) fn locks(vertices: &StoredVertices) -> Vec<SimplifyVertex> {
    let positions = floats(&vertices.attributes[0]);
    let mut places: HashMap<[u32; 3], u32> = HashMap::new();
    let place_of = |position: &[f32; 3]| {
        let next = places.len() as u32;
        *places.entry(position.map(|v| (v + 0.0).to_bits())).or_insert(next)
    };
    let place: Vec<u32> = positions.as_chunks().0.iter().map(place_of).collect();
    let mut is_locked = vec![false; places.len()];
    let mut user = vec![usize::MAX; places.len()];
    for (number, primitive) in vertices.primitives.iter().enumerate() {
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for triangle in &primitive.triangles {
            let [a, b, c] = triangle.map(|v| place[v as usize]);
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([from.min(to), from.max(to)]).or_default() += 1;
                let user = &mut user[from as usize];
                is_locked[from as usize] |= ![usize::MAX, number].contains(user);
                *user = number;
            }
        }
        let open = edges.into_iter().filter(|(_, count)| *count == 1);
        open.for_each(|(ends, _)| ends.into_iter().for_each(|end| is_locked[end as usize] = true));
    }
    let lock =
        |place: &u32| if is_locked[*place as usize] { SimplifyVertex::Lock } else { SimplifyVertex::None };
    place.iter().map(lock).collect()
}

/// The positions and attributes of vertices moved by simplification.
struct Movable {
    positions: Vec<[f32; 3]>,
    /// All attributes of each vertex, vertex by vertex.
    attributes: Vec<f32>,
    weights: Vec<f32>,
    /// The index of each attribute among those of the file, and its offset in `attributes`.
    places: Vec<(usize, usize)>,
}

impl Movable {
    fn of(vertices: &StoredVertices) -> Self {
        let (mut places, mut weights) = (Vec::new(), Vec::new());
        for (number, attribute) in vertices.attributes.iter().enumerate() {
            let weight = match kind(&attribute.name) {
                "NORMAL" => RELIEF_OF_VERTICES,
                "TEXCOORD" => WEIGHT_OF_UVS,
                "COLOR" => WEIGHT_OF_COLORS,
                _ => continue,
            };
            let has_unit = attribute.is_float() || attribute.is_normalized;
            if !has_unit || weights.len() + attribute.elements.width > MOST_NUMBERS {
                continue;
            }
            places.push((number, weights.len()));
            weights.resize(weights.len() + attribute.elements.width, weight);
        }
        let count = vertices.attributes[0].elements.count();
        let mut attributes = vec![0.0; count * weights.len()];
        for (number, place) in &places {
            let attribute = &vertices.attributes[*number];
            for (vertex, all) in attributes.chunks_exact_mut(weights.len()).enumerate() {
                all[*place..].iter_mut().zip(weighed_numbers(attribute, vertex)).for_each(|(to, v)| *to = v);
            }
        }
        let positions = floats(&vertices.attributes[0]).as_chunks().0.to_vec();
        Self { positions, attributes, weights, places }
    }

    /// Simplifies triangles; without locks, their borders may move too.
    fn simplified(
        &mut self,
        triangles: Vec<[u32; 3]>,
        target: usize,
        locks: &[SimplifyVertex],
    ) -> Vec<[u32; 3]> {
        let mut corners = triangles.as_flattened().to_vec();
        let is_locked = !locks.is_empty();
        let found = meshopt::simplify_with_update(
            &mut corners,
            &mut self.positions,
            &mut self.attributes,
            &self.weights,
            size_of_val(self.weights.as_slice()),
            is_locked.then_some(locks),
            3 * target,
            f32::MAX,
            if is_locked { SimplifyOptions::LockBorder } else { SimplifyOptions::empty() },
            None,
        );
        let found = corners[..found].as_chunks::<3>().0.to_vec();
        if found.is_empty() { triangles } else { found }
    }

    /// Returns the vertices of the file with their float attributes moved.
    fn into_vertices(self, own: &StoredVertices) -> StoredVertices {
        let mut vertices = own.clone();
        if !vertices.attributes[0].is_float() {
            return vertices;
        }
        let moved = self.positions.iter().map(|position| position.as_slice());
        vertices.attributes[0].replace(moved);
        for (number, place) in &self.places {
            let attribute = &mut vertices.attributes[*number];
            if attribute.is_float() {
                let width = attribute.elements.width;
                attribute.replace(
                    self.attributes.chunks_exact(self.weights.len()).map(|all| &all[*place..][..width]),
                );
            }
        }
        vertices
    }
}

impl StoredAttribute {
    /// Replaces the float attributes of vertices, unless the new values of a vertex are not finite. Colours stay in
    /// [0, 1].
    fn replace<'a>(&mut self, all: impl Iterator<Item = &'a [f32]>) {
        let is_color = kind(&self.name) == "COLOR";
        let own = std::mem::take(&mut self.elements.bytes);
        let old = own.chunks_exact(self.elements.width * size_of::<f32>());
        self.elements.bytes = old
            .zip(all)
            .flat_map(|(old, new)| -> Vec<u8> {
                let bytes = |v: &f32| if is_color { v.clamp(0.0, 1.0) } else { *v }.to_le_bytes();
                match new.iter().all(|v| v.is_finite()) {
                    true => new.iter().flat_map(bytes).collect(),
                    false => old.to_vec(),
                }
            })
            .collect();
    }
}

/// Returns the attribute values of a vertex for the simplification error: integers mapped to [0, 1] or [−1, 1],
/// normals of unit length, and 0 for non-finite values.
fn weighed_numbers(attribute: &StoredAttribute, vertex: usize) -> Vec<f32> {
    let finite = |v: f32| if v.is_finite() { v } else { 0.0 };
    let numbers: Vec<f32> = attribute.unit_numbers(vertex).map(finite).collect();
    match numbers[..] {
        [x, y, z] if attribute.name == "NORMAL" => {
            Vec3::new(x, y, z).normalize_or(Vec3::splat(0.0)).to_array().into()
        }
        _ => numbers,
    }
}

/// Reordered vertices, and the triangles of each primitive on them.
pub(super) struct Shaped {
    pub order: Vec<usize>,
    pub triangles: Vec<Vec<[u32; 3]>>,
}

impl Shaped {
    /// Reorders the remaining vertices and the triangles.
    pub fn new(simplified: &Simplified<'_>) -> Self {
        let lists: Vec<&[[u32; 3]]> = simplified.triangles.iter().map(Vec::as_slice).collect();
        let (order, triangles) = sorted(&lists, simplified.vertices.attributes[0].elements.count());
        Self { order, triangles }
    }
}

/// Returns the longest side of the mesh for each group of vertices. Primitives of a mesh are rounded identically, so
/// that they still meet.
pub(super) fn extents(all: &[StoredVertices]) -> Vec<f64> {
    let side = |vertices: &StoredVertices| {
        let [least, most] = bounds(&vertices.attributes[0]);
        (0..3).map(|k| f64::from(most[k]) - f64::from(least[k])).fold(0.0, f64::max)
    };
    let meshes = |vertices: &StoredVertices| -> BTreeSet<usize> {
        let places = vertices.primitives.iter().flat_map(|primitive| &primitive.places);
        places.map(|[mesh, _]| *mesh).collect()
    };
    let meshes: Vec<BTreeSet<usize>> = all.iter().map(meshes).collect();
    let mut sides: Vec<f64> = all.iter().map(side).collect();
    // Vertices may be those of several meshes, which then have one precision.
    loop {
        let mut of_meshes: BTreeMap<usize, f64> = BTreeMap::new();
        for (own, side) in meshes.iter().zip(&sides) {
            for mesh in own {
                let longest = of_meshes.entry(*mesh).or_default();
                *longest = longest.max(*side);
            }
        }
        let longest = |own: &BTreeSet<usize>| own.iter().map(|mesh| of_meshes[mesh]).fold(0.0, f64::max);
        let next: Vec<f64> = meshes.iter().map(longest).collect();
        if next == sides {
            return sides;
        }
        sides = next;
    }
}

fn bounds(positions: &StoredAttribute) -> [[f32; 3]; 2] {
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for point in floats(positions).chunks_exact(3) {
        for (k, v) in point.iter().enumerate() {
            bounds[0][k] = bounds[0][k].min(*v);
            bounds[1][k] = bounds[1][k].max(*v);
        }
    }
    bounds
}

/// The precision to which vertices are rounded.
pub(super) struct Precision {
    pub bits: VertexBits,
    /// The longest side of the mesh.
    pub extent: f64,
}

impl Precision {
    /// Returns the vertex attributes in this order.
    pub fn attributes(&self, attributes: &[StoredAttribute], order: &[usize]) -> Vec<Stream> {
        /// Bits per colour channel.
        const COLOR: u8 = 10;
        let is_only = attributes.iter().filter(|other| kind(&other.name) == "WEIGHTS").count() == 1;
        let rounded = |attribute: &StoredAttribute| match kind(&attribute.name) {
            "POSITION" => self.positions(attribute, order),
            "WEIGHTS" if is_only => weights(attribute, order),
            "NORMAL" | "TANGENT" => Some(self.directions(attribute, order)),
            "TEXCOORD" => PowerOfTwo::within(1.0, self.bits.uvs).of(attribute, order),
            "COLOR" => PowerOfTwo::within(1.0, COLOR).of(attribute, order),
            _ => None,
        };
        self.streams(attributes, order, rounded)
    }

    /// Returns the attributes of a morph target.
    pub fn target(&self, attributes: &[StoredAttribute], order: &[usize]) -> Vec<Stream> {
        let rounded = |attribute: &StoredAttribute| match kind(&attribute.name) {
            "POSITION" => self.positions(attribute, order),
            "NORMAL" | "TANGENT" => PowerOfTwo::within(1.0, self.bits.normals).of(attribute, order),
            _ => None,
        };
        self.streams(attributes, order, rounded)
    }

    fn streams(
        &self,
        attributes: &[StoredAttribute],
        order: &[usize],
        rounded: impl Fn(&StoredAttribute) -> Option<Stream>,
    ) -> Vec<Stream> {
        let stream = |attribute: &StoredAttribute| {
            let mut stream = attribute
                .is_float()
                .then(|| rounded(attribute))
                .flatten()
                .unwrap_or_else(|| stored(attribute, order));
            if attribute.name == "POSITION" && stream.bounds.is_none() {
                stream.bounds = Some(bounds_of_numbers(attribute, order));
            }
            stream
        };
        attributes.iter().map(stream).collect()
    }

    fn positions(&self, attribute: &StoredAttribute, order: &[usize]) -> Option<Stream> {
        let step = PowerOfTwo::within(self.extent, self.bits.positions);
        let mut stream = step.of(attribute, order)?;
        let rounded = |v: f32| Value::from(step.rounded(v));
        let values = in_order(attribute, order);
        let extreme = |of: fn(f32, f32) -> f32| {
            let of_axis = |k: usize| values.iter().skip(k).step_by(3).copied().reduce(of).unwrap_or_default();
            [0, 1, 2].map(|k| rounded(of_axis(k))).to_vec()
        };
        stream.bounds = Some([extreme(f32::min), extreme(f32::max)]);
        Some(stream)
    }

    fn directions(&self, attribute: &StoredAttribute, order: &[usize]) -> Stream {
        let width = attribute.elements.width;
        let values = in_order(attribute, order);
        let vectors = values.chunks_exact(width).map(|v| match *v {
            [x, y, z, sign] => [x, y, z, if sign < 0.0 { -1.0 } else { 1.0 }],
            [x, y, z] => [x, y, z, 0.0],
            _ => [0.0; 4],
        });
        let bits = if width == 4 { self.bits.tangents() } else { self.bits.normals };
        Octahedron { bits }.stream(&attribute.name, vectors, width)
    }
}

impl PowerOfTwo {
    /// Returns a float attribute in this order; `None` if the filter cannot represent it.
    fn of(self, attribute: &StoredAttribute, order: &[usize]) -> Option<Stream> {
        self.stream(&attribute.name, &in_order(attribute, order), attribute.elements.width)
    }
}

/// Returns the four weights of joints as bytes whose sum is 255, as glTF demands; `None` if they are not weights.
fn weights(attribute: &StoredAttribute, order: &[usize]) -> Option<Stream> {
    const ONE: f32 = 255.0;
    if attribute.elements.width != 4 {
        return None;
    }
    let mut bytes = Vec::with_capacity(4 * order.len());
    for weights in in_order(attribute, order).as_chunks::<4>().0 {
        let sum: f32 = weights.iter().sum();
        let are_weights = weights.iter().all(|weight| *weight >= 0.0) && (0.99..1.01).contains(&sum);
        if !are_weights {
            return None;
        }
        let exact = weights.map(|weight| weight / sum * ONE);
        let mut codes = exact.map(|v| v.floor() as u8);
        // The rest goes to those that lost most.
        let mut places = [0, 1, 2, 3];
        places.sort_by(|a, b| (exact[*b].fract()).total_cmp(&exact[*a].fract()).then(a.cmp(b)));
        let rest = 255 - codes.iter().map(|code| usize::from(*code)).sum::<usize>().min(255);
        places.iter().take(rest).for_each(|place| codes[*place] += 1);
        bytes.extend(codes);
    }
    Some(Stream {
        name: attribute.name.clone(),
        bytes,
        stride: 4,
        component: Component::U8,
        width: 4,
        normalized: true,
        filter: None,
        bounds: None,
    })
}

/// Returns the name of an attribute without its set number.
fn kind(name: &str) -> &str {
    name.split_once('_').filter(|(kind, _)| !kind.is_empty()).map_or(name, |(kind, _)| kind)
}

/// Returns an attribute as stored; elements start at multiples of four bytes.
fn stored(attribute: &StoredAttribute, order: &[usize]) -> Stream {
    let elements = &attribute.elements;
    let size = elements.width * elements.component.size();
    let stride = size.next_multiple_of(4);
    let mut bytes = Vec::with_capacity(stride * order.len());
    for vertex in order {
        bytes.extend_from_slice(attribute.element(*vertex));
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    Stream {
        name: attribute.name.clone(),
        bytes,
        stride,
        component: elements.component.into(),
        width: elements.width,
        normalized: attribute.is_normalized,
        filter: None,
        bounds: None,
    }
}

/// Returns the minimum and maximum of each component as stored.
fn bounds_of_numbers(attribute: &StoredAttribute, order: &[usize]) -> [Vec<Value>; 2] {
    let (width, is_float) = (attribute.elements.width, attribute.is_float());
    let values = in_order(attribute, order);
    let number = |v: f32| if is_float { Value::from(v) } else { Value::from(v as i64) };
    [f32::min, f32::max].map(|of: fn(f32, f32) -> f32| {
        let of_axis = |k: usize| values.iter().skip(k).step_by(width).copied().reduce(of).unwrap_or_default();
        (0..width).map(|k| number(of_axis(k))).collect()
    })
}

/// Returns the components of all elements as numbers; integers are not normalised.
fn floats(attribute: &StoredAttribute) -> Vec<f32> {
    (0..attribute.elements.count()).flat_map(|vertex| attribute.numbers(vertex)).collect()
}

fn in_order(attribute: &StoredAttribute, order: &[usize]) -> Vec<f32> {
    order.iter().flat_map(|vertex| attribute.numbers(*vertex)).collect()
}
