//! Textures: their slots in materials, their samplers, and their images; each image is decoded once and kept once per
//! encoding.

use super::document::Document;
use super::geometry::MAX_UV_SETS;
use super::raw::OF_TEXTURES;
use super::resources::{ByteSource, locate, shortened};
use crate::bitmap::{count_copy, count_first, decode_within};
use crate::reading::{Reason, no_such};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::texture::{Info, MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{self, Value, deserialize};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::image::{Bitmap, Encoding, MipFilter, Sampler, TexelFilter, Texture, Wrap};
use taotie_engine::math::scalar;
use taotie_engine::parallel;
use taotie_engine::scene::{Material, TextureRef, UvTransform};

/// A texture as referenced by a material.
pub(super) struct Slot {
    index: usize,
    uv_set: u32,
    transform: Option<TextureTransform>,
}

impl Slot {
    /// Makes a slot whose extensions the parser knows.
    pub fn from_info(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
        Self { index: info.index.value(), uv_set: info.tex_coord, transform }
    }

    /// Makes a slot whose extensions are still JSON: those of normal and occlusion textures.
    pub fn new<'a>(
        index: usize,
        uv_set: u32,
        extensions: Option<impl IntoIterator<Item = (&'a String, &'a Value)>>,
    ) -> Self {
        let transform = extensions
            .and_then(|e| e.into_iter().find(|(name, _)| *name == "KHR_texture_transform"))
            .and_then(|(_, value)| deserialize::from_value(value.clone()).ok());
        Self { index, uv_set, transform }
    }

    fn uv_set(&self) -> u32 {
        self.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(self.uv_set)
    }
}

/// The images requested by materials, before any is decoded.
pub(super) struct Textures<'a> {
    document: &'a Document,
    /// The source image and encoding of each texture of the scene.
    requests: Vec<(usize, Encoding)>,
    /// The index of each among the requests.
    places: HashMap<(usize, Encoding), usize>,
    /// For each image of the file, the first one with the same bytes.
    same: Vec<usize>,
    /// The images that may replace the image used as key.
    substitutes: BTreeMap<usize, Vec<usize>>,
}

/// The textures of a scene.
#[derive(Clone, Default)]
pub(super) struct Decoded {
    /// The textures.
    pub textures: Vec<Texture>,
    /// Their files or names, in the same order.
    pub names: Vec<String>,
    /// Files that do not exist.
    pub missing: Vec<String>,
}

impl<'a> Textures<'a> {
    /// Makes an empty set of requests.
    pub fn new(document: &'a Document) -> Self {
        let same = same_sources(document);
        Self { document, requests: Vec::new(), places: HashMap::new(), same, substitutes: BTreeMap::new() }
    }

    /// Registers a use of a texture; returns `None` with a warning if it has no readable image.
    pub fn resolve(
        &mut self,
        slot: &Slot,
        encoding: Encoding,
        (place, warnings): (&str, &mut Warnings),
    ) -> Option<TextureRef> {
        match self.find_image(slot) {
            Ok((image, sampler)) => Some(self.request(slot, (image, encoding), sampler)),
            Err(why) => {
                warnings.note(format!("{place}: skipped a texture: {why}"), 1);
                None
            }
        }
    }

    fn find_image(&mut self, slot: &Slot) -> Reason<(usize, Sampler)> {
        if slot.uv_set() >= MAX_UV_SETS {
            return Err(format!(
                "unsupported uv set {}; only the first {MAX_UV_SETS} are read",
                slot.uv_set()
            ));
        }
        if !transform(slot).is_bounded() {
            return Err(format!("the texture transform has a value beyond ±{:e}", UvTransform::MOST));
        }
        let mut images: Vec<usize> =
            sources(self.document, slot.index)?.into_iter().map(|image| self.same[image]).collect();
        let image = images.remove(0);
        self.substitutes.entry(image).or_insert(images);
        let root = &self.document.root;
        let sampler = root.textures[slot.index].sampler.and_then(|s| root.samplers.get(s.value()));
        Ok((image, sampler.map_or_else(Sampler::default, sampler_from)))
    }

    fn request(&mut self, slot: &Slot, request: (usize, Encoding), sampler: Sampler) -> TextureRef {
        let texture = *self.places.entry(request).or_insert_with(|| {
            self.requests.push(request);
            self.requests.len() - 1
        });
        TextureRef { texture, uv_set: slot.uv_set() as usize, sampler, transform: transform(slot) }
    }

