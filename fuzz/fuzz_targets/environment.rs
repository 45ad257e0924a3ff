//! Environments as the cache keeps them, with the signature, the version and the sum made right, which no chance would.
#![no_main]

use taotie::shade::environment::{ENVIRONMENT_VERSION, Environment};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let sum = crc32fast::hash(data);
    let bytes = [b"taotie\0E", &ENVIRONMENT_VERSION.to_le_bytes()[..], &sum.to_le_bytes(), data].concat();
    if let Ok(environment) = Environment::from_bytes(&bytes) {
        assert!(environment.to_bytes() == bytes);
    }
});
