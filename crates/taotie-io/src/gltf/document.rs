//! The container and its JSON: the content of a `.gltf` or `.glb` file before any validation.

#[cfg(feature = "draco")]
use super::draco;
use super::raw::{check_extensions, parsed_size, split};
use super::resources::{Buffers, Supplied, Supply};
use crate::json::{EXTRAS, as_integer, broken, parse_members, parse_tolerant};
use crate::reading::{Reading, Reason, no_such};
use crate::xmp;
use gltf::json::{self, Root, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::error::{Error, Result, Warnings};

/// A parsed file with its buffers.
pub(super) struct Document {
    /// The file.
    pub path: PathBuf,
    /// The limits on memory and file access, and the memory used so far.
    pub reading: Arc<Reading>,
    /// Its JSON; only the types in it have been checked.
    pub root: Root,
    /// Bytes of its JSON.
    pub json_bytes: u64,
    /// `GLB` or `glTF`.
    pub format: &'static str,
    /// The animations' JSON, whose types are checked channel by channel.
    pub animations: Vec<Value>,
    /// Its XMP packets, unmodified.
    pub xmp: Vec<Value>,
    /// The screen coverages that nodes specify for their levels of detail.
    pub coverages: Coverages,
    buffers: Buffers,
    supply: Supply,
}

impl Document {
    /// Reads the file and every buffer it refers to.
    pub fn open(reading: &Arc<Reading>, warnings: &mut Warnings) -> Result<Self> {
        let content = reading.read_own(reading.path())?;
        Self::of(reading, content, warnings)
    }

    /// Parses the content of the file, and reads every buffer it refers to.
    pub fn of(reading: &Arc<Reading>, content: Vec<u8>, warnings: &mut Warnings) -> Result<Self> {
        let path = reading.path();
        let (text, blob) = split(path, content)?;
        if !reading.take(parsed_size(&text, blob.is_some())) {
            reading.check()?;
        }
        let format = if blob.is_some() { "GLB" } else { "glTF" };
        let Parsed { root, animations, xmp, coverages } = parse(path, &text, warnings)?;
        let json_bytes = text.len() as u64;
        // Its memory is counted for the contents of data URIs.
        drop(text);
        check_extensions(path, &root, warnings)?;
        reading.check_nodes(root.nodes.len() as u64)?;
        let buffers = Buffers::load(reading, &root, blob.filter(|b| !b.is_empty()), warnings)?;
        #[cfg(feature = "draco")]
        let supply = draco::supply(&root, &buffers, reading, warnings);
        #[cfg(not(feature = "draco"))]
        let supply = Supply::new();
        let reading = Arc::clone(reading);
        Ok(Self {
            path: reading.path().to_path_buf(),
            reading,
            root,
            json_bytes,
            format,
            animations,
            xmp,
            coverages,
            buffers,
            supply,
        })
    }

    /// Returns an error at a place in this file.
    pub fn error(&self, at: impl Into<String>, what: impl Into<String>) -> Error {
        Error::parse(&self.path, at, what)
    }

    /// Returns the bytes of a buffer view and its stride, if it has one.
    pub fn view(&self, index: usize) -> Reason<(&[u8], Option<usize>)> {
        let view = self.root.buffer_views.get(index).ok_or_else(|| no_such("buffer view", index))?;
        Ok((self.buffers.view(index, view)?, view.byte_stride.map(|s| s.0)))
    }

    /// Returns the elements that replace those in the buffer view of accessor `index`, if any.
    pub fn supplied(&self, index: usize) -> Reason<Option<&Supplied>> {
        self.supply.get(&index).map(|supplied| supplied.as_ref().map_err(Clone::clone)).transpose()
    }

    /// Returns the number of bytes of all buffers, unpacked.
    pub fn total_bytes(&self) -> usize {
        let supplied = self.supply.values().flatten().map(|supplied| supplied.bytes.len());
        self.buffers.total_bytes() + supplied.sum::<usize>()
    }
}

/// The typed JSON, and the parts that are taken out of it.
struct Parsed {
    root: Root,
    /// The animations; an invalid one does not affect anything else.
    animations: Vec<Value>,
    /// The XMP packets as stored in the file.
    xmp: Vec<Value>,
    coverages: Coverages,
}

fn parse(path: &Path, text: &[u8], warnings: &mut Warnings) -> Result<Parsed> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let wrong = |e: &json::Error| broken(path, e);
    let (mut value, root) = match parse_directly(text) {
        Some((rest, root)) => (rest, Some(root)),
        // Something is wrong, or may be missing; the error is reported with its place.
        None => (json::deserialize::from_slice(text).map_err(|e| wrong(&e))?, None),
    };
    check_version(path, &value, warnings)?;
    let (xmp, coverages) = (xmp::packets(&value), coverages_of(&value));
    tidy(&mut value);
    let animations = value.as_object_mut().and_then(|root| root.remove(ANIMATIONS));
    let animations = match animations {
        Some(Value::Array(animations)) => animations,
        _ => Vec::new(),
    };
    let root = root.map_or_else(|| json::deserialize::from_value(value), Ok).map_err(|e| {
        // Parsing the text again gives the line of the error, which a value does not have.
        match json::deserialize::from_slice::<Root>(text) {
            Err(placed) => wrong(&placed),
            Ok(_) => wrong(&e),
        }
    })?;
    Ok(Parsed { root, animations, xmp, coverages })
}

