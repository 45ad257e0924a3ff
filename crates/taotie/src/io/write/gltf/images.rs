//! The textures of a material: each image encoded once, and where in a document it stands.

use super::GltfDraft;
use super::material::GltfMaterial;
use crate::error::{Error, Result};
use crate::image::{Bitmap, Encoding, Texels};
use crate::io::{PngColor, PngImage, PngSamples, encode_png};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use rayon::prelude::*;
use serde_json::{Value, json};

/// glTF's numbers for filters and wrapping.
const LINEAR: u32 = 9729;
const LINEAR_MIPMAP_LINEAR: u32 = 9987;
const CLAMP_TO_EDGE: u32 = 33071;

/// A texture's image.
#[derive(Debug, Clone, Copy)]
pub enum GltfImage<'a> {
    /// Texels of 8 or 16 bits; alpha is not written.
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
    /// Whether both are one and the same, so that it needs to be written once only.
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bitmap(a), Self::Bitmap(b)) => std::ptr::eq(*a, *b),
            (Self::File(a), Self::File(b)) => a == b,
            _ => false,
        }
    }
}

/// How textures are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GltfImages {
    /// PNG, as precise as the bitmap; every program reads it.
    #[default]
    Png,
}

/// The slots of a material that have textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    MetallicRoughness,
    Occlusion,
    Normal,
}

impl Slot {
    fn encoding(self) -> Encoding {
        match self {
            Self::BaseColor => Encoding::Srgb,
            Self::Normal => Encoding::Normal,
            Self::MetallicRoughness | Self::Occlusion => Encoding::Linear,
        }
    }
}

/// An image as it is written, and the slots that show it.
#[derive(Debug)]
pub(super) struct Encoded<'a> {
    image: GltfImage<'a>,
    slots: Vec<Slot>,
    bytes: Vec<u8>,
}

impl Encoded<'_> {
    /// Whether a slot shows it.
    pub fn serves(&self, slot: Slot) -> bool {
        self.slots.contains(&slot)
    }

    /// The bytes of its file; `None` where the file is there already.
    pub fn bytes(&self) -> Option<&[u8]> {
        matches!(self.image, GltfImage::Bitmap(_)).then_some(&self.bytes)
    }

    /// The name of its file beside a model.
    pub fn file_name(&self, stem: &str) -> String {
        match self.image {
            GltfImage::File(name) => name.to_owned(),
            GltfImage::Bitmap(_) => format!("{stem}_{}.png", self.role()),
        }
    }

    fn role(&self) -> &'static str {
        match self.slots[..] {
            [Slot::MetallicRoughness, Slot::Occlusion] => "orm",
            [Slot::BaseColor, ..] => "color",
            [Slot::MetallicRoughness, ..] => "metallic_roughness",
            [Slot::Occlusion, ..] => "occlusion",
            [Slot::Normal, ..] | [] => "normal",
        }
    }

    fn mime_type(&self) -> &'static str {
        "image/png"
    }
}

/// Encodes every image of a material, in the order of its slots. Slots that show the same image in the same encoding
/// share it.
pub(super) fn encode<'a>(material: &GltfMaterial<'a>, _format: GltfImages) -> Result<Vec<Encoded<'a>>> {
    let mut images: Vec<Encoded> = Vec::new();
    for (slot, image) in material.maps() {
        let shared = |known: &&mut Encoded| {
            known.image.is(&image) && known.slots.iter().all(|s| s.encoding() == slot.encoding())
        };
        match images.iter_mut().find(shared) {
            Some(known) => known.slots.push(slot),
            None => images.push(Encoded { image, slots: vec![slot], bytes: Vec::new() }),
        }
    }
    images.par_iter_mut().try_for_each(|encoded| {
        if let GltfImage::Bitmap(bitmap) = encoded.image {
            encoded.bytes = png(bitmap, encoded.slots[0])?;
        }
        Ok::<_, Error>(())
    })?;
    Ok(images)
}

/// Alpha goes, since no slot here reads it.
fn png(bitmap: &Bitmap, slot: Slot) -> Result<Vec<u8>> {
    let (color, channels) = if bitmap.channels() < 3 { (PngColor::Grey, 1) } else { (PngColor::Rgb, 3) };
    let (width, height, encoding) = (bitmap.width(), bitmap.height(), slot.encoding());
    let encode = |samples| encode_png(&PngImage { width, height, color, samples, encoding });
    match bitmap.texels() {
        Texels::U8(texels) => encode(PngSamples::U8(&interleaved(texels, channels))),
        Texels::U16(texels) => encode(PngSamples::U16(&interleaved(texels, channels))),
        Texels::F32(_) => {
            Err(Error::unsupported(format!("a {slot:?} texture of floats in glTF"), "store 8 or 16 bits"))
        }
    }
}

fn interleaved<T: Copy>(texels: &[[T; 4]], channels: usize) -> Vec<T> {
    texels.iter().flat_map(|texel| &texel[..channels]).copied().collect()
}

/// Where images are put.
pub(super) enum Place<'a> {
    /// In the document's buffer.
    Inside,
    /// In files beside the model, whose name without extension this is.
    Beside(&'a str),
}

/// Adds images, and a texture for each.
pub(super) fn add(draft: &mut GltfDraft, images: &[Encoded], place: &Place) {
    if images.is_empty() {
        return;
    }
    let json: Vec<Value> = images.iter().map(|image| entry(draft, image, place)).collect();
    let textures: Vec<Value> = (0..images.len()).map(|i| json!({ "sampler": 0, "source": i })).collect();
    draft.json["images"] = json!(json);
    draft.json["textures"] = json!(textures);
    draft.json["samplers"] = json!([{
        "magFilter": LINEAR, "minFilter": LINEAR_MIPMAP_LINEAR,
        "wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE,
    }]);
}

fn entry(draft: &mut GltfDraft, image: &Encoded, place: &Place) -> Value {
    match (image.bytes(), place) {
        (Some(bytes), Place::Inside) => {
            let view = draft.view(bytes);
            json!({ "name": image.role(), "bufferView": view, "mimeType": image.mime_type() })
        }
        (Some(_), Place::Beside(stem)) => json!({ "uri": uri(&image.file_name(stem)) }),
        (None, _) => json!({ "uri": uri(&image.file_name("")) }),
    }
}

/// What a relative URI cannot hold as it is.
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

/// The relative URI of a file.
pub(super) fn uri(name: &str) -> String {
    utf8_percent_encode(name, RESERVED).to_string()
}
