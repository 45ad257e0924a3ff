//! A glTF file as stored: its source, its GLB container, its JSON with the parts that are not read here, the bytes of
//! its buffers, its images, not decoded, and the extensions that are supported.

use super::meshopt::is_fallback_with;
use super::resources::{self, ByteSource, load_buffer};
use crate::file::sha256_of;
use crate::json::broken;
use crate::limits::Limits;
use crate::reading::Reading;
use gltf::json::Root;
use gltf::json::mesh::Primitive;
use serde_json::Value;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::scene::LAYERS;

/// The source of a glTF file.
#[derive(Debug, Clone, Copy)]
pub enum GltfSource<'a> {
    /// A file, `.gltf` or `.glb`.
    File(&'a Path),
    /// The bytes of a GLB that refers to no files.
    Glb(&'a [u8]),
}

impl<'a> GltfSource<'a> {
    /// Returns its path, or a path to no file for bytes.
    pub(crate) fn path(self) -> &'a Path {
        match self {
            Self::File(path) => path,
            Self::Glb(_) => Path::new("a.glb"),
        }
    }

    /// Returns the bytes of the file itself.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if it cannot be read, [`taotie_engine::Error::Limit`] if it does not fit in
    /// memory.
    pub(super) fn bytes(self, reading: &Reading) -> Result<Cow<'a, [u8]>> {
        match self {
            Self::File(path) => reading.read_own(path).map(Cow::Owned),
            Self::Glb(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// An unmodified glTF file.
pub(crate) struct RawGltf {
    /// Its JSON, an object; its contents are not checked.
    pub json: Value,
    /// The bytes of each buffer; `None` for one without data, as the target of compressed views.
    pub buffers: Vec<Option<Vec<u8>>>,
    reading: Arc<Reading>,
}

impl RawGltf {
    /// Reads a file and its buffers.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Parse`] if it cannot be read, [`Error::Limit`] if a limit is exceeded.
    pub fn read(source: GltfSource<'_>, limits: &Limits) -> Result<Self> {
        let path = source.path();
        let reading = Arc::new(Reading::new(path, limits));
        let (text, mut blob) = split(path, source.bytes(&reading)?.into_owned())?;
        if !reading.take(parsed_size(&text, blob.is_some())) {
            reading.check()?;
        }
        let json = parse(path, text)?;
        let declared = json.get("buffers").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let mut buffers = Vec::with_capacity(declared.len());
        for (i, buffer) in declared.iter().enumerate() {
            buffers.push(match buffer.get("uri").and_then(Value::as_str) {
                _ if buffer.get("extensions").and_then(Value::as_object).is_some_and(is_fallback_with) => {
                    None
                }
                Some(name) => Some(load_buffer(&reading, name, i)?),
                None if i == 0 => blob.take(),
                None => None,
            });
        }
        Ok(Self { json, buffers, reading })
    }

    /// Returns the limits on memory and file access, and the memory used so far.
    pub fn reading(&self) -> &Arc<Reading> {
        &self.reading
    }

    /// Returns an error at a place in the file.
    pub fn error(&self, at: impl Into<String>, what: impl Into<String>) -> Error {
        Error::parse(self.reading.path(), at, what)
    }

    /// Returns the bytes of the external file that `name`, a URI, refers to; `None` if the URI holds the bytes
    /// itself, or the file does not exist or may not be read.
    ///
    /// # Errors
    /// [`Error::Io`] if the file exists but cannot be read, [`Error::Limit`] if it does not fit in memory.
    pub fn file(&self, name: &str) -> Result<Option<Vec<u8>>> {
        match resources::locate(name, &self.reading) {
            Ok(ByteSource::File(path)) if path.is_file() => self.reading.read(&path).map(Some),
            _ => Ok(None),
        }
    }
}

/// Parses the JSON of a document and drops its text.
fn parse(path: &Path, text: Vec<u8>) -> Result<Value> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
    let json: Value = serde_json::from_slice(text).map_err(|e| broken(path, &e))?;
    match json.is_object() {
        true => Ok(json),
        false => Err(Error::parse(path, "JSON", "expected an object; is this glTF 2.0?")),
    }
}

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
    resources::file(item.get("uri")?.as_str()?, raw.reading())
}

fn stored(raw: &RawGltf, number: usize, image: &Value) -> Result<StoredImage> {
    let bytes = image_bytes(raw, image)?.map(|bytes| (bytes.len() as u64, sha256_of(&bytes)));
    Ok(StoredImage { uses: uses(&raw.json, number), file: file_of(raw, image), bytes })
}

/// Returns the stored bytes of an image; `None` if they are missing.
///
/// # Errors
/// [`taotie_engine::Error::Io`] if a file exists but cannot be read, [`taotie_engine::Error::Limit`] if it does not
/// fit in memory.
pub(crate) fn image_bytes(raw: &RawGltf, image: &Value) -> Result<Option<Vec<u8>>> {
    match image.get("uri").and_then(Value::as_str) {
        Some(uri) => match resources::locate(uri, raw.reading()) {
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
pub(crate) fn uses(json: &Value, image: usize) -> Vec<String> {
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

/// Takes apart a GLB container, which has a header, the JSON and at most one chunk of binary data. Returns the JSON
/// text and, for GLB, the binary chunk (empty if there is none).
pub(super) fn split(path: &Path, mut bytes: Vec<u8>) -> Result<(Vec<u8>, Option<Vec<u8>>)> {
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
            (_, None) => return Err(Error::parse(path, "GLB container", "the first chunk is not JSON")),
            _ => {}
        }
        at = end;
    }
    let json = json.ok_or_else(|| truncated(path, "JSON chunk"))?;
    Ok((json, Some(Vec::new())))
}

fn truncated(path: &Path, what: &str) -> Error {
    Error::parse(path, "GLB container", format!("the file ends within the {what}; download it again"))
}

fn little_endian(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

/// Bytes needed per byte of JSON during parsing: values, then the types built from them.
const PARSED: u64 = 16;
/// Bytes of a list or object with its first few members, and the bytes of text for which [`PARSED`] covers one of
/// them.
const LIST: [u64; 2] = [144, 32];
const OBJECT: [u64; 2] = [640, 48];
/// Number of lists and of objects that are not counted in any text.
const FREE: u64 = 8;
/// Bytes needed per byte of a `data:` URI in addition to its text. During parsing, this is a string, one byte. Later
/// the text is freed, and there are the string, at most one byte of Base64 without whitespace, and three quarters of
/// a byte of content.
const OF_DATA: u64 = 2;
/// The first bytes of a URI, which count like other text: they cover the overhead of its string, and a short URI is
/// not counted separately.
const HEAD: usize = 64;

/// Returns the bytes that a document needs in addition to its text, which is a copy of part of the file if
/// `is_copied`.
pub(super) fn parsed_size(text: &[u8], is_copied: bool) -> u64 {
    let data = data_uris(text);
    let values = text.len() as u64 - data;
    let beyond = |mark: u8, [bytes, covered]: [u64; 2]| {
        let count = text.iter().filter(|byte| **byte == mark).count() as u64;
        count.saturating_sub(values / covered + FREE) * bytes
    };
    values * PARSED + beyond(b'[', LIST) + beyond(b'{', OBJECT) + data * (OF_DATA + u64::from(is_copied))
}

/// Returns the bytes of `data:` URIs, without their heads. Strings with an escape are not included, since the parser
/// copies them again.
fn data_uris(text: &[u8]) -> u64 {
    let mut is_escaped = false;
    let mut bytes = 0;
    // In JSON, a piece that starts with these letters is a string, unless the preceding quote is escaped.
    for piece in text.split(|byte| *byte == b'"') {
        if !is_escaped && piece.starts_with(b"data:") && !piece.contains(&b'\\') {
            bytes += piece.len().saturating_sub(HEAD) as u64;
        }
        is_escaped = piece.ends_with(b"\\");
    }
    bytes
}

/// The extension of Draco-compressed primitives.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// The extension that shows a node's mesh several times.
pub(crate) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The extension that hides nodes, with all below them.
pub(super) const VISIBILITY: &str = "KHR_node_visibility";

/// The glTF extensions that are read: first those of layers.
pub const GLTF_EXTENSIONS: [&str; LAYERS.len() + OTHERS.len()] = {
    let (mut all, mut i) = ([""; LAYERS.len() + OTHERS.len()], 0);
    while i < all.len() {
        all[i] = if i < LAYERS.len() { LAYERS[i].extension } else { OTHERS[i - LAYERS.len()] };
        i += 1;
    }
    all
};

/// Those that are not layers of materials.
const OTHERS: [&str; 15] = [
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_variants",
    INSTANCING,
    VISIBILITY,
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    DRACO,
];

/// Extensions that give a texture an alternative image, in order of preference.
pub(crate) const OF_TEXTURES: [&str; 3] = ["EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu"];

/// Extensions that do not affect an image with the default materials: the finest level of detail is drawn, and the
/// channels of KHR_animation_pointer are skipped with a separate warning.
const WITHOUT_EFFECT: [&str; 4] = ["KHR_xmp", "KHR_xmp_json_ld", "KHR_animation_pointer", "MSFT_lod"];

/// Layers that are kept in written files, but not drawn.
const NOT_DRAWN: [&str; 3] =
    ["KHR_materials_volume", "KHR_materials_iridescence", "KHR_materials_dispersion"];

/// Returns `true` if an extension is supported, or has no effect.
pub(crate) fn is_known(name: &str) -> bool {
    GLTF_EXTENSIONS.contains(&name) || WITHOUT_EFFECT.contains(&name)
}

/// Returns the JSON of an extension that the parser does not know.
pub(super) fn extension<'a>(primitive: &'a Primitive, name: &str) -> Option<&'a Value> {
    primitive.extensions.as_ref()?.others.get(name)
}

/// Returns the extension and the feature that reads it, if this build lacks that feature.
fn lacking(name: &str) -> Option<(&'static str, &'static str)> {
    let features = [
        (DRACO, "draco", cfg!(feature = "draco")),
        ("KHR_texture_basisu", "basis", cfg!(feature = "basis")),
        ("EXT_texture_avif", "avif", cfg!(feature = "avif")),
        ("EXT_texture_webp", "webp", cfg!(feature = "webp")),
    ];
    let found = features.into_iter().find(|(extension, _, there)| *extension == name && !there);
    found.map(|(extension, feature, _)| (extension, feature))
}

/// Rejects a file that requires unsupported extensions, and notes those that it merely uses.
pub(super) fn check_extensions(path: &Path, root: &Root, warnings: &mut Warnings) -> Result<()> {
    let known = |name: &&String| is_known(name);
    if let Some(name) = root.extensions_required.iter().find(|name| !known(name)) {
        return Err(Error::unsupported(
            format!("{}: the required extension {name}", path.display()),
            "save the model without it",
        ));
    }
    if let Some((name, feature)) = root.extensions_required.iter().find_map(|name| lacking(name)) {
        return Err(Error::needs_feature(
            format!("{}: the required extension {name}", path.display()),
            feature,
        ));
    }
    for (name, feature) in root.extensions_used.iter().filter_map(|name| lacking(name)) {
        warnings.note(format!("ignored extension {name}; the crate feature `{feature}` supports it"), 1);
    }
    for name in root.extensions_used.iter().filter(|name| NOT_DRAWN.contains(&name.as_str())) {
        warnings.note(format!("{name} is kept, but not drawn"), 1);
    }
    for name in root.extensions_used.iter().filter(|name| !known(name)) {
        warnings.note(format!("ignored extension {name}"), 1);
    }
    Ok(())
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

    fn size(text: &str) -> u64 {
        parsed_size(text.as_bytes(), false)
    }

    #[test]
    fn the_content_of_data_uris_counts_apart() {
        let data = "data:;base64,".to_owned() + &"AAAA".repeat(1000);
        let text = format!(r#"{{"buffers":[{{"uri":"{data}"}}]}}"#);
        let apart = (data.len() - HEAD) as u64;
        assert_eq!(size(&text), (text.len() as u64 - apart) * 16 + apart * 2);
        assert_eq!(parsed_size(text.as_bytes(), true), size(&text) + apart);
        assert!(size(&text) < text.len() as u64 * 3);
    }

    #[test]
    fn lists_in_lists_and_small_objects_count_beside_their_text() {
        let nested = "[".repeat(100) + &"]".repeat(100);
        assert_eq!(size(&nested), 200 * 16 + (100 - 200 / 32 - 8) * 144);
        let objects = format!("[{}0]", r#"{"":0},"#.repeat(100));
        assert_eq!(size(&objects), 703 * 16 + (100 - 703 / 48 - 8) * 640);
        let node = r#"{"mesh":0,"translation":[10.25,20.5,30.75],"name":"n"},"#;
        assert_eq!(size(&node.repeat(100)), node.len() as u64 * 100 * 16, "as in real files");
    }

    #[test]
    fn what_might_be_numbers_counts_whole() {
        let long = "0,".repeat(100);
        let texts = [
            format!("[{long}0]"),
            // Quotes within a string do not end it.
            format!(r#"["a\"data:{long}"]"#),
            format!(r#"["data:{long}\u0041"]"#),
            format!(r#"["data:{long}\""]"#),
            format!("[{}0]", r#""data:,abc","#.repeat(50)),
        ];
        for text in texts {
            assert_eq!(size(&text), text.len() as u64 * 16, "{text}");
        }
    }
}
