//! Vertex attributes and triangles as packed by meshoptimizer.
//!
//! The filters are our own, as in the reader: the library's bits would depend on the compiler.

use super::draft::{Component, INDICES, MOST_OF_U16, Packing, VERTICES, accessor};
use super::format::CodecSet;
use serde_json::{Value, json};
use taotie_engine::error::{Error, Result};

/// An attribute with `stride` bytes per vertex.
pub(super) struct Stream {
    pub name: String,
    pub bytes: Vec<u8>,
    pub stride: usize,
    pub component: Component,
    pub width: usize,
    pub normalized: bool,
    pub filter: Option<&'static str>,
    /// The minimum and maximum of each component, which the accessor must specify for positions.
    pub bounds: Option<[Vec<Value>; 2]>,
}

impl Stream {
    /// Joins streams of the same layout, one after the other; `None` if there are none.
    pub fn joined<'a>(all: impl Iterator<Item = &'a Self> + Clone) -> Option<Self> {
        let Self { name, stride, component, width, normalized, filter, .. } = all.clone().next()?;
        let bytes = all.flat_map(|stream| &stream.bytes).copied().collect();
        let (name, stride, component, width) = (name.clone(), *stride, *component, *width);
        Some(Self {
            name,
            bytes,
            stride,
            component,
            width,
            normalized: *normalized,
            filter: *filter,
            bounds: None,
        })
    }

    /// Returns the number of vertices.
    pub fn count(&self) -> usize {
        self.bytes.len() / self.stride
    }

    /// Returns the packing of the view.
    pub fn packing(&self, codecs: CodecSet) -> Packing {
        let &Self { stride, filter, .. } = self;
        let target = Some(VERTICES);
        Packing { count: self.count(), stride, mode: "ATTRIBUTES", filter, target, codecs }
    }

    /// Returns the packed bytes, in the version allowed by the extension.
    ///
    /// # Errors
    /// [`Error::Invalid`] if meshoptimizer fails.
    pub fn packed(&self, codecs: CodecSet) -> Result<Vec<u8>> {
        let version = codecs.vertex_version();
        match self.stride {
            4 => encode::<4>(&self.bytes, version),
            8 => encode::<8>(&self.bytes, version),
            12 => encode::<12>(&self.bytes, version),
            _ => encode::<16>(&self.bytes, version),
        }
    }

    /// Returns the accessor for a view that contains it.
    pub fn accessor(&self, view: usize) -> Value {
        let mut accessor = accessor(view, (self.component, self.width), self.count());
        if self.normalized {
            accessor["normalized"] = true.into();
        }
        if let Some([least, most]) = &self.bounds {
            accessor["min"] = json!(least);
            accessor["max"] = json!(most);
        }
        accessor
    }
}

/// Triangle corners as packed by meshoptimizer.
pub(super) struct PackedTriangles {
    pub bytes: Vec<u8>,
    pub packing: Packing,
    component: Component,
}

impl PackedTriangles {
    /// Packs triangles on `vertices` vertices.
    ///
    /// # Errors
    /// [`Error::Invalid`] if meshoptimizer fails.
    pub fn new(triangles: &[[u32; 3]], vertices: usize, codecs: CodecSet) -> Result<Self> {
        let indices = triangles.as_flattened();
        let bytes = meshopt::encode_index_buffer(indices, vertices).map_err(refused)?;
        let is_small = vertices <= MOST_OF_U16;
        let (component, stride) = if is_small { (Component::U16, 2) } else { (Component::U32, 4) };
        let (count, target) = (indices.len(), Some(INDICES));
        let packing = Packing { count, stride, mode: "TRIANGLES", filter: None, target, codecs };
        Ok(Self { bytes, packing, component })
    }

    /// Returns the accessor for a view that contains them.
    pub fn accessor(&self, view: usize) -> Value {
        accessor(view, (self.component, 1), self.packing.count)
    }
}

fn encode<const N: usize>(bytes: &[u8], version: i32) -> Result<Vec<u8>> {
    meshopt::encode_vertex_buffer_level(bytes.as_chunks::<N>().0, 2, Some(version)).map_err(refused)
}

fn refused(error: meshopt::Error) -> Error {
    Error::invalid("mesh compression", format!("{error}; write it uncompressed"))
}

/// The octahedral filter for unit vectors. Source: EXT_meshopt_compression, Filter 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Octahedron {
    /// Bits per coordinate, including the sign.
    pub bits: u8,
}

/// Maximum number of bits per coordinate that fit into bytes.
const BITS_OF_BYTES: u8 = 8;

impl Octahedron {
    fn is_of_bytes(self) -> bool {
        self.bits <= BITS_OF_BYTES
    }

    /// Returns a direction on the octahedron with its lower half folded over the corners of the upper half, the value
    /// that represents 1, and a sign, which the filter keeps, as the largest number of its type.
    fn codes(self, [x, y, z, sign]: [f32; 4]) -> [i16; 4] {
        let [x, y, z] = [x, y, z].map(f64::from);
        let sum = x.abs() + y.abs() + z.abs();
        let (x, y) = if sum > 0.0 { (x / sum, y / sum) } else { (0.0, 0.0) };
        let (x, y) =
            if z < 0.0 { ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)) } else { (x, y) };
        let one = (1i16 << (self.bits - 1)) - 1;
        let stored = |v: f64| (v * f64::from(one)).round() as i16;
        let most = if self.is_of_bytes() { i16::from(i8::MAX) } else { i16::MAX };
        [stored(x), stored(y), one, (f32::from(most) * sign) as i16]
    }

    /// Packs normals, whose sign is 0, or tangents, whose sign is −1 or 1.
    pub fn stream(self, name: &str, vectors: impl Iterator<Item = [f32; 4]>, width: usize) -> Stream {
        let codes = vectors.map(|vector| self.codes(vector));
        let (bytes, component, stride) = match self.is_of_bytes() {
            true => (codes.flatten().map(|code| code as i8 as u8).collect(), Component::I8, 4),
            false => (codes.flatten().flat_map(i16::to_le_bytes).collect(), Component::I16, 8),
        };
        let (name, filter) = (name.to_owned(), Some("OCTAHEDRAL"));
        Stream { name, bytes, stride, component, width, normalized: true, filter, bounds: None }
    }
}