/// Parses the text into its types, and the members that [`parse`] reads in another way into a value. `None` if this
/// needs more tolerance, or fails.
fn parse_directly(text: &[u8]) -> Option<(Value, Root)> {
    /// The members that are read from the value, and the one with the application data of nodes.
    const MEMBERS: [&str; 5] = ["asset", "extensions", "externalAssets", ANIMATIONS, "nodes"];
    let has_coverages = std::str::from_utf8(text).ok()?.contains(COVERAGE);
    let members = if has_coverages { &MEMBERS[..] } else { &MEMBERS[..MEMBERS.len() - 1] };
    let (rest, root) = rayon::join(|| parse_members(text, members), || parse_tolerant(text, ANIMATIONS));
    Some((rest.ok()?, root.ok()?))
}

/// The member of the document that holds its animations.
const ANIMATIONS: &str = "animations";

/// The member of a node's application data that holds the screen coverages of its levels (MSFT_screencoverage).
const COVERAGE: &str = "MSFT_screencoverage";

/// Rejects other versions than 2.0 and 2.1, and the part of 2.1 that is not read.
///
/// A file without `minVersion` can be read as 2.0 (glTF 2.0, 3.2). Of 2.1, shapes, bounding volumes and thumbnails do
/// not change a picture.
fn check_version(path: &Path, value: &Value, warnings: &mut Warnings) -> Result<()> {
    let asset = |key: &str| value.get("asset").and_then(|a| a.get(key)).and_then(Value::as_str);
    let version = asset("version")
        .ok_or_else(|| Error::parse(path, "asset", "asset.version is missing; is this glTF 2.0?"))?;
    let least = asset("minVersion");
    let unsupported = |what: &str, remedy: &str| {
        Err(Error::unsupported(format!("{}: {what}", path.display()), remedy.to_owned()))
    };
    if !version.starts_with("2.") || least.is_some_and(|least| !matches!(least, "2.0" | "2.1")) {
        return unsupported(
            &format!("glTF version {}", least.unwrap_or(version)),
            "save the model as glTF 2.0",
        );
    }
    let external = value.get("externalAssets").and_then(Value::as_array).map_or(0, Vec::len);
    if external > 0 && least == Some("2.1") {
        return unsupported("external assets of glTF 2.1", "merge them into one file");
    }
    warnings.note("skipped external assets of glTF 2.1", external);
    Ok(())
}

/// Makes the JSON as tolerant as other readers: integers written as `4.0`, scenes without nodes. Application data is
/// removed, since nothing below reads it.
fn tidy(root: &mut Value) {
    let scenes = root.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten();
    for scene in scenes.filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    tidy_value(root);
}

/// Tidies one value; the recursion depth is bounded by the JSON parser's own limit of 128.
fn tidy_value(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.remove(EXTRAS);
            members.values_mut().for_each(tidy_value);
        }
        Value::Array(items) => items.iter_mut().for_each(tidy_value),
        Value::Number(number) if number.is_f64() => {
            if let Some(integer) = number.as_f64().and_then(as_integer) {
                *value = Value::from(integer);
            }
        }
        _ => {}
    }
}

/// The screen coverages of the levels of nodes, by node index.
type Coverages = BTreeMap<usize, Vec<f32>>;

