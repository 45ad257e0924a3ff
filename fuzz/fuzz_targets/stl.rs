//! STL files.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| taotie_fuzz::load("stl", bytes, &[]));
