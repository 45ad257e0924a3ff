//! The textures of a material: each image encoded once, and its place in a document.

use super::format::{GltfFormat, GltfImages};
use super::material::GltfMaterial;
use super::{GltfDraft, ktx, samplers};
use crate::error::{Error, Result};
use crate::image::{Bitmap, Encoding, Sampler, Texels};
use crate::io::write::FileBytes;
use crate::io::write::png::interleaved;
use crate::io::{PngColor, PngImage, PngSamples, encode_png};
use crate::parallel;
use crate::scene::AlphaMode;
#[cfg(feature = "webp")]
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, codecs::jpeg::JpegEncoder};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::Path;

/// A texture's image.
#[derive(Debug, Clone, Copy)]
pub enum GltfImage<'a> {
    /// Texels of 8 or 16 bits; alpha is written where the material reads it.
    Bitmap(&'a Bitmap),
    /// A file that lies beside the model already, by its relative path with `/`.
    File(&'a str),
}

impl<'a> From<&'a Bitmap> for GltfImage<'a> {
    fn from(bitmap: &'a Bitmap) -> Self {
        Self::Bitmap(bitmap)
    }
}

impl GltfImage<'_> {
    /// Says whether both are one and the same, so that it needs to be written once only.
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bitmap(a), Self::Bitmap(b)) => std::ptr::eq(*a, *b),
            (Self::File(a), Self::File(b)) => a == b,
            _ => false,
        }
    }
}

/// The slots of a material that have textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    MetallicRoughness,
    Occlusion,
    Normal,
    Emissive,
}

impl Slot {
    fn encoding(self) -> Encoding {
        match self {
            Self::BaseColor | Self::Emissive => Encoding::Srgb,
            Self::Normal => Encoding::Normal,
            Self::MetallicRoughness | Self::Occlusion => Encoding::Linear,
        }
    }
}

/// An image as it is written, and the slots that show it.
#[derive(Debug)]
pub(super) struct Encoded<'a> {
    image: GltfImage<'a>,
    format: GltfImages,
    /// The quality of a JPEG, which stands in place of `format`.
    jpeg: Option<u8>,
    slots: Vec<Slot>,
    /// `true` where the material reads its alpha.
    alpha: bool,
    bytes: Vec<u8>,
}

impl<'a> Encoded<'a> {
    /// Takes the image of a slot, not encoded yet.
    fn new(slot: Slot, image: GltfImage<'a>, alpha: AlphaMode) -> Self {
        let has_alpha = matches!(image, GltfImage::Bitmap(bitmap) if matches!(bitmap.channels(), 2 | 4));
        let alpha = has_alpha && slot == Slot::BaseColor && alpha != AlphaMode::Opaque;
        Self { image, format: GltfImages::Png, jpeg: None, slots: vec![slot], alpha, bytes: Vec::new() }
    }

    /// Chooses the format; KTX2 and JPEG hold no alpha, and JPEG is for base colours alone.
    fn packed(self, format: &GltfFormat) -> Self {
        let jpeg = format.jpeg.filter(|_| self.serves(Slot::BaseColor) && !self.alpha);
        let is_refused = self.alpha && format.images == GltfImages::Ktx2;
        let format = if is_refused { GltfImages::Png } else { format.images };
        Self { format, jpeg, ..self }
    }
}

