//! The materials of a scene, with notes on what glTF cannot express, and their textures: each image is encoded once,
//! with the samplers of its uses.

use super::super::codec::{CodecKind, ImageCodec};
use super::super::draft::uri;
use super::super::format::GltfFormat;
use super::super::image_encoding::{self, Stored};
use super::super::material::{CORE_TEXTURES, MaterialParts, TextureInfo, layers};
use super::super::textures::sampler_json;
use super::{Image, ImageUse, Writer, file_name};
use serde_json::{Value, json};
use std::borrow::Cow;
use taotie_engine::error::Result;
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::srgb;
use taotie_engine::parallel;
use taotie_engine::scene::{
    FactorValue, GreenChannel, LAYERS, Layer, Material, NormalSpace, TextureRef, TextureRole,
};

impl Writer<'_> {
    /// Returns the JSON of a material; content that glTF cannot express is noted.
    pub(super) fn material(&mut self, material: &Material) -> Value {
        self.note_unsaid(material);
        self.note_above_one("base colours", &material.base_color);
        let parts = MaterialParts {
            name: &material.name,
            double_sided: Some(material.double_sided),
            base_color: Some(material.base_color),
            metallic: Some(material.metallic),
            roughness: Some(material.roughness),
            emissive: Some(material.emissive),
            alpha: Some(material.alpha),
            layers: layers(material),
            textures: self.texture_uses(material),
        };
        parts.into_json(&mut self.draft)
    }

    fn note_unsaid(&mut self, material: &Material) {
        let authored = material.f0.is_some() || material.f82.is_some();
        self.note("materials with a reflectance (f0, f82) that glTF cannot express", usize::from(authored));
        let classic = material.classic != Default::default();
        self.note("materials with classic-model parameters that glTF cannot express", usize::from(classic));
        self.note("height maps, which glTF does not support", usize::from(material.height.is_some()));
    }

    /// Notes colours above 1.
    fn note_above_one(&mut self, what: &str, values: &[f32]) {
        let above = values.iter().any(|v| *v > 1.0);
        self.note(&format!("{what} above 1, which glTF clamps"), usize::from(above));
    }

    /// Notes factors of a layer that glTF clamps.
    fn note_clamped(&mut self, layer: &Layer, material: &Material) {
        for factor in layer.factors {
            if let (Some(FactorValue::Color(color)), 1.0) = ((factor.get)(material), factor.most) {
                self.note_above_one(&format!("{}s", factor.name), &color);
            }
        }
    }

    /// Describes all textures of a material that glTF can express.
    fn texture_uses(&mut self, material: &Material) -> Vec<TextureInfo> {
        let mut uses: Vec<TextureInfo> =
            CORE_TEXTURES.iter().filter_map(|role| self.texture_use(*role, material)).collect();
        for layer in &LAYERS {
            self.note_clamped(layer, material);
            uses.extend(layer.textures.iter().filter_map(|role| self.texture_use(*role, material)));
        }
        uses
    }

    /// Describes a texture; `None` if the material has none in this role, or with a warning if it is an object-space
    /// normal map.
    fn texture_use(&mut self, role: TextureRole, material: &Material) -> Option<TextureInfo> {
        let used = role.of(material)?;
        let map = role.normal_map(material);
        if map.is_some_and(|map| map.space == NormalSpace::Object) {
            self.note("object-space normal maps, which glTF does not support", 1);
            return None;
        }
        let texture = self.texture(used, map.is_some_and(|map| map.green == GreenChannel::Down));
        let weight = map.map_or(material.occlusion_strength, |map| map.scale);
        let info = TextureInfo { role, texture, uv_set: used.uv_set, transform: used.transform, weight };
        self.note("sheared texture uvs, which glTF does not support", usize::from(info.is_sheared()));
        Some(info)
    }

    /// Returns the index of a texture in the document; its green channel is `turned` if it points down.
    fn texture(&mut self, used: &TextureRef, turned: bool) -> usize {
        let image = number(&mut self.textures.images, ImageUse { texture: used.texture, turned });
        let sampler = number(&mut self.textures.samplers, used.sampler);
        number(&mut self.textures.textures, [sampler, image])
    }

    /// Encodes every requested image.
    pub(super) fn encoded_images(&mut self) -> Result<Vec<Image>> {
        self.format.check()?;
        let (scene, format) = (self.scene, self.format);
        let used = &self.textures.images;
        let encode = |i: usize| encoded(&scene.textures()[used[i].texture], used[i].turned, &format);
        let images = parallel::tasks(used.len(), &encode);
        let images = images.into_iter().collect::<Result<Vec<Image>>>()?;
        self.note("float textures rounded to 16 bits in [0, 1]", images.iter().filter(|i| i.rounded).count());
        let what =
            "textures written as PNG: the chosen format has no alpha, or KTX2 needs sides in multiples of 4";
        self.note(what, images.iter().filter(|i| i.refused).count());
        Ok(images)
    }

    /// Adds images, samplers and textures; images are files next to the model with the name `stem`, if any.
    pub(super) fn add_textures(&mut self, images: &[Image], stem: Option<&str>) {
        if images.is_empty() {
            return;
        }
        let draft = &mut self.draft;
        let entries = images.iter().enumerate().map(|(i, image)| match stem {
            Some(stem) => json!({ "uri": uri(&file_name(stem, i, image)) }),
            None => {
                json!({ "bufferView": draft.view(&image.bytes), "mimeType": image.kind.media_type() })
            }
        });
        let entries: Value = entries.collect();
        images.iter().filter_map(|image| image.kind.extension()).for_each(|name| draft.require(name));
        let texture = |[sampler, source]: &[usize; 2]| match images[*source].kind.extension() {
            None => json!({ "sampler": sampler, "source": source }),
            Some(name) => json!({ "sampler": sampler, "extensions": { name: { "source": source } } }),
        };
        draft.json["textures"] = self.textures.textures.iter().map(texture).collect();
        draft.json["images"] = entries;
        draft.json["samplers"] = self.textures.samplers.iter().map(sampler_json).collect();
    }
}

