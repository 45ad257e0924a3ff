//! The container and its JSON: what a `.gltf` or `.glb` file holds before any of it is believed.

use super::uri;
use crate::error::{Error, Result, Warnings};
use crate::io::file;
use gltf::json::{self, Root, Value};
use std::path::{Path, PathBuf};

/// Why something cannot be read; the caller knows where in the file that is.
pub(super) type Reason<T> = std::result::Result<T, String>;

/// Extensions whose meaning is drawn.
const SUPPORTED: [&str; 12] = [
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_clearcoat",
    "KHR_materials_anisotropy",
    "KHR_materials_sheen",
    "KHR_materials_variants",
    "EXT_texture_webp",
];

/// Extensions that do not change a picture with the default materials; the channels of KHR_animation_pointer are left
/// out with a warning of their own.
const WITHOUT_EFFECT: [&str; 3] = ["KHR_xmp", "KHR_xmp_json_ld", "KHR_animation_pointer"];

/// A parsed file with its buffers.
pub(super) struct Document {
    /// The file.
    pub path: PathBuf,
    /// Its JSON; nothing in it is checked beyond its types.
    pub root: Root,
    /// `GLB` or `glTF`.
    pub format: &'static str,
    /// The animations' JSON, whose types are checked channel by channel.
    pub animations: Vec<Value>,
    /// The bytes of each buffer; `None` for one that has no source.
    buffers: Vec<Option<Vec<u8>>>,
}

impl Document {
    /// Reads `path` and every buffer it names.
    pub fn open(path: &Path, warnings: &mut Warnings) -> Result<Self> {
        let (text, blob) = split(path, file::read(path)?)?;
        let format = if blob.is_some() { "GLB" } else { "glTF" };
        let (root, animations) = parse(path, &text)?;
        check_extensions(path, &root, warnings)?;
        let mut document = Self { path: path.to_path_buf(), root, format, animations, buffers: Vec::new() };
        document.load_buffers(blob.filter(|b| !b.is_empty()), warnings)?;
        Ok(document)
    }

    /// An error at a place in this file.
    pub fn error(&self, at: impl Into<String>, what: impl Into<String>) -> Error {
        Error::parse(&self.path, at, what)
    }

    /// The folder that relative names start from.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The bytes of a buffer view and its stride, where it has one.
    pub fn view(&self, index: usize) -> Reason<(&[u8], Option<usize>)> {
        let view = self.root.buffer_views.get(index).ok_or_else(|| no_such("buffer view", index))?;
        let buffer = view.buffer.value();
        let bytes = self
            .buffers
            .get(buffer)
            .ok_or_else(|| no_such("buffer", buffer))?
            .as_ref()
            .ok_or_else(|| format!("buffer {buffer} has no data, only what an extension would fill"))?;
        let start = view.byte_offset.map_or(0, |o| o.0);
        let end = start.checked_add(view.byte_length.0).filter(|end| *end <= bytes.len() as u64);
        let end = end.ok_or_else(|| {
            format!(
                "buffer view {index} ends at byte {}, but buffer {buffer} has {}",
                start.saturating_add(view.byte_length.0),
                bytes.len()
            )
        })?;
        Ok((&bytes[start as usize..end as usize], view.byte_stride.map(|s| s.0)))
    }

    /// How many bytes all buffers have.
    pub fn total_bytes(&self) -> usize {
        self.buffers.iter().flatten().map(Vec::len).sum()
    }

    fn load_buffers(&mut self, mut blob: Option<Vec<u8>>, warnings: &mut Warnings) -> Result<()> {
        for (i, buffer) in self.root.buffers.iter().enumerate() {
            let at = || format!("buffer {i}");
            let bytes = match &buffer.uri {
                Some(name) => Some(self.load_buffer(name, &at())?),
                None if i == 0 => blob.take(),
                None => None,
            };
            if let Some(bytes) = &bytes
                && (bytes.len() as u64) < buffer.byte_length.0
            {
                warnings.note(format!("buffer {i} has {} bytes, fewer than declared", bytes.len()), 1);
            }
            self.buffers.push(bytes);
        }
        Ok(())
    }

    fn load_buffer(&self, name: &str, at: &str) -> Result<Vec<u8>> {
        let short = uri::shortened(name);
        match uri::locate(name, self.folder()) {
            Ok(uri::Source::Data { bytes, .. }) => Ok(bytes),
            Ok(uri::Source::File(path)) if path.exists() => file::read(&path),
            Ok(uri::Source::File(path)) => {
                let what = format!("the file '{short}' is missing; put it at {}", path.display());
                Err(self.error(at, what))
            }
            Err(why) => Err(self.error(at, format!("'{short}': {why}"))),
        }
    }
}

/// The usual words for an index out of range.
pub(super) fn no_such(what: &str, index: usize) -> String {
    format!("it names {what} {index}, which does not exist")
}

