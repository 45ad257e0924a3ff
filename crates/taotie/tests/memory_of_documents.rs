//! The memory estimate of a glTF file with its bytes in `data:` URIs, compared with the memory it takes. The peak is
//! that of the process, so this file has one test.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use taotie::{Bytes, Limits};
use taotie_io::load_model_within;

/// Three corners, 36 bytes, as Base64.
const CORNERS: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
/// Letters of the large URI.
const LETTERS: u64 = 48 << 20;

/// Writes a triangle together with a large buffer.
fn write(path: &Path) {
    let mut file = BufWriter::new(File::create(path).unwrap());
    let start = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"#;
    let content = LETTERS / 4 * 3;
    write!(file, "{start}\"buffers\":[{{\"byteLength\":36,\"uri\":\"data:;base64,{CORNERS}\"}},").unwrap();
    write!(file, "{{\"byteLength\":{content},\"uri\":\"data:;base64,").unwrap();
    (0..LETTERS >> 10).for_each(|_| file.write_all(&[b'A'; 1 << 10]).unwrap());
    write!(file, "\"}}]}}").unwrap();
}

/// Returns this process's peak memory so far; `None` if the system does not report it.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}

#[test]
fn data_uris_take_what_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.gltf");
    write(&path);
    let loads = |memory: u64| {
        let limits = Limits { memory: Some(Bytes(memory)), ..Limits::default() };
        load_model_within(&path, &limits).is_ok()
    };
    let before = peak();
    let (mut too_little, mut said) = (0, 20 * LETTERS);
    assert!(loads(said));
    while said - too_little > 1 << 20 {
        let middle = said.midpoint(too_little);
        match loads(middle) {
            true => said = middle,
            false => too_little = middle,
        }
    }
    let (Some(before), Some(after)) = (before, peak()) else { return };
    let taken = after - before;
    assert!(taken <= said, "{taken} bytes taken, {said} estimated");
    assert!(taken * 2 >= said, "{taken} bytes taken, {said} estimated");
}
