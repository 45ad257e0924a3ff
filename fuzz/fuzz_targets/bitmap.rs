//! Pictures of every format: the reader goes by the first bytes, and for TGA by the name.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for name in ["a.png", "a.tga"] {
        let _ = taotie::io::decode_bitmap(bytes, name, Path::new(name));
    }
});
