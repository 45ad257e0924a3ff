//! Cube maps of `cmgen`: KTX 1 files of packed floats, 11 bits for red and green, 10 for blue.

use taotie_engine::math::Vec3;

/// One size of the cube map.
pub struct Cube {
    /// Texels along a side of a face.
    pub side: usize,
    /// Face by face, row by row.
    pub texels: Vec<Vec3<f64>>,
}

/// GL_R11F_G11F_B10F.
const PACKED: u32 = 0x8c3a;

/// Returns all sizes, largest first.
pub fn cubes(bytes: &[u8]) -> Vec<Cube> {
    assert!(bytes.starts_with(b"\xabKTX 11\xbb\r\n\x1a\n"), "the signature of KTX 1");
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    let field = |index: usize| word(12 + 4 * index);
    assert_eq!((field(0), field(4), field(10)), (0x0403_0201, PACKED, 6), "little endian, packed, six faces");
    let mut at = 64 + field(12) as usize;
    let mut cubes = Vec::new();
    for level in 0..field(11) {
        let (side, face_bytes) = ((field(6) >> level) as usize, word(at) as usize);
        assert_eq!(face_bytes, side * side * 4);
        let texel = |i: usize| unpacked(word(at + 4 + 4 * i));
        cubes.push(Cube { side, texels: (0..6 * side * side).map(texel).collect() });
        at += 4 + 6 * face_bytes;
    }
    cubes
}

fn unpacked(word: u32) -> Vec3<f64> {
    let float = |bits: u32, mantissa_bits: u32| {
        let (exponent, mantissa) = (bits >> mantissa_bits, f64::from(bits & ((1 << mantissa_bits) - 1)));
        let one = f64::from(1u32 << mantissa_bits);
        let power = |e: u32| f64::from(1u32 << e) / f64::from(1u32 << 15);
        if exponent == 0 { mantissa / one * power(1) } else { (1.0 + mantissa / one) * power(exponent) }
    };
    Vec3::new(float(word & 0x7ff, 6), float(word >> 11 & 0x7ff, 6), float(word >> 22, 5))
}

/// Returns the direction of texel `i`, in OpenGL's order and orientation of faces, and its solid angle.
pub fn direction(side: usize, i: usize) -> (Vec3<f64>, f64) {
    let at = |k: usize| (k as f64 + 0.5) / side as f64 * 2.0 - 1.0;
    let (s, t) = (at(i % side), at(i / side % side));
    let d = match i / (side * side) {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    };
    let squared = d.dot(d);
    (d.normalize(), 4.0 / (side * side) as f64 / (squared * squared.sqrt()))
}