/// The filter for unit quaternions (x, y, z, w): the largest component, which is made positive, is left out. Source:
/// EXT_meshopt_compression, Filter 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quaternions {
    /// Bits per component, including the sign, at least 4.
    pub bits: u8,
}

impl Quaternions {
    /// Packs quaternions of any length but zero.
    pub fn stream(self, name: &str, values: &[f32]) -> Stream {
        let codes = values.as_chunks::<4>().0.iter().map(|quaternion| self.codes(quaternion.map(f64::from)));
        let bytes = codes.flatten().flat_map(i16::to_le_bytes).collect();
        let (name, component, filter) = (name.to_owned(), Component::I16, Some("QUATERNION"));
        Stream { name, bytes, stride: 8, component, width: 4, normalized: true, filter, bounds: None }
    }

    fn codes(self, quaternion: [f64; 4]) -> [i16; 4] {
        let length = quaternion.iter().map(|v| v * v).sum::<f64>().sqrt();
        let larger =
            |best: usize, i: usize| if quaternion[i].abs() > quaternion[best].abs() { i } else { best };
        let largest = (1..4).fold(0, larger);
        let one = (1i16 << (self.bits - 1)) - 1;
        // The others are at most half the square root of two.
        let scale = f64::from(one) * std::f64::consts::SQRT_2 / length.copysign(quaternion[largest]);
        let [x, y, z] = [1, 2, 3].map(|i| (quaternion[(largest + i) % 4] * scale).round() as i16);
        [x, y, z, (one & !3) | largest as i16]
    }
}

/// The exponential filter for floats: multiples of one power of two. Source: EXT_meshopt_compression, Filter 3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PowerOfTwo {
    exponent: i8,
}

impl PowerOfTwo {
    /// Maximum number of steps that the filter stores.
    const MOST: f64 = 8_388_607.0;

    /// Returns the largest power of two such that 2^`bits` of it are at most `extent`.
    pub fn within(extent: f64, bits: u8) -> Self {
        // The exponent of a number is read from its bits; a logarithm might round.
        let exponent = ((extent.max(f64::MIN_POSITIVE).to_bits() >> 52) & 0x7ff) as i32 - 1023;
        Self { exponent: (exponent - i32::from(bits)).clamp(-100, 100) as i8 }
    }

    fn step(self) -> f64 {
        f64::from_bits(((1023 + i64::from(self.exponent)) as u64) << 52)
    }

    /// Returns the floats of a stream, rounded; `None` if one is too large for the filter, or not finite.
    pub fn stream(self, name: &str, values: &[f32], width: usize) -> Option<Stream> {
        let steps = |v: f32| (f64::from(v) / self.step()).round();
        if !values.iter().all(|v| steps(*v).abs() <= Self::MOST) {
            return None;
        }
        let word = |v: &f32| (i32::from(self.exponent) << 24) | (steps(*v) as i32 & 0x00ff_ffff);
        let bytes = values.iter().flat_map(|v| word(v).to_le_bytes()).collect();
        let (name, filter) = (name.to_owned(), Some("EXPONENTIAL"));
        let (component, stride, normalized) = (Component::F32, 4 * width, false);
        Some(Stream { name, bytes, stride, component, width, normalized, filter, bounds: None })
    }

    /// Returns a number as rounded by the filter.
    pub fn rounded(self, v: f32) -> f32 {
        ((f64::from(v) / self.step()).round() * self.step()) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_lies_within_the_extent() {
        for (extent, bits, step) in [(1.0, 0, 1.0), (1.0, 3, 0.125), (1.9, 3, 0.125), (0.7, 1, 0.25)] {
            assert_eq!(PowerOfTwo::within(extent, bits).step(), step, "{extent} {bits}");
        }
        assert_eq!(PowerOfTwo::within(0.0, 12), PowerOfTwo { exponent: -100 });
    }

    #[test]
    fn floats_are_multiples_of_the_step() {
        let power = PowerOfTwo::within(4.0, 4);
        let values = [-1.0, 0.3, 0.125, 7.9];
        let stream = power.stream("A", &values, 1).unwrap();
        let words: Vec<i32> =
            stream.bytes.as_chunks::<4>().0.iter().map(|b| i32::from_le_bytes(*b)).collect();
        let mantissas: Vec<i32> = words.iter().map(|word| (word << 8) >> 8).collect();
        assert_eq!(mantissas, [-4, 1, 1, 32], "a half rounds away from zero");
        assert!(words.iter().all(|word| word >> 24 == -2));
        assert_eq!(values.map(|v| power.rounded(v)), [-1.0, 0.25, 0.25, 8.0]);
        assert!(power.stream("A", &[3e6], 1).is_none() && power.stream("A", &[f32::NAN], 1).is_none());
    }
}