impl Encoded<'_> {
    /// Says whether a slot shows it.
    pub fn serves(&self, slot: Slot) -> bool {
        self.slots.contains(&slot)
    }

    /// Returns the slots that show it.
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// Returns the bytes of its file; `None` where the file is there already.
    pub fn bytes(&self) -> Option<&[u8]> {
        matches!(self.image, GltfImage::Bitmap(_)).then_some(&self.bytes)
    }

    /// Returns its file beside the model `path`; `None` where it is there already.
    pub fn into_file(self, path: &Path) -> Option<FileBytes> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let file = path.with_file_name(self.file_name(&stem));
        matches!(self.image, GltfImage::Bitmap(_)).then_some(FileBytes { path: file, bytes: self.bytes })
    }

    /// Returns the name of its file beside a model.
    pub fn file_name(&self, stem: &str) -> String {
        match self.image {
            GltfImage::File(name) => name.to_owned(),
            GltfImage::Bitmap(_) => format!("{stem}_{}.{}", self.role(), self.file_extension()),
        }
    }

    fn file_extension(&self) -> &'static str {
        if self.jpeg.is_some() { "jpg" } else { self.format.file_extension() }
    }

    /// Returns its media type.
    pub fn mime_type(&self) -> &'static str {
        if self.jpeg.is_some() { "image/jpeg" } else { self.format.mime_type() }
    }

    /// Returns a word for what it shows.
    pub fn role(&self) -> &'static str {
        match self.slots[..] {
            [Slot::MetallicRoughness, Slot::Occlusion] => "orm",
            [Slot::BaseColor, ..] => "color",
            [Slot::MetallicRoughness, ..] => "metallic_roughness",
            [Slot::Occlusion, ..] => "occlusion",
            [Slot::Emissive, ..] => "emissive",
            [Slot::Normal, ..] | [] => "normal",
        }
    }

    /// The texture that shows image `source`.
    pub fn texture(&self, source: usize) -> Value {
        match self.extension() {
            None => json!({ "sampler": 0, "source": source }),
            Some(name) => json!({ "sampler": 0, "extensions": { name: { "source": source } } }),
        }
    }

    /// The extension of its texture; a file that is there already is shown as any program can.
    pub fn extension(&self) -> Option<&'static str> {
        self.bytes().and(self.format.extension()).filter(|_| self.jpeg.is_none())
    }
}

/// Encodes every image of a material, in the order of its slots. Slots that show the same image in the same encoding
/// share it.
pub(super) fn encode<'a>(material: &GltfMaterial<'a>, format: &GltfFormat) -> Result<Vec<Encoded<'a>>> {
    if let Some(quality) = format.jpeg.filter(|quality| !(1..=100).contains(quality)) {
        return Err(Error::invalid(format!("a JPEG quality of {quality}"), "give 1 to 100"));
    }
    let mut images: Vec<Encoded> = Vec::new();
    for (slot, image) in material.maps() {
        let shared = |known: &&mut Encoded| {
            known.image.is(&image) && known.slots.iter().all(|s| s.encoding() == slot.encoding())
        };
        match images.iter_mut().find(shared) {
            Some(known) => known.slots.push(slot),
            None => images.push(Encoded::new(slot, image, material.alpha).packed(format)),
        }
    }
    let bytes = parallel::tasks(images.len(), &|i| match images[i].image {
        GltfImage::Bitmap(bitmap) => {
            let stored = Stored { encoding: images[i].slots[0].encoding(), alpha: images[i].alpha };
            match images[i].jpeg {
                Some(quality) => jpeg(bitmap, stored, quality),
                None => encode_bitmap(bitmap, stored, images[i].format),
            }
        }
        GltfImage::File(_) => Ok(Vec::new()),
    });
    for (encoded, bytes) in images.iter_mut().zip(bytes) {
        encoded.bytes = bytes?;
    }
    Ok(images)
}

/// The stored form of a bitmap, and its meaning.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    pub encoding: Encoding,
    /// `true` where alpha is written; KTX2 holds none.
    pub alpha: bool,
}

/// Returns the bytes of an image file.
///
/// # Errors
/// [`Error::Unsupported`] for texels of floats; the errors of the format.
pub(super) fn encode_bitmap(bitmap: &Bitmap, stored: Stored, format: GltfImages) -> Result<Vec<u8>> {
    match format {
        GltfImages::Png => png(bitmap, stored),
        GltfImages::WebP => webp(bitmap, stored),
        GltfImages::Ktx2 => {
            let size = (bitmap.width(), bitmap.height());
            ktx::encode(size, eight_bits(bitmap, stored)?.into_owned(), stored.encoding)
        }
    }
}

fn png(bitmap: &Bitmap, stored: Stored) -> Result<Vec<u8>> {
    let (color, channels) = match bitmap.channels() {
        2 | 4 if stored.alpha => (PngColor::Rgba, 4),
        1 | 2 => (PngColor::Grey, 1),
        _ => (PngColor::Rgb, 3),
    };
    let (width, height, encoding) = (bitmap.width(), bitmap.height(), stored.encoding);
    let encode = |samples| encode_png(&PngImage { width, height, color, samples, encoding });
    match bitmap.texels() {
        Texels::U8(texels) => encode(PngSamples::U8(&interleaved(texels, channels))),
        Texels::U16(texels) => encode(PngSamples::U16(&interleaved(texels, channels))),
        Texels::F32(_) => Err(no_floats(stored)),
    }
}

