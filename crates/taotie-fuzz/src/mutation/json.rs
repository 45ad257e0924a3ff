//! Changes of JSON, standalone or inside a GLB: numbers, references, names, and size.

use fastrand::Rng;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The most values and characters of a repeated value.
const MOST: usize = 1 << 16;
/// The most values listed when choosing one.
const MOST_LISTED: usize = 4096;

/// Names from glTF, one that points out of the folder, and text that terminals interpret as commands.
const NAMES: [&str; 22] = [
    "",
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT2",
    "MAT4",
    "POSITION",
    "NORMAL",
    "TANGENT",
    "TEXCOORD_0",
    "JOINTS_0",
    "LINEAR",
    "STEP",
    "CUBICSPLINE",
    "translation",
    "rotation",
    "weights",
    "MASK",
    "BLEND",
    "../a.png",
    "\u{1b}[31m\n",
];

/// Enumerations of glTF: component types, primitive modes, targets, filters, wraps.
const CODES: [u64; 16] =
    [5120, 5121, 5122, 5123, 5124, 5125, 5126, 5127, 34962, 34963, 9728, 9729, 9987, 10497, 33071, 33648];

/// A change of JSON. `at` is a JSON pointer (RFC 6901); a pointer to a missing value is ignored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JsonChange {
    /// Replaces a value.
    Set {
        /// Its position.
        at: String,
        /// The value.
        value: Value,
    },
    /// Overwrites a value with a copy of another.
    Copy {
        /// The position of the value to copy.
        from: String,
        /// The position that is overwritten.
        to: String,
    },
    /// Removes a value.
    Remove {
        /// Its position.
        at: String,
    },
    /// Repeats a string, or the elements of an array.
    Repeat {
        /// Its position.
        at: String,
        /// The total number of repetitions.
        times: usize,
    },
    /// Wraps a value in arrays.
    Nest {
        /// Its position.
        at: String,
        /// Their number.
        depth: u8,
    },
}

impl JsonChange {
    /// Chooses a change; `None` if the file contains no JSON.
    pub fn choose(rng: &mut Rng, bytes: &[u8]) -> Option<Self> {
        let json = Document::of(bytes)?.json;
        let mut places = Vec::new();
        list(&json, String::new(), &mut places);
        let at = rng.choice(&places)?.clone();
        let old = json.pointer(&at)?;
        Some(match rng.u8(..12) {
            0 => Self::Remove { at },
            1 => Self::Copy { from: rng.choice(&places)?.clone(), to: at },
            2 if old.is_array() || old.is_string() => Self::Repeat { at, times: 1 << rng.u32(..17) },
            3 => Self::Nest { at, depth: rng.u8(1..200) },
            _ => Self::Set { value: other(rng, old), at },
        })
    }

    /// Applies the change to the JSON in `bytes`.
    pub fn apply(&self, bytes: &mut Vec<u8>) {
        let Some(mut document) = Document::of(bytes) else { return };
        if self.change(&mut document.json).is_some() {
            *bytes = document.bytes();
        }
    }

    fn change(&self, json: &mut Value) -> Option<()> {
        match self {
            Self::Set { at, value } => *json.pointer_mut(at)? = value.clone(),
            Self::Copy { from, to } => {
                let copied = json.pointer(from)?.clone();
                *json.pointer_mut(to)? = copied;
            }
            Self::Remove { at } => remove(json, at)?,
            Self::Repeat { at, times } => repeat(json.pointer_mut(at)?, *times),
            Self::Nest { at, depth } => {
                let place = json.pointer_mut(at)?;
                *place = (0..*depth).fold(place.take(), |inner, _| Value::Array(vec![inner]));
            }
        }
        Some(())
    }
}

