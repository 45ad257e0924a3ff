//! The images of a glTF file as stored: their uses and the hashes of their bytes, without decoding them.

use super::raw::RawGltf;
use super::source::GltfSource;
use super::uri::{self, ByteSource};
use crate::error::Result;
use crate::io::file::sha256_of;
use crate::io::limits::Limits;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// An image as stored in a glTF file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredImage {
    /// The material properties that read it, such as `normal`; empty if there are none.
    pub uses: Vec<String>,
    /// Its file; `None` if it is embedded.
    pub file: Option<PathBuf>,
    /// The length and the SHA-256 of its stored bytes; `None` if they are missing.
    pub bytes: Option<(u64, String)>,
}

/// The parts of a glTF file that are files or images.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StoredParts {
    /// The files of its buffers.
    pub buffers: Vec<PathBuf>,
    /// Its images, in order.
    pub images: Vec<StoredImage>,
    /// The name and file of each map that its extras list next to it.
    pub maps_beside: Vec<(String, PathBuf)>,
}

impl StoredParts {
    /// Reads the parts of a `.gltf` or `.glb` file.
    ///
    /// # Errors
    /// Those of reading it.
    pub fn read(path: &Path, limits: &Limits) -> Result<Self> {
        let raw = RawGltf::read(GltfSource::File(path), limits)?;
        let images = items(&raw.json, "images").enumerate();
        Ok(Self {
            buffers: items(&raw.json, "buffers").filter_map(|buffer| file_of(&raw, buffer)).collect(),
            images: images.map(|(i, image)| stored(&raw, i, image)).collect::<Result<_>>()?,
            maps_beside: maps_beside(&raw.json, path),
        })
    }
}

fn items<'a>(of: &'a Value, name: &str) -> impl Iterator<Item = &'a Value> {
    of.get(name).and_then(Value::as_array).into_iter().flatten()
}

fn file_of(raw: &RawGltf, item: &Value) -> Option<PathBuf> {
    uri::file(item.get("uri")?.as_str()?, raw.reading())
}

fn stored(raw: &RawGltf, number: usize, image: &Value) -> Result<StoredImage> {
    let bytes = image_bytes(raw, image)?.map(|bytes| (bytes.len() as u64, sha256_of(&bytes)));
    Ok(StoredImage { uses: uses(&raw.json, number), file: file_of(raw, image), bytes })
}

/// Returns the stored bytes of an image; `None` if they are missing.
///
/// # Errors
/// [`crate::Error::Io`] if a file exists but cannot be read, [`crate::Error::Limit`] if it does not fit in memory.
pub(in crate::io) fn image_bytes(raw: &RawGltf, image: &Value) -> Result<Option<Vec<u8>>> {
    match image.get("uri").and_then(Value::as_str) {
        Some(uri) => match uri::locate(uri, raw.reading()) {
            Ok(ByteSource::Data { bytes, .. }) => Ok(Some(bytes)),
            _ => raw.file(uri),
        },
        None => Ok(image.get("bufferView").and_then(|view| view_bytes(raw, view))),
    }
}

fn view_bytes(raw: &RawGltf, view: &Value) -> Option<Vec<u8>> {
    let view = raw.json.get("bufferViews")?.get(view.as_u64()? as usize)?;
    let number = |name: &str| view.get(name).and_then(Value::as_u64).map(|value| value as usize);
    let buffer = raw.buffers.get(number("buffer")?)?.as_ref()?;
    let start = number("byteOffset").unwrap_or(0);
    buffer.get(start..start.checked_add(number("byteLength")?)?).map(<[u8]>::to_vec)
}

/// Returns the material properties that read an image, such as `base color`, in file order, each once.
pub(in crate::io) fn uses(json: &Value, image: usize) -> Vec<String> {
    let textures: Vec<bool> = items(json, "textures").map(|texture| shows(texture, image)).collect();
    let mut found = Vec::new();
    for material in items(json, "materials") {
        collect_uses(material, &textures, &mut found);
    }
    found
}

/// Returns `true` if a texture has this image as its source, or as the source in an extension.
fn shows(texture: &Value, image: usize) -> bool {
    let is_it = |of: &Value| of.get("source").and_then(Value::as_u64) == Some(image as u64);
    let extensions = texture.get("extensions").and_then(Value::as_object);
    is_it(texture) || extensions.is_some_and(|all| all.values().any(is_it))
}

/// Adds the names of members such as `normalTexture` that read one of the textures. The depth is bounded by the JSON
/// parser's limit of 128.
fn collect_uses(of: &Value, textures: &[bool], found: &mut Vec<String>) {
    let Some(members) = of.as_object() else { return };
    for (name, value) in members {
        let index = value.get("index").and_then(Value::as_u64).map(|index| index as usize);
        match name.strip_suffix("Texture").zip(index) {
            Some((role, index)) if textures.get(index) == Some(&true) => {
                let role = words(role);
                if !found.contains(&role) {
                    found.push(role);
                }
            }
            _ => collect_uses(value, textures, found),
        }
    }
}

/// Returns a name such as `baseColor` as separate words: `base color`.
fn words(name: &str) -> String {
    let letter =
        |c: char| if c.is_ascii_uppercase() { format!(" {}", c.to_ascii_lowercase()) } else { c.into() };
    name.chars().map(letter).collect()
}

/// Returns the maps listed in the extras of `asset`, as a bake writes them.
fn maps_beside(json: &Value, path: &Path) -> Vec<(String, PathBuf)> {
    let maps = json.pointer("/asset/extras/maps").and_then(Value::as_object);
    let folder = path.parent().unwrap_or(Path::new(""));
    let map_of = |(name, about): (&String, &Value)| {
        // Only the file name: nothing outside the model's own folder is opened.
        let file = Path::new(about.get("file")?.as_str()?).file_name()?;
        Some((name.clone(), folder.join(file)))
    };
    maps.into_iter().flatten().filter_map(map_of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn images_are_hashed_as_they_are_stored() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.gltf");
        std::fs::write(folder.path().join("c.png"), b"abc").unwrap();
        let document = json!({
            "asset": { "version": "2.0", "extras": { "maps": { "height": { "file": "../m.height.png" } } } },
            "buffers": [{ "uri": "data:;base64,AAFhYmM=", "byteLength": 5 }],
            "bufferViews": [{ "buffer": 0, "byteOffset": 2, "byteLength": 3 }, { "buffer": 0, "byteLength": 9 }],
            "images": [{ "bufferView": 0 }, { "uri": "c.png" }, { "bufferView": 1 }],
            "textures": [{ "source": 0 }, { "extensions": { "EXT_texture_webp": { "source": 1 } } }],
            "materials": [{
                "normalTexture": { "index": 0 },
                "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 } },
                "extensions": { "X": { "clearcoatNormalTexture": { "index": 0 } } },
            }],
        });
        std::fs::write(&path, document.to_string()).unwrap();
        let parts = StoredParts::read(&path, &Limits::default()).unwrap();
        let [embedded, external, broken] = &parts.images[..] else { panic!("three images") };
        // SHA-256 of "abc": FIPS 180-2, appendix B.1.
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(embedded.bytes, Some((3, abc.into())));
        assert_eq!(embedded.uses, ["clearcoat normal", "normal"]);
        assert_eq!((&external.bytes, &external.file), (&embedded.bytes, &Some(folder.path().join("c.png"))));
        assert_eq!((external.uses.as_slice(), &broken.bytes), (&["base color".to_owned()][..], &None));
        assert_eq!(parts.maps_beside, [("height".into(), folder.path().join("m.height.png"))]);
    }
}
