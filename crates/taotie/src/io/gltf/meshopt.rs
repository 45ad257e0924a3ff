//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views packed by meshoptimizer.
//!
//! The decoders do not check sizes, so all requirements of the extension are checked first.

use super::filters::{self, Width};
use super::reason::Reason;
use gltf::json::Value;
use gltf::json::buffer::{Buffer, View};

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
    let Some(extensions) = &buffer.extensions else { return false };
    let flag = |name| extensions.others.get(name)?.get("fallback")?.as_bool();
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
            Filter::Octahedral => filters::octahedral(bytes, width),
            Filter::Quaternion => filters::quaternion(bytes),
            Filter::Exponential => filters::exponential(bytes),
            Filter::Color => filters::color(bytes, width),
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
}