/// Lists the positions of `json` and of all values in it.
fn list(json: &Value, at: String, places: &mut Vec<String>) {
    if places.len() >= MOST_LISTED {
        return;
    }
    match json {
        Value::Array(values) => {
            values.iter().enumerate().for_each(|(i, value)| list(value, format!("{at}/{i}"), places));
        }
        Value::Object(members) => {
            let key = |key: &str| key.replace('~', "~0").replace('/', "~1");
            members.iter().for_each(|(name, value)| list(value, format!("{at}/{}", key(name)), places));
        }
        _ => {}
    }
    places.push(at);
}

/// Removes the value at `at` from its array or object.
fn remove(json: &mut Value, at: &str) -> Option<()> {
    let (parent, key) = at.rsplit_once('/')?;
    match json.pointer_mut(parent)? {
        Value::Array(values) => {
            let index = key.parse::<usize>().ok().filter(|index| *index < values.len())?;
            values.remove(index);
        }
        Value::Object(members) => drop(members.remove(&key.replace("~1", "/").replace("~0", "~"))),
        _ => {}
    }
    Some(())
}

/// Repeats a string, or the elements of an array, up to a bearable size.
fn repeat(value: &mut Value, times: usize) {
    let fitting = |length: usize| times.min(MOST / length.max(1));
    match value {
        Value::String(text) => *text = text.repeat(fitting(text.len())),
        Value::Array(values) => {
            let times = fitting(values.iter().map(size).sum());
            *values = std::iter::repeat_n(values.clone(), times).flatten().collect();
        }
        _ => {}
    }
}

/// Counts the values and characters of a value.
fn size(value: &Value) -> usize {
    match value {
        Value::String(text) => text.len().max(1),
        Value::Array(values) => 1 + values.iter().map(size).sum::<usize>(),
        Value::Object(members) => {
            1 + members.iter().map(|(name, value)| name.len() + size(value)).sum::<usize>()
        }
        _ => 1,
    }
}

/// Chooses a replacement for `old`, usually of the same type.
fn other(rng: &mut Rng, old: &Value) -> Value {
    match old {
        Value::Number(_) if rng.u8(..16) > 0 => number(rng, old),
        Value::String(_) if rng.u8(..16) > 0 => json!(rng.choice(NAMES)),
        Value::Bool(old) if rng.u8(..16) > 0 => json!(!old),
        _ => match rng.u8(..5) {
            0 => Value::Null,
            1 => json!([]),
            2 => json!({}),
            3 => json!(rng.choice(NAMES)),
            _ => number(rng, old),
        },
    }
}

/// Chooses a number: a meaningful one, one near the old one, or one at the end of some range.
fn number(rng: &mut Rng, old: &Value) -> Value {
    let was = old.as_u64().unwrap_or(1);
    match rng.u8(..8) {
        0 => json!(rng.choice(CODES)),
        1 => json!(rng.u64(..17)),
        2 => json!(was.wrapping_add(1)),
        3 => json!(was.wrapping_sub(1)),
        4 => json!(was.wrapping_mul(rng.u64(2..9))),
        5 => json!(super::bytes::extreme(rng)),
        6 => json!((super::bytes::extreme(rng) as i64).wrapping_neg()),
        _ => {
            // Numbers that every JSON parser reads to the same bits.
            let huge = [0.5, -0.5, 1e-22, -1e-22, 1e10, 1e19, 1e20, 1e37, 1e38, 1e39, 1e154, 1e308, -1e308];
            json!(rng.choice(huge))
        }
    }
}

/// The bytes of a GLB before its JSON: its own header, and that of the chunk.
const HEADER: usize = 20;

/// A file with its parsed JSON, and what follows it.
struct Document {
    /// The JSON.
    json: Value,
    /// The rest of a GLB after the JSON; `None` for a file that is only JSON.
    rest: Option<Vec<u8>>,
}

