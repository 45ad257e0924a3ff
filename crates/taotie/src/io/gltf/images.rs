//! Images: those of a texture, the location of their bytes, and their decoding.

use super::document::Document;
use super::extensions::OF_TEXTURES;
use super::reason::{Reason, no_such};
use super::uri;
use crate::image::Bitmap;
use crate::io::bitmap::decode_within;
use gltf::json::{Image, Texture, Value};
use std::collections::HashMap;

/// Returns the images of a texture, the preferred one first. The others exist for programs that cannot read it, so
/// they replace it if it is damaged or missing.
pub(super) fn sources(document: &Document, index: usize) -> Reason<Vec<usize>> {
    let root = &document.root;
    let texture = root.textures.get(index).ok_or_else(|| no_such("texture", index))?;
    let own = Some(texture.source.value()).filter(|image| *image != u32::MAX as usize);
    let named: Vec<usize> = extended(texture).chain(own).collect();
    let there: Vec<usize> = named.iter().copied().filter(|image| *image < root.images.len()).collect();
    match (there.is_empty(), named.first()) {
        (false, _) => Ok(there),
        (true, Some(image)) => Err(no_such("image", *image)),
        (true, None) => Err(format!("texture {index} has no image except in an unknown extension")),
    }
}

fn extended(texture: &Texture) -> impl Iterator<Item = usize> {
    let extensions = texture.extensions.as_ref();
    let source = move |name: &str| extensions?.others.get(name)?.get("source").and_then(Value::as_u64);
    OF_TEXTURES.into_iter().filter_map(source).map(|image| usize::try_from(image).unwrap_or(usize::MAX))
}

/// Returns for each image of the file the first one with the same source, so that each source is decoded once.
pub(super) fn same_sources(document: &Document) -> Vec<usize> {
    let mut firsts = HashMap::new();
    let images = document.root.images.iter().enumerate();
    let first = |(i, image)| source(image).map_or(i, |source| *firsts.entry(source).or_insert(i));
    images.map(first).collect()
}

/// Returns the view or the URI that an image refers to.
fn source(image: &Image) -> Option<(Option<usize>, Option<&str>)> {
    match (image.buffer_view, &image.uri) {
        (Some(view), _) => Some((Some(view.value()), None)),
        (None, uri) => uri.as_deref().map(|uri| (None, Some(uri))),
    }
}

/// The reason why an image is unavailable.
pub(super) struct Unread {
    /// The reason in words.
    pub why: String,
    /// The missing file.
    pub missing: Option<String>,
}

impl From<String> for Unread {
    fn from(why: String) -> Self {
        Self { why, missing: None }
    }
}

/// Reads and decodes image `index`, which exists.
pub(super) fn read_image(document: &Document, index: usize) -> std::result::Result<Bitmap, Unread> {
    let (image, reading) = (&document.root.images[index], &document.reading);
    let name = image_name(document, index);
    let decode = |bytes: &[u8]| {
        decode_within(bytes, &name, &document.path, reading).map_err(|e| Unread::from(e.to_string()))
    };
    if let Some(view) = image.buffer_view {
        return decode(document.view(view.value())?.0);
    }
    let Some(address) = &image.uri else { return Err("neither uri nor bufferView is set".to_owned().into()) };
    match uri::locate(address, reading).map_err(|why| format!("'{name}': {why}"))? {
        uri::ByteSource::Data { bytes, .. } => decode(&bytes),
        uri::ByteSource::File(path) if path.exists() => {
            let bytes = reading.read(&path).map_err(|e| e.to_string())?;
            let file_name = path.file_name().unwrap_or_default().to_string_lossy();
            decode_within(&bytes, &file_name, &path, reading).map_err(|e| e.to_string().into())
        }
        uri::ByteSource::File(_) => {
            Err(Unread { why: format!("the file '{name}' is missing"), missing: Some(name) })
        }
    }
}

/// Returns the name of an image for messages: its file, else its name, else its index.
pub(super) fn image_name(document: &Document, index: usize) -> String {
    let image = &document.root.images[index];
    let file = image.uri.as_ref().filter(|u| !u.starts_with("data:"));
    let name = file.or(image.name.as_ref());
    name.map_or_else(|| format!("image {index}"), |n| uri::shortened(n))
}