/// Returns the coverages in nodes' application data: the minimum screen coverage at which each of their levels is
/// shown (MSFT_screencoverage).
fn coverages_of(json: &Value) -> Coverages {
    let of_node = |node: &Value| -> Option<Vec<f32>> {
        let parts = node.get(EXTRAS)?.get(COVERAGE)?.as_array()?;
        let part =
            |part: &Value| part.as_f64().filter(|part| (0.0..=1.0).contains(part)).map(|part| part as f32);
        parts.iter().map(part).collect()
    };
    let nodes = json.get("nodes").and_then(Value::as_array).into_iter().flatten().enumerate();
    nodes.filter_map(|(number, node)| Some((number, of_node(node)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn error(bytes: &[u8]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.gltf");
        std::fs::write(&path, bytes).unwrap();
        let reading = Arc::new(Reading::new(&path, &Limits::default()));
        match Document::open(&reading, &mut Warnings::default()) {
            Ok(_) => String::new(),
            Err(e) => e.to_string(),
        }
    }

    #[test]
    fn containers_that_end_early_are_refused() {
        for length in 4..12 {
            assert!(!error(&b"glTF\x02\0\0\0\x0c\0\0\0"[..length]).is_empty());
        }
        assert!(error(b"glTF\x02\0\0\0\x0c\0\0\0").contains("JSON chunk"));
        assert!(error(b"glTF\x02\0\0\0\xff\0\0\0\xff\0\0\0JSON{}").contains("chunk at byte 12"));
        assert!(error(b"glTF\x01\0\0\0\xff\0\0\0\xff\0\0\0JSON{}").contains("version 1"));
    }

    #[test]
    fn versions_and_required_extensions() {
        assert!(error(b"{}").contains("asset.version"));
        assert!(error(br#"{"asset":{"version":"1.0"}}"#).contains("version 1.0"));
        assert!(error(br#"{"asset":{"version":"2.2","minVersion":"2.2"}}"#).contains("version 2.2"));
        assert_eq!(error(br#"{"asset":{"version":"2.1","minVersion":"2.1"},"scenes":[{}]}"#), "");
        let external = br#"{"asset":{"version":"2.1","minVersion":"2.1"},"externalAssets":[{"file":0}]}"#;
        assert!(error(external).contains("external assets"));
        let required = br#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_texture_nobody"]}"#;
        assert!(error(required).contains("KHR_texture_nobody"));
        assert_eq!(
            error(b"\xef\xbb\xbf{\"asset\":{\"version\":\"2.0\",\"extras\":[1.5]},\"scenes\":[{}]}"),
            ""
        );
    }

    #[test]
    fn direct_parsing_equals_that_through_a_value() {
        let read = |scene: &str| {
            let text = format!(
                r#"{{"asset":{{"version":"2.0","extras":[]}},"scenes":[{scene}],"nodes":[{{"mesh":0.0,
                "extras":{{"MSFT_screencoverage":[0.5,0.1]}}}}],"materials":[{{"pbrMetallicRoughness":
                {{"roughnessFactor":1.0}},"extensions":{{"X":{{"animations":[4.0],"extras":1}}}},"extras":{{}}}}],
                "animations":[{{"channels":7}}],"extensions":{{"KHR_xmp_json_ld":{{"packets":[{{"a":1}}]}}}}}}"#
            );
            let is_direct = parse_directly(text.as_bytes()).is_some();
            let parsed = parse(Path::new("m.gltf"), text.as_bytes(), &mut Warnings::default()).unwrap();
            let Parsed { root, animations, xmp, coverages } = parsed;
            (is_direct, serde_json::json!([root, animations, xmp]), coverages)
        };
        let (direct, of_value) = (read(r#"{"nodes":[]}"#), read("{}"));
        assert!(direct.0 && !of_value.0, "a scene without nodes needs more tolerance");
        assert_eq!((&direct.1, &direct.2), (&of_value.1, &of_value.2));
        assert_eq!(direct.2.len(), 1);
        let material = &direct.1[0]["materials"][0]["extensions"]["X"];
        assert_eq!(material, &serde_json::json!({ "animations": [4] }));
    }

    #[test]
    fn json_errors_tell_the_line() {
        assert!(error(b"{\"asset\":{\"version\":\"2.0\"},\n\"meshes\":[{}]}").contains("line 2"));
        assert!(error(b"{\"asset\":\n,}").contains("line 2"));
        assert!(error(&[b"[".repeat(100_000).as_slice()].concat()).contains("recursion"));
    }
}