    /// Decodes the requested images. Uses of unreadable images are removed from `materials`, with a warning.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Limit`] if they do not fit in memory; all are counted first.
    pub fn decode(self, materials: &mut [Material], warnings: &mut Warnings) -> Result<Decoded> {
        let mut decoded = Decoded::default();
        let bitmaps = self.read_images(&mut decoded.missing, warnings);
        let mut next = 0..;
        let kept = |(image, _): &(usize, Encoding)| bitmaps.contains_key(image);
        let places: Vec<_> = self.requests.iter().map(|r| kept(r).then(|| next.next()).flatten()).collect();
        materials.iter_mut().for_each(|m| renumber(m, &places));
        let requests: Vec<_> = self.requests.iter().filter(|r| kept(r)).copied().collect();
        self.count(&requests, &bitmaps)?;
        decoded.names = requests.iter().map(|(image, _)| image_name(self.document, *image)).collect();
        decoded.textures = build_textures(&requests, bitmaps);
        Ok(decoded)
    }

    /// Counts the memory of textures in addition to their images. An image needed in a second encoding is copied.
    fn count(&self, requests: &[(usize, Encoding)], bitmaps: &BTreeMap<usize, Bitmap>) -> Result<()> {
        let (reading, mut seen) = (&self.document.reading, BTreeSet::new());
        for (image, encoding) in requests {
            let bitmap = &bitmaps[image];
            let _ = match seen.insert(*image) {
                true => count_first(reading, bitmap, *encoding),
                false => count_copy(reading, bitmap, *encoding),
            };
        }
        reading.check()
    }

    fn read_images(&self, missing: &mut Vec<String>, warnings: &mut Warnings) -> BTreeMap<usize, Bitmap> {
        let images: BTreeSet<usize> = self.requests.iter().map(|(image, _)| *image).collect();
        let mut bitmaps = self.read_all(images, missing, warnings);
        let lacking = self.substitutes.iter().filter(|(image, _)| !bitmaps.contains_key(image));
        let lacking: Vec<(&usize, &Vec<usize>)> = lacking.collect();
        let others = lacking.iter().flat_map(|(_, others)| *others).copied();
        let substitutes = self.read_all(others.collect(), missing, warnings);
        for (image, others) in lacking {
            let Some(other) = others.iter().find(|other| substitutes.contains_key(other)) else { continue };
            warnings.note(format!("used image {other} instead of image {image}"), 1);
            bitmaps.insert(*image, substitutes[other].clone());
        }
        bitmaps
    }

    fn read_all(
        &self,
        images: BTreeSet<usize>,
        missing: &mut Vec<String>,
        warnings: &mut Warnings,
    ) -> BTreeMap<usize, Bitmap> {
        let images: Vec<usize> = images.into_iter().collect();
        let read = parallel::tasks(images.len(), &|i| read_image(self.document, images[i]));
        let mut bitmaps = BTreeMap::new();
        for (image, result) in images.into_iter().zip(read) {
            match result {
                Ok(bitmap) => drop(bitmaps.insert(image, bitmap)),
                Err(unread) => {
                    warnings.note(format!("skipped image {image}: {}", unread.why), 1);
                    missing.extend(unread.missing);
                }
            }
        }
        bitmaps
    }
}

/// Builds one texture per request; a bitmap is copied only if it is needed in both encodings.
fn build_textures(requests: &[(usize, Encoding)], mut bitmaps: BTreeMap<usize, Bitmap>) -> Vec<Texture> {
    let mut parts = Vec::with_capacity(requests.len());
    let last: HashMap<usize, usize> =
        requests.iter().enumerate().map(|(i, (image, _))| (*image, i)).collect();
    for (i, (image, encoding)) in requests.iter().enumerate() {
        let again = last[image] > i;
        let bitmap = if again { bitmaps.get(image).cloned() } else { bitmaps.remove(image) };
        parts.extend(bitmap.map(|b| (b, *encoding)));
    }
    parts.into_par_iter().map(|(bitmap, encoding)| Texture::new(bitmap, encoding)).collect()
}

/// Gives each use of a texture its final index, or removes it.
fn renumber(material: &mut Material, places: &[Option<usize>]) {
    material.retain_textures(|texture| match places.get(texture.texture) {
        Some(Some(place)) => {
            texture.texture = *place;
            true
        }
        _ => false,
    });
}

fn transform(slot: &Slot) -> UvTransform {
    slot.transform.as_ref().map(matrix).unwrap_or_default()
}

