//! Stores the vertices of a file with fewer bits.

use super::super::format::VertexBits;
use super::super::stream::{Octahedron, PowerOfTwo, Stream};
use crate::io::gltf::{StoredAttribute, StoredVertices};
use serde_json::Value;
use std::collections::BTreeMap;

/// Returns the longest side of the mesh for each group of vertices. Primitives of a mesh are rounded identically, so
/// that they still meet.
pub(super) fn extents(all: &[StoredVertices]) -> Vec<f64> {
    let mesh = |vertices: &StoredVertices| vertices.primitives.first().map(|primitive| primitive.mesh);
    let mut sides: BTreeMap<Option<usize>, f64> = BTreeMap::new();
    for vertices in all {
        let [least, most] = bounds(&vertices.attributes[0]);
        let longest = (0..3).map(|k| f64::from(most[k]) - f64::from(least[k])).fold(0.0, f64::max);
        let of_mesh = sides.entry(mesh(vertices)).or_default();
        *of_mesh = of_mesh.max(longest);
    }
    all.iter().map(|vertices| sides[&mesh(vertices)]).collect()
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
        let rounded = |attribute: &StoredAttribute| match kind(&attribute.name) {
            "POSITION" => self.positions(attribute, order),
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

/// Returns the name of an attribute without its set number.
pub(super) fn kind(name: &str) -> &str {
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
pub(super) fn floats(attribute: &StoredAttribute) -> Vec<f32> {
    (0..attribute.elements.count()).flat_map(|vertex| attribute.numbers(vertex)).collect()
}

fn in_order(attribute: &StoredAttribute, order: &[usize]) -> Vec<f32> {
    order.iter().flat_map(|vertex| attribute.numbers(*vertex)).collect()
}