/// Returns the index of a value in a list, adding it if necessary.
fn number<T: PartialEq>(list: &mut Vec<T>, value: T) -> usize {
    list.iter().position(|known| *known == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

fn encoded(texture: &Texture, turned: bool, format: &GltfFormat) -> Result<Image> {
    if let (true, false, Some((file, kind))) = (format.for_page, turned, own_file(texture)) {
        return Ok(Image { bytes: file.to_vec(), kind, rounded: false, refused: false });
    }
    let (bitmap, rounded) = whole_numbers(texture)?;
    let bitmap = if turned { Cow::Owned(with_green_turned(&bitmap)?) } else { bitmap };
    let encoding = texture.encoding();
    let alpha = encoding != Encoding::Normal && matches!(bitmap.channels(), 2 | 4);
    let wanted = format.images.of(encoding);
    let refused = (alpha && !wanted.holds_alpha()) || !wanted.holds_size([bitmap.width(), bitmap.height()]);
    let codec = if refused { ImageCodec::Png } else { wanted };
    let stored = Stored { encoding, alpha, for_page: format.for_page };
    let bytes = image_encoding::encode(&bitmap, stored, codec)?;
    Ok(Image { bytes, kind: codec.kind(), rounded, refused })
}

/// Returns the file that a texture was read from, if every program decodes it to nearly the same values: decoders of
/// lossy files differ by up to 4 codes of 255, which is too much for the roughness of highlights.
fn own_file(texture: &Texture) -> Option<(&[u8], CodecKind)> {
    let file = texture.bitmap().file()?;
    let is_exact = file.get(12..16) == Some(&b"VP8L"[..]);
    (is_exact || texture.encoding() != Encoding::Linear).then_some((file, CodecKind::detect(file)?))
}

/// Returns the finest level in 8 or 16 bits, and whether floats were rounded.
fn whole_numbers(texture: &Texture) -> Result<(Cow<'_, Bitmap>, bool)> {
    let bitmap = texture.bitmap();
    let Texels::F32(texels) = bitmap.texels() else { return Ok((Cow::Borrowed(bitmap), false)) };
    let is_srgb = texture.encoding() == Encoding::Srgb;
    let code = |v: f64| (v.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16;
    let stored = |i: usize, v: f32| match is_srgb && i < 3 {
        true => code(srgb::srgb_from_linear(f64::from(v).clamp(0.0, 1.0))),
        false => code(f64::from(v)),
    };
    let read = |i: usize, code: u16| match is_srgb && i < 3 {
        true => srgb::linear_from_srgb(f64::from(code) / 65535.0) as f32,
        false => f32::from(code) / 65535.0,
    };
    let codes = parallel::collect(texels.len(), |t| [0, 1, 2, 3].map(|i| stored(i, texels[t][i])));
    let differs = |t: usize| (0..4).any(|i| read(i, codes[t][i]) != texels[t][i]);
    let rounded = parallel::first(texels.len(), differs).is_some();
    let bitmap = Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), Texels::U16(codes))?;
    Ok((Cow::Owned(bitmap), rounded))
}

/// Returns the same normals, flipped exactly to green up.
fn with_green_turned(bitmap: &Bitmap) -> Result<Bitmap> {
    let texels = match bitmap.texels() {
        Texels::U8(texels) => Texels::U8(texels.iter().map(|[r, g, b, a]| [*r, 255 - g, *b, *a]).collect()),
        Texels::U16(texels) => {
            Texels::U16(texels.iter().map(|[r, g, b, a]| [*r, 65535 - g, *b, *a]).collect())
        }
        Texels::F32(texels) => Texels::F32(texels.iter().map(|[r, g, b, a]| [*r, 1.0 - g, *b, *a]).collect()),
    };
    Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), texels)
}
