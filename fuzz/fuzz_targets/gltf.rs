//! glTF files, as JSON or binary: the reader goes by the first bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taotie_fuzz::load("gltf", bytes, &[]));
