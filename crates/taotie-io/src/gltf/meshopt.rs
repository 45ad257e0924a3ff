//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views packed by meshoptimizer, and their filters.
//!
//! The decoders do not check sizes, so all requirements of the extension are checked first.
//!
//! meshoptimizer has the filters too, from stored values to numbers, but it uses the processor's approximate
//! reciprocals for speed, which differ between vendors. Those here give the same bits everywhere.
//! Source: KHR_meshopt_compression, appendix B.
//! Law: they agree with meshoptimizer's to one unit (`tests::meshoptimizer_agrees_to_one_unit`).

use crate::reading::Reason;
use gltf::json::Value;
use gltf::json::buffer::{Buffer, View};
use serde_json::Map;
use std::f64::consts::FRAC_1_SQRT_2;

const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// Maximum number of unpacked bytes per packed byte of any stream: 256 vertices for two bits per byte of a vertex.
const MAX_RATIO: u64 = 1024;

/// Returns the JSON of the extension in a view; `None` if absent.
pub(super) fn of_view(view: &View) -> Option<&Value> {
    let extensions = view.extensions.as_ref()?;
    NAMES.into_iter().find_map(|name| extensions.others.get(name))
}

/// Returns `true` if a buffer only holds data that other programs read instead of the packed data, or nothing at all.
pub(super) fn is_fallback(buffer: &Buffer) -> bool {
    buffer.extensions.as_ref().is_some_and(|extensions| is_fallback_with(&extensions.others))
}