/// The JSON text and, for GLB, the binary chunk (empty where there is none).
fn split(path: &Path, mut bytes: Vec<u8>) -> Result<(Vec<u8>, Option<Vec<u8>>)> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let version = little_endian(&bytes, 4).ok_or_else(|| truncated(path, "header"))?;
    if version != 2 {
        return Err(Error::unsupported(
            format!("{}: GLB container version {version}", path.display()),
            "save the model as glTF 2.0",
        ));
    }
    let mut at = 12;
    let mut json = None;
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (little_endian(&bytes, at), bytes.get(at + 4..at + 8)) else {
            return Err(truncated(path, &format!("chunk header at byte {at}")));
        };
        let (start, end) = (at + 8, at + 8 + length as usize);
        if end > bytes.len() {
            return Err(truncated(path, &format!("chunk at byte {at}")));
        }
        match (kind, &json) {
            (b"JSON", None) => json = Some(bytes[start..end].to_vec()),
            (b"BIN\0", Some(_)) => {
                bytes.truncate(end);
                bytes.drain(..start);
                return Ok((json.unwrap_or_default(), Some(bytes)));
            }
            (_, None) => return Err(Error::parse(path, "GLB container", "its first chunk is not JSON")),
            _ => {}
        }
        at = end;
    }
    let json = json.ok_or_else(|| truncated(path, "JSON chunk"))?;
    Ok((json, Some(Vec::new())))
}

fn truncated(path: &Path, what: &str) -> Error {
    Error::parse(path, "GLB container", format!("the file ends inside its {what}; fetch it again"))
}

fn little_endian(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

/// The typed JSON, and the animations, which are taken out of it so that a wrong one harms nothing else.
fn parse(path: &Path, text: &[u8]) -> Result<(Root, Vec<Value>)> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let wrong = |e: &json::Error| Error::parse(path, "JSON", e.to_string());
    let mut value: Value = json::deserialize::from_slice(text).map_err(|e| wrong(&e))?;
    check_version(path, &value)?;
    tidy(&mut value);
    let animations = value.as_object_mut().and_then(|root| root.remove("animations"));
    let animations = match animations {
        Some(Value::Array(animations)) => animations,
        _ => Vec::new(),
    };
    let root = json::deserialize::from_value(value).map_err(|e| {
        // Parsing the text again tells the line, which a value does not know.
        match json::deserialize::from_slice::<Root>(text) {
            Err(placed) => wrong(&placed),
            Ok(_) => wrong(&e),
        }
    })?;
    Ok((root, animations))
}

fn check_version(path: &Path, value: &Value) -> Result<()> {
    let asset = |key: &str| value.get("asset").and_then(|a| a.get(key)).and_then(Value::as_str);
    let version = asset("version")
        .ok_or_else(|| Error::parse(path, "asset", "there is no asset.version; is this glTF 2.0?"))?;
    let needed = asset("minVersion").unwrap_or(version);
    if !version.starts_with("2.") || (needed != "2.0" && asset("minVersion").is_some()) {
        return Err(Error::unsupported(
            format!("{}: glTF version {needed}", path.display()),
            "save the model as glTF 2.0",
        ));
    }
    Ok(())
}

/// Accepts what other readers accept: whole numbers written as `4.0`, scenes without nodes. Application data goes,
/// since nothing here reads it.
fn tidy(root: &mut Value) {
    let scenes = root.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten();
    for scene in scenes.filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    tidy_value(root);
}

/// The depth of the recursion is bounded by the JSON parser's own limit of 128.
fn tidy_value(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.remove("extras");
            members.values_mut().for_each(tidy_value);
        }
        Value::Array(items) => items.iter_mut().for_each(tidy_value),
        Value::Number(number) if number.is_f64() => {
            if let Some(v) = number.as_f64().filter(|v| *v >= 0.0 && *v < 9e15 && v.floor() == *v) {
                *value = Value::from(v as u64);
            }
        }
        _ => {}
    }
}

fn check_extensions(path: &Path, root: &Root, warnings: &mut Warnings) -> Result<()> {
    let known =
        |name: &&String| SUPPORTED.contains(&name.as_str()) || WITHOUT_EFFECT.contains(&name.as_str());
    if let Some(name) = root.extensions_required.iter().find(|name| !known(name)) {
        return Err(Error::unsupported(
            format!("{}: the required extension {name}", path.display()),
            "save the model without it",
        ));
    }
    for name in root.extensions_used.iter().filter(|name| !known(name)) {
        warnings.note(format!("the extension {name} is ignored"), 1);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(bytes: &[u8]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.gltf");
        std::fs::write(&path, bytes).unwrap();
        match Document::open(&path, &mut Warnings::default()) {
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
        assert!(error(br#"{"asset":{"version":"2.0","minVersion":"2.1"}}"#).contains("version 2.1"));
        let required = br#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
        assert!(error(required).contains("KHR_draco_mesh_compression"));
        assert_eq!(
            error(b"\xef\xbb\xbf{\"asset\":{\"version\":\"2.0\",\"extras\":[1.5]},\"scenes\":[{}]}"),
            ""
        );
    }

    #[test]
    fn json_errors_tell_the_line() {
        assert!(error(b"{\"asset\":{\"version\":\"2.0\"},\n\"meshes\":[{}]}").contains("line 2"));
        assert!(error(b"{\"asset\":\n,}").contains("line 2"));
        assert!(error(&[b"[".repeat(100_000).as_slice()].concat()).contains("recursion"));
    }
}