/// Returns T · R · S, where a positive angle turns uvs counter-clockwise as seen with v pointing down.
/// Source: KHR_texture_transform, with the sign that KhronosGroup/glTF#1563 settles.
fn matrix(transform: &TextureTransform) -> UvTransform {
    let angle = f64::from(transform.rotation.0);
    let (s, c) = (scalar::sin(angle), scalar::cos(angle));
    let [x, y] = transform.scale.0.map(f64::from);
    let linear = [[(c * x) as f32, (s * y) as f32], [(-s * x) as f32, (c * y) as f32]];
    UvTransform { linear, offset: transform.offset.0 }
}

/// Reads a sampler of the file; missing values default to repeat and smooth.
fn sampler_from(json: &json::texture::Sampler) -> Sampler {
    let wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let magnify = match json.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => TexelFilter::Nearest,
        _ => TexelFilter::Linear,
    };
    let (minify, mip) = match json.min_filter {
        Some(Checked::Valid(filter)) => minification(filter),
        _ => (TexelFilter::Linear, MipFilter::Linear),
    };
    Sampler { wrap_u: wrap(&json.wrap_s), wrap_v: wrap(&json.wrap_t), magnify, minify, mip }
}

fn minification(filter: MinFilter) -> (TexelFilter, MipFilter) {
    match filter {
        MinFilter::Nearest => (TexelFilter::Nearest, MipFilter::None),
        MinFilter::Linear => (TexelFilter::Linear, MipFilter::None),
        MinFilter::NearestMipmapNearest => (TexelFilter::Nearest, MipFilter::Nearest),
        MinFilter::LinearMipmapNearest => (TexelFilter::Linear, MipFilter::Nearest),
        MinFilter::NearestMipmapLinear => (TexelFilter::Nearest, MipFilter::Linear),
        MinFilter::LinearMipmapLinear => (TexelFilter::Linear, MipFilter::Linear),
    }
}

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

fn extended(texture: &json::Texture) -> impl Iterator<Item = usize> {
    let extensions = texture.extensions.as_ref();
    let source = move |name: &str| extensions?.others.get(name)?.get("source").and_then(Value::as_u64);
    OF_TEXTURES.into_iter().filter_map(source).map(|image| usize::try_from(image).unwrap_or(usize::MAX))
}

/// Returns for each image of the file the first one with the same source, so that each source is decoded once.
fn same_sources(document: &Document) -> Vec<usize> {
    let mut firsts = HashMap::new();
    let images = document.root.images.iter().enumerate();
    let first = |(i, image)| source(image).map_or(i, |source| *firsts.entry(source).or_insert(i));
    images.map(first).collect()
}

/// Returns the view or the URI that an image refers to.
fn source(image: &json::Image) -> Option<(Option<usize>, Option<&str>)> {
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
    match locate(address, reading).map_err(|why| format!("'{name}': {why}"))? {
        ByteSource::Data { bytes, .. } => decode(&bytes),
        ByteSource::File(path) if path.exists() => {
            let bytes = reading.read(&path).map_err(|e| e.to_string())?;
            let file_name = path.file_name().unwrap_or_default().to_string_lossy();
            decode_within(&bytes, &file_name, &path, reading).map_err(|e| e.to_string().into())
        }
        ByteSource::File(_) => {
            Err(Unread { why: format!("the file '{name}' is missing"), missing: Some(name) })
        }
    }
}

/// Returns the name of an image for messages: its file, else its name, else its index.
pub(super) fn image_name(document: &Document, index: usize) -> String {
    let image = &document.root.images[index];
    let file = image.uri.as_ref().filter(|u| !u.starts_with("data:"));
    let name = file.or(image.name.as_ref());
    name.map_or_else(|| format!("image {index}"), |n| shortened(n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::Vec2;

    #[test]
    fn texture_transform_as_in_the_extension_s_example() {
        // "Only the lower left quadrant of the source image, rotated clockwise 90°."
        let json = r#"{"offset":[0,1],"rotation":1.5707963,"scale":[0.5,0.5]}"#;
        let m = matrix(&deserialize::from_str(json).unwrap());
        let close = |uv: Vec2, x: f32, y: f32| (uv.x - x).abs() < 1e-6 && (uv.y - y).abs() < 1e-6;
        assert!(close(m.apply(Vec2::new(0.0, 0.0)), 0.0, 1.0));
        assert!(close(m.apply(Vec2::new(1.0, 0.0)), 0.0, 0.5));
        assert!(close(m.apply(Vec2::new(1.0, 1.0)), 0.5, 0.5));
    }
}