/// Returns the same for a buffer with these extensions.
pub(super) fn is_fallback_with(extensions: &Map<String, Value>) -> bool {
    let flag = |name| extensions.get(name)?.get("fallback")?.as_bool();
    NAMES.into_iter().find_map(flag).unwrap_or(false)
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

/// A packed view, with consistent numbers.
#[derive(Debug)]
pub(super) struct Packed {
    /// The buffer of the packed bytes.
    pub buffer: usize,
    /// The offset of the packed bytes in the buffer.
    pub offset: u64,
    /// The number of packed bytes.
    pub length: u64,
    count: usize,
    stride: usize,
    mode: Mode,
    filter: Filter,
}

impl Packed {
    /// Reads and checks the extension's object.
    pub fn read(json: &Value) -> Reason<Self> {
        let optional =
            |name: &str| json.get(name).map(|v| v.as_u64().ok_or_else(|| wrong(name, v))).transpose();
        let number = |name: &str| optional(name)?.ok_or_else(|| format!("missing {name}"));
        let index = |name: &str| usize::try_from(number(name)?).map_err(|e| e.to_string());
        let packed = Self {
            buffer: index("buffer")?,
            offset: optional("byteOffset")?.unwrap_or(0),
            length: number("byteLength")?,
            count: index("count")?,
            stride: index("byteStride")?,
            mode: mode(json)?,
            filter: filter(json)?,
        };
        packed.check()?;
        Ok(packed)
    }

    fn check(&self) -> Reason<()> {
        let Self { count, stride, mode, filter, length, .. } = *self;
        let fits = match mode {
            Mode::Attributes => stride % 4 == 0 && (4..=256).contains(&stride),
            Mode::Triangles => count % 3 == 0 && matches!(stride, 2 | 4),
            Mode::Indices => matches!(stride, 2 | 4),
        };
        let filtered = match filter {
            Filter::None => true,
            _ if mode != Mode::Attributes => false,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
            Filter::Exponential => true,
        };
        if !(fits && filtered) {
            return Err(format!(
                "{count} elements of {stride} bytes cannot be packed as {mode:?} and {filter:?}"
            ));
        }
        let size = (count as u64).saturating_mul(stride as u64);
        if size > length.saturating_mul(MAX_RATIO) {
            return Err(format!("{length} bytes cannot hold {count} elements of {stride} bytes"));
        }
        Ok(())
    }

    /// Returns the number of bytes it unpacks to.
    pub fn size(&self) -> usize {
        self.count * self.stride
    }

    /// Unpacks the bytes that the view names.
    pub fn unpack(&self, bytes: &[u8]) -> Reason<Vec<u8>> {
        let count = self.count;
        let unpacked = match (self.mode, self.stride) {
            (Mode::Attributes, stride) => VERTEX_DECODERS[stride / 4 - 1](bytes, count),
            (Mode::Triangles, 2) => meshopt::decode_index_buffer::<u16>(bytes, count).map(from_u16),
            (Mode::Triangles, _) => meshopt::decode_index_buffer::<u32>(bytes, count).map(from_u32),
            (Mode::Indices, 2) => meshopt::decode_index_sequence::<u16>(bytes, count).map(from_u16),
            (Mode::Indices, _) => meshopt::decode_index_sequence::<u32>(bytes, count).map(from_u32),
        };
        let mut unpacked = unpacked.map_err(|_| "the packed data is damaged; re-export the model")?;
        self.unfilter(&mut unpacked);
        Ok(unpacked)
    }

    fn unfilter(&self, bytes: &mut [u8]) {
        let width = if self.stride == 4 { Width::Byte } else { Width::Short };
        match self.filter {
            Filter::None => {}
            Filter::Octahedral => octahedral(bytes, width),
            Filter::Quaternion => quaternion(bytes),
            Filter::Exponential => exponential(bytes),
            Filter::Color => color(bytes, width),
        }
    }
}

fn wrong(name: &str, value: &Value) -> String {
    format!("invalid {name} {value}")
}

fn mode(json: &Value) -> Reason<Mode> {
    match json.get("mode").and_then(Value::as_str) {
        Some("ATTRIBUTES") => Ok(Mode::Attributes),
        Some("TRIANGLES") => Ok(Mode::Triangles),
        Some("INDICES") => Ok(Mode::Indices),
        _ => Err("unknown compression mode".into()),
    }
}

fn filter(json: &Value) -> Reason<Filter> {
    match json.get("filter").map(Value::as_str) {
        None | Some(Some("NONE")) => Ok(Filter::None),
        Some(Some("OCTAHEDRAL")) => Ok(Filter::Octahedral),
        Some(Some("QUATERNION")) => Ok(Filter::Quaternion),
        Some(Some("EXPONENTIAL")) => Ok(Filter::Exponential),
        Some(Some("COLOR")) => Ok(Filter::Color),
        _ => Err("unknown compression filter".into()),
    }
}

fn from_u16(values: Vec<u16>) -> Vec<u8> {
    values.into_iter().flat_map(u16::to_le_bytes).collect()
}

fn from_u32(values: Vec<u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// A vertex of `N` times four bytes: the decoder derives the size of a vertex from its type.
#[derive(Clone, Copy)]
#[repr(transparent)]
struct Vertex<const N: usize>([[u8; 4]; N]);

impl<const N: usize> Default for Vertex<N> {
    fn default() -> Self {
        Self([[0; 4]; N])
    }
}

type VertexDecoder = fn(&[u8], usize) -> meshopt::Result<Vec<u8>>;

fn vertices<const N: usize>(bytes: &[u8], count: usize) -> meshopt::Result<Vec<u8>> {
    let vertices: Vec<Vertex<N>> = meshopt::decode_vertex_buffer(bytes, count)?;
    let mut unpacked = Vec::with_capacity(4 * N * count);
    vertices.iter().for_each(|vertex| unpacked.extend_from_slice(vertex.0.as_flattened()));
    Ok(unpacked)
}

macro_rules! decoders {
    ($($words:literal)*) => { [$(vertices::<$words>),*] };
}

/// One decoder for each vertex size, indexed by the number of words minus one.
const VERTEX_DECODERS: [VertexDecoder; 64] = decoders!(
    1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
    33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64
);

/// The bit width of the numbers of a four-component vector.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Width {
    /// 8 bits.
    Byte,
    /// 16 bits.
    Short,
}

impl Width {
    /// Returns the largest signed number.
    fn signed_one(self) -> f64 {
        match self {
            Self::Byte => 127.0,
            Self::Short => 32767.0,
        }
    }

    /// Returns the largest unsigned number.
    fn unsigned_one(self) -> f64 {
        2.0 * self.signed_one() + 1.0
    }
}

/// Decodes unit vectors from two octahedral coordinates and the stored 1; the fourth number is unchanged.
fn octahedral(bytes: &mut [u8], width: Width) {
    each(bytes, width, |[x, y, one, rest]| {
        let one = f64::from(one.max(1));
        let (x, y) = (f64::from(x) / one, f64::from(y) / one);
        let z = 1.0 - x.abs() - y.abs();
        // The lower half is folded over the corners of the upper half.
        let fold = z.min(0.0);
        let (x, y) = (x - fold.abs().copysign(x), y - fold.abs().copysign(y));
        let scale = width.signed_one() / (x * x + y * y + z * z).sqrt();
        [nearest(x * scale), nearest(y * scale), nearest(z * scale), rest]
    });
}

/// Decodes unit quaternions from 16-bit numbers: three components, and a fourth number with the stored 1 and, in two
/// bits, the index of the largest component, which is positive and omitted.
fn quaternion(bytes: &mut [u8]) {
    each(bytes, Width::Short, |[x, y, z, last]| {
        let scale = FRAC_1_SQRT_2 / f64::from((last | 3).max(1));
        let last = last & 3;
        let [x, y, z] = [x, y, z].map(|v| f64::from(v) * scale);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let mut turned = [0; 4];
        for (place, value) in (last as usize..).zip([w, x, y, z]) {
            turned[place % 4] = nearest(value * Width::Short.signed_one());
        }
        turned
    });
}

/// Decodes floats from a signed 8-bit exponent and a signed 24-bit mantissa.
fn exponential(bytes: &mut [u8]) {
    for word in bytes.as_chunks_mut::<4>().0 {
        let stored = i32::from_le_bytes(*word);
        let (exponent, mantissa) = (stored >> 24, (stored << 8) >> 8);
        let power = f64::from_bits(((1023 + exponent) as u64) << 52);
        *word = ((f64::from(mantissa) * power) as f32).to_le_bytes();
    }
}

/// Decodes colours from luma, two differences, and alpha of one bit less, below a bit that marks the bit depth.
fn color(bytes: &mut [u8], width: Width) {
    let most = width.unsigned_one();
    each(bytes, width, |[y, co, cg, a]| {
        // Numbers are read as signed; luma and alpha are not.
        let [y, a] = [y, a].map(|v| if v < 0 { v + most as i32 + 1 } else { v });
        let one = (1 << (32 - a.leading_zeros())) - 1;
        let a = a & (one >> 1);
        let a = (a << 1) | (a & 1);
        let scale = most / f64::from(one.max(1));
        [y + co - cg, y + cg, y - co - cg, a].map(|v| nearest((f64::from(v) * scale).clamp(0.0, most)))
    });
}

/// Replaces each vector of four signed little-endian numbers.
fn each(bytes: &mut [u8], width: Width, decode: impl Fn([i32; 4]) -> [i32; 4]) {
    match width {
        Width::Byte => {
            for v in bytes.as_chunks_mut::<4>().0 {
                *v = decode(v.map(|b| i32::from(b as i8))).map(|n| n as u8);
            }
        }
        Width::Short => {
            for v in bytes.as_chunks_mut::<8>().0 {
                let [a, b, c, d] = [0, 2, 4, 6].map(|i| i32::from(i16::from_le_bytes([v[i], v[i + 1]])));
                let decoded = decode([a, b, c, d]).map(|n| (n as u16).to_le_bytes());
                v.copy_from_slice(decoded.as_flattened());
            }
        }
    }
}

/// Rounds to the nearest integer, halves away from zero.
fn nearest(v: f64) -> i32 {
    v.round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use gltf::json::deserialize::from_str;

    fn packed(stride: usize, count: usize, length: usize, mode: &str) -> Reason<Packed> {
        let json =
            format!(r#"{{"buffer":0,"byteLength":{length},"byteStride":{stride},"count":{count},{mode}}}"#);
        Packed::read(&from_str(&json).unwrap())
    }

    const ATTRIBUTES: &str = r#""mode":"ATTRIBUTES""#;

    /// Streams from the library's own encoder, of every possible vertex size.
    #[test]
    fn vertices_of_every_size() {
        fn round_trip<const N: usize>() {
            let vertex =
                |i: usize| Vertex::<N>(std::array::from_fn(|w| [i as u8, w as u8, (i * w) as u8, 7]));
            let vertices: Vec<Vertex<N>> = (0..300).map(vertex).collect();
            let bytes = meshopt::encode_vertex_buffer(&vertices).unwrap();
            let unpacked = packed(4 * N, 300, bytes.len(), ATTRIBUTES).unwrap().unpack(&bytes).unwrap();
            assert_eq!(unpacked, vertices.iter().flat_map(|v| v.0).flatten().collect::<Vec<u8>>(), "{N}");
        }
        round_trip::<1>();
        round_trip::<3>();
        round_trip::<17>();
        round_trip::<64>();
    }

    #[test]
    fn what_the_extension_forbids_is_refused() {
        let refused = [
            (3, 3, ATTRIBUTES),
            (260, 3, ATTRIBUTES),
            (0, 3, ATTRIBUTES),
            (4, 4, r#""mode":"TRIANGLES""#),
            (3, 3, r#""mode":"TRIANGLES""#),
            (8, 3, r#""mode":"INDICES""#),
            (4, 3, r#""mode":"INDICES","filter":"EXPONENTIAL""#),
            (12, 3, r#""mode":"ATTRIBUTES","filter":"OCTAHEDRAL""#),
            (4, 3, r#""mode":"ATTRIBUTES","filter":"QUATERNION""#),
            (16, 3, r#""mode":"ATTRIBUTES","filter":"COLOR""#),
            (4, 3, r#""mode":"ATTRIBUTES","filter":7"#),
            (4, 3, r#""mode":"LINES""#),
        ];
        for (stride, count, mode) in refused {
            assert!(packed(stride, count, 1000, mode).is_err(), "{stride} {count} {mode}");
        }
        let error = packed(16, 1 << 40, 1 << 20, ATTRIBUTES).unwrap_err();
        assert!(error.contains("cannot hold"), "{error}");
        assert!(packed(4, usize::MAX, 1000, ATTRIBUTES).is_err());
    }

    /// Vectors of four numbers in [−1, 1], the same in every run.
    fn vectors() -> Vec<[f32; 4]> {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0) as f32
        };
        (0..2000).map(|_| std::array::from_fn(|_| next())).collect()
    }

    fn units(parts: usize) -> Vec<[f32; 4]> {
        let unit = |v: [f32; 4]| {
            let length = v[..parts].iter().map(|x| x * x).sum::<f32>().sqrt();
            std::array::from_fn(|k| if k < parts { v[k] / length } else { 1.0 })
        };
        vectors().into_iter().map(unit).collect()
    }

    fn shorts(vectors: &[[i16; 4]]) -> Vec<u8> {
        vectors.iter().flatten().flat_map(|v| v.to_le_bytes()).collect()
    }

    fn from_shorts(bytes: &[u8]) -> Vec<i32> {
        bytes.as_chunks::<2>().0.iter().map(|b| i32::from(i16::from_le_bytes(*b))).collect()
    }

    fn assert_close(ours: impl IntoIterator<Item = i32>, theirs: impl IntoIterator<Item = i32>) {
        let (ours, theirs): (Vec<_>, Vec<_>) = (ours.into_iter().collect(), theirs.into_iter().collect());
        assert_eq!(ours.len(), theirs.len());
        let apart = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).max();
        assert!(apart <= Some(1), "{apart:?}");
    }

    #[test]
    fn meshoptimizer_agrees_to_one_unit() {
        for bits in [2, 5, 8] {
            let stored: Vec<[i8; 4]> = meshopt::encode_filter_oct(&units(3), bits);
            let (mut ours, mut theirs) =
                (stored.as_flattened().iter().map(|v| *v as u8).collect::<Vec<_>>(), stored);
            octahedral(&mut ours, Width::Byte);
            meshopt::decode_filter_oct(&mut theirs);
            assert_close(
                ours.iter().map(|v| i32::from(*v as i8)),
                theirs.iter().flatten().map(|v| i32::from(*v)),
            );
            let stored: Vec<[u8; 4]> = meshopt::encode_filter_color(&positive(), bits);
            let (mut ours, mut theirs) = (stored.as_flattened().to_vec(), stored);
            color(&mut ours, Width::Byte);
            meshopt::decode_filter_color(&mut theirs);
            assert_close(ours.iter().map(|v| i32::from(*v)), theirs.iter().flatten().map(|v| i32::from(*v)));
        }
        for bits in [4, 12, 16] {
            let mut theirs: Vec<[i16; 4]> = meshopt::encode_filter_oct(&units(3), bits);
            let mut ours = shorts(&theirs);
            octahedral(&mut ours, Width::Short);
            meshopt::decode_filter_oct(&mut theirs);
            assert_close(from_shorts(&ours), theirs.iter().flatten().map(|v| i32::from(*v)));
            let mut theirs = meshopt::encode_filter_quat(&units(4), bits);
            let mut ours = shorts(&theirs);
            quaternion(&mut ours);
            meshopt::decode_filter_quat(&mut theirs);
            assert_close(from_shorts(&ours), theirs.iter().flatten().map(|v| i32::from(*v)));
            let mut theirs: Vec<[u16; 4]> = meshopt::encode_filter_color(&positive(), bits);
            let mut ours: Vec<u8> = theirs.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
            color(&mut ours, Width::Short);
            meshopt::decode_filter_color(&mut theirs);
            let ours = from_shorts(&ours).into_iter().map(|v| i32::from(v as u16));
            assert_close(ours, theirs.iter().flatten().map(|v| i32::from(*v)));
        }
    }

    fn positive() -> Vec<[f32; 4]> {
        vectors().into_iter().map(|v| v.map(f32::abs)).collect()
    }

    #[test]
    fn floats_are_exact() {
        let mut theirs = meshopt::encode_filter_exp(&vectors(), 24, meshopt::EncodeExpMode::Separate);
        let mut ours: Vec<u8> = theirs.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        exponential(&mut ours);
        meshopt::decode_filter_exp(&mut theirs);
        assert_eq!(ours, theirs.iter().flatten().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
        // 2^−3 · 5, 2^2 · −9, and 2^−128, which is 2^21 times the smallest float.
        let mut bytes =
            [0xfd00_0005u32, 0x02ff_fff7, 0x8000_0001].map(u32::to_le_bytes).as_flattened().to_vec();
        exponential(&mut bytes);
        let floats: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(floats, [0.625, -36.0, f32::from_bits(1 << 21)]);
    }

    #[test]
    fn corners_of_the_octahedron() {
        let mut bytes = [127, 0, 127, 5, 0, 0, 127, 6, 0x81, 0, 127, 7, 127, 127, 127, 8];
        octahedral(&mut bytes, Width::Byte);
        // +x, +z, −x, and the corner of the square, which is −z.
        assert_eq!(bytes, [127, 0, 0, 5, 0, 0, 127, 6, 0x81, 0, 0, 7, 0, 0, 0x81, 8]);
    }

    /// Bytes that no encoder writes still decode to numbers.
    #[test]
    fn nonsense_is_survived() {
        for byte in [0u8, 1, 0x7f, 0x80, 0xff] {
            for width in [Width::Byte, Width::Short] {
                octahedral(&mut [byte; 24], width);
                color(&mut [byte; 24], width);
            }
            quaternion(&mut [byte; 24]);
            exponential(&mut [byte; 24]);
        }
    }
}
