//! Texture slots, samplers and images; each image is decoded once and kept once per encoding.

use super::document::Document;
use super::images::{image_name, read_image, same_sources, sources};
use super::reason::Reason;
use super::samplers::sampler_from;
use super::vertices::MAX_UV_SETS;
use crate::error::{Result, Warnings};
use crate::image::{Bitmap, Encoding, Sampler, Texture};
use crate::io::texture_room::{count_copy, count_first};
use crate::math::scalar;
use crate::parallel;
use crate::scene::{Material, TextureRef, UvTransform};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::texture::Info;
use gltf::json::{Value, deserialize};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};

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
}

impl Slot {
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
    /// [`crate::Error::Limit`] if they do not fit in memory; all are counted first.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

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