impl Document {
    /// Parses a file; `None` if it contains no JSON.
    fn of(bytes: &[u8]) -> Option<Self> {
        if !bytes.starts_with(b"glTF") {
            let is_json = matches!(bytes.trim_ascii_start().first(), Some(b'{' | b'['));
            let json = is_json.then(|| serde_json::from_slice(bytes).ok())??;
            return Some(Self { json, rest: None });
        }
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        let (text, rest) = bytes.get(HEADER..)?.split_at_checked(length)?;
        Some(Self { json: serde_json::from_slice(text).ok()?, rest: Some(rest.to_vec()) })
    }

    /// Returns the file.
    fn bytes(&self) -> Vec<u8> {
        let mut text = self.json.to_string().into_bytes();
        let Some(rest) = &self.rest else { return text };
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = |length: usize| (length as u32).to_le_bytes();
        let all = length(HEADER + text.len() + rest.len());
        [b"glTF\x02\0\0\0", &all[..], &length(text.len()), b"JSON", &text, rest].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_change_does_what_it_says() {
        let changed = |change: JsonChange| {
            let mut bytes = br#"{"a":[1,2],"b":"xy","c/d":{"e":3}}"#.to_vec();
            change.apply(&mut bytes);
            serde_json::from_slice::<Value>(&bytes).unwrap()
        };
        let at = |at: &str| at.to_owned();
        assert_eq!(changed(JsonChange::Set { at: at("/a/1"), value: json!(9) })["a"], json!([1, 9]));
        assert_eq!(
            changed(JsonChange::Copy { from: at("/b"), to: at("/c~1d/e") })["c/d"],
            json!({ "e": "xy" })
        );
        assert_eq!(changed(JsonChange::Remove { at: at("/c~1d") }), json!({ "a": [1, 2], "b": "xy" }));
        assert_eq!(changed(JsonChange::Remove { at: at("/a/0") })["a"], json!([2]));
        assert_eq!(changed(JsonChange::Repeat { at: at("/b"), times: 3 })["b"], "xyxyxy");
        assert_eq!(changed(JsonChange::Repeat { at: at("/a"), times: 2 })["a"], json!([1, 2, 1, 2]));
        assert_eq!(changed(JsonChange::Nest { at: at("/b"), depth: 2 })["b"], json!([["xy"]]));
        assert_eq!(changed(JsonChange::Remove { at: at("/z/0") })["b"], "xy", "missing values are ignored");
    }

    #[test]
    fn what_is_repeated_again_and_again_stays_small() {
        let mut bytes = br#"{"a":["x"]}"#.to_vec();
        for at in ["/a/0", "/a", "/a", "/a/0"] {
            JsonChange::Repeat { at: at.to_owned(), times: MOST }.apply(&mut bytes);
        }
        assert!(bytes.len() < 2 * MOST, "{} bytes", bytes.len());
    }

    #[test]
    fn every_value_has_a_place() {
        let (json, mut places) = (json!({ "a/b": [1, { "~": 2 }] }), Vec::new());
        list(&json, String::new(), &mut places);
        assert_eq!(places.len(), 5);
        assert!(places.iter().all(|at| json.pointer(at).is_some()), "{places:?}");
    }

    #[test]
    fn json_is_read_from_either_form_and_written_back() {
        for rest in [None, Some(b"\x04\0\0\0BIN\0abcd".to_vec())] {
            let bytes = Document { json: json!({ "a": [1, 2] }), rest: rest.clone() }.bytes();
            let mut document = Document::of(&bytes).unwrap();
            assert_eq!((document.json["a"][1].as_u64(), &document.rest), (Some(2), &rest));
            document.json["a"] = json!("longer than before");
            let bytes = document.bytes();
            assert_eq!(Document::of(&bytes).unwrap().json, document.json);
            if rest.is_some() {
                assert_eq!(bytes[8..12], (bytes.len() as u32).to_le_bytes());
            }
        }
        assert!(Document::of(b"v 0 0 0").is_none() && Document::of(b"glTF").is_none());
    }
}