/// Returns the bytes of a JPEG, which holds 8 bits and no alpha.
fn jpeg(bitmap: &Bitmap, stored: Stored, quality: u8) -> Result<Vec<u8>> {
    let wrong = |e: image::ImageError| Error::invalid("a texture as JPEG", e.to_string());
    let mut bytes = Vec::new();
    let texels = eight_bits(bitmap, stored)?;
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode(&interleaved(&texels, 3), bitmap.width(), bitmap.height(), ExtendedColorType::Rgb8)
        .map_err(wrong)?;
    Ok(bytes)
}

#[cfg(not(feature = "webp"))]
fn webp(_: &Bitmap, _: Stored) -> Result<Vec<u8>> {
    Err(Error::needs_feature("WebP", "webp"))
}

#[cfg(feature = "webp")]
fn webp(bitmap: &Bitmap, stored: Stored) -> Result<Vec<u8>> {
    let wrong = |e: image::ImageError| {
        Error::invalid(format!("a {:?} texture as WebP", stored.encoding), e.to_string())
    };
    let mut bytes = Vec::new();
    let texels = eight_bits(bitmap, stored)?;
    let (color, channels) =
        if stored.alpha { (ExtendedColorType::Rgba8, 4) } else { (ExtendedColorType::Rgb8, 3) };
    WebPEncoder::new_lossless(&mut bytes)
        .encode(&interleaved(&texels, channels), bitmap.width(), bitmap.height(), color)
        .map_err(wrong)?;
    Ok(bytes)
}

/// Returns the texels rounded to 8 bits.
fn eight_bits(bitmap: &Bitmap, stored: Stored) -> Result<Cow<'_, [[u8; 4]]>> {
    let rounded = |v: u16| ((u32::from(v) * 255 + 32767) / 65535) as u8;
    match bitmap.texels() {
        Texels::U8(texels) => Ok(Cow::Borrowed(texels)),
        Texels::U16(texels) => Ok(Cow::Owned(texels.iter().map(|texel| texel.map(rounded)).collect())),
        Texels::F32(_) => Err(no_floats(stored)),
    }
}

fn no_floats(stored: Stored) -> Error {
    Error::unsupported(format!("a {:?} texture of floats in glTF", stored.encoding), "store 8 or 16 bits")
}

/// The storage of images: within the document or beside it.
pub(super) enum ImageStorage<'a> {
    /// In the document's buffer.
    Inside,
    /// In files beside the model, whose name without extension this is.
    Beside(&'a str),
}

/// Adds images, and a texture for each, all read by one sampler.
pub(super) fn add(draft: &mut GltfDraft, images: &[Encoded], storage: &ImageStorage, sampler: &Sampler) {
    if images.is_empty() {
        return;
    }
    let json: Vec<Value> = images.iter().map(|image| entry(draft, image, storage)).collect();
    images.iter().filter_map(Encoded::extension).for_each(|name| draft.require(name));
    let textures: Vec<Value> = images.iter().enumerate().map(|(i, image)| image.texture(i)).collect();
    draft.json["images"] = json!(json);
    draft.json["textures"] = json!(textures);
    draft.json["samplers"] = json!([samplers::json(sampler)]);
}

fn entry(draft: &mut GltfDraft, image: &Encoded, storage: &ImageStorage) -> Value {
    match (image.bytes(), storage) {
        (Some(bytes), ImageStorage::Inside) => {
            let view = draft.view(bytes);
            json!({ "name": image.role(), "bufferView": view, "mimeType": image.mime_type() })
        }
        (Some(_), ImageStorage::Beside(stem)) => json!({ "uri": uri(&image.file_name(stem)) }),
        (None, _) => json!({ "uri": uri(&image.file_name("")) }),
    }
}

/// Characters that a relative URI cannot hold as they are.
const RESERVED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// Returns the relative URI of a file.
pub(super) fn uri(name: &str) -> String {
    utf8_percent_encode(name, RESERVED).to_string()
}
