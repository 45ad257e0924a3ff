//! A GLB file taken apart: its JSON and its bytes, as any program would read them.

use serde_json::Value;

/// A GLB file.
pub struct Glb {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Glb {
    /// Takes a file apart.
    pub fn read(file: &[u8]) -> Self {
        let length = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        let end = 20 + length(12);
        let json = serde_json::from_slice(&file[20..end]).expect("the first chunk is JSON");
        let bytes = file.get(end + 8..).map_or_else(Vec::new, <[u8]>::to_vec);
        Self { json, bytes }
    }

    /// Puts it together again.
    #[allow(dead_code, reason = "each test uses a part")]
    pub fn file(&self) -> Vec<u8> {
        let mut text = serde_json::to_vec(&self.json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = self.bytes.clone();
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let length = |length: usize| (length as u32).to_le_bytes();
        let head = [&b"glTF\x02\0\0\0"[..], &length(28 + text.len() + bytes.len())].concat();
        let json = [&length(text.len())[..], b"JSON", &text].concat();
        [head, json, length(bytes.len()).to_vec(), b"BIN\0".to_vec(), bytes].concat()
    }

    /// Returns the bytes of each accessor's elements, without padding, and its JSON except for the view.
    pub fn accessors(&self) -> Vec<(Value, Vec<u8>)> {
        let accessors = self.json["accessors"].as_array().expect("there are accessors");
        accessors.iter().map(|accessor| (said(accessor), self.elements(accessor))).collect()
    }

    fn elements(&self, accessor: &Value) -> Vec<u8> {
        let number = |of: &Value, name: &str| of[name].as_u64().unwrap_or(0) as usize;
        let view = &self.json["bufferViews"][number(accessor, "bufferView")];
        let width = match accessor["type"].as_str().expect("it has a type") {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let size = width
            * match number(accessor, "componentType") {
                5120 | 5121 => 1,
                5122 | 5123 => 2,
                _ => 4,
            };
        let (start, stride) =
            (number(view, "byteOffset") + number(accessor, "byteOffset"), number(view, "byteStride"));
        let stride = if stride == 0 { size } else { stride };
        let element = |i: usize| &self.bytes[start + i * stride..][..size];
        (0..number(accessor, "count")).flat_map(element).copied().collect()
    }
}

fn said(accessor: &Value) -> Value {
    let mut said = accessor.clone();
    said.as_object_mut().expect("it is an object").remove("bufferView");
    as_floats(&said)
}

/// Returns the same with all numbers as glTF readers store them, since text may differ in digits beyond float
/// precision.
pub fn as_floats(json: &Value) -> Value {
    match json {
        Value::Number(number) => Value::from(f64::from(number.as_f64().unwrap_or(0.0) as f32)),
        Value::Array(items) => items.iter().map(as_floats).collect(),
        Value::Object(members) => {
            Value::Object(members.iter().map(|(name, value)| (name.clone(), as_floats(value))).collect())
        }
        other => other.clone(),
    }
}

/// Asserts that a file has the same members as another to the last digit, such as its nodes and skins.
#[allow(dead_code, reason = "each test uses a part")]
pub fn assert_same(a: &Glb, b: &Glb, members: &[&str]) {
    for name in members {
        assert_eq!(as_floats(&a.json[name]), as_floats(&b.json[name]), "{name}");
    }
    let [a, b] = [a, b].map(Glb::accessors);
    assert!(a.len() <= b.len(), "accessors are gone");
    for (i, (a, b)) in a.iter().zip(&b).enumerate() {
        assert!(a == b, "accessor {i} differs: {} and {}", a.0, b.0);
    }
}
