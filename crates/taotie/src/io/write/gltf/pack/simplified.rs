//! Simplifies the triangles of a file, moving vertices.

use super::super::packed::sorted;
use super::geometry::{floats, kind};
use crate::io::gltf::{StoredAttribute, StoredVertices};
use crate::math::Vec3;
use crate::mesh::RELIEF_OF_VERTICES;
use meshopt::{SimplifyOptions, SimplifyVertex};
use std::borrow::Cow;
use std::collections::HashMap;

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
