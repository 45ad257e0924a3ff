//! MTL files, through a triangle whose material is `m`.
#![no_main]

const TRIANGLE: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut named = b"newmtl m\n".to_vec();
    named.extend_from_slice(bytes);
    taotie_fuzz::load("obj", TRIANGLE, &[("a.mtl", &named)]);
});
