//! The textures of a material: each image is encoded once, with its place in a document; and the sampler of all.

use super::codec::{CodecKind, ImageCodec};
use super::draft::{GltfDraft, uri};
use super::format::GltfFormat;
use super::image_encoding::{self, Stored};
use super::material::{GltfImage, GltfMaterial, TextureInfo};
use crate::write::FileBytes;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use taotie_engine::error::Result;
use taotie_engine::image::{Encoding, MipFilter, Sampler, TexelFilter, Wrap};
use taotie_engine::math::Vec2;
use taotie_engine::mesh::Mesh;
use taotie_engine::parallel;
use taotie_engine::scene::{AlphaMode, TextureRole};

/// An image to be written, and the roles of the textures that use it.
#[derive(Debug)]
pub(super) struct Encoded<'a> {
    image: GltfImage<'a>,
    codec: ImageCodec,
    roles: Vec<TextureRole>,
    /// `true` if the material reads its alpha.
    alpha: bool,
    bytes: Vec<u8>,
}

impl<'a> Encoded<'a> {
    /// Takes the unencoded image of a texture.
    fn new(role: TextureRole, image: GltfImage<'a>, alpha: AlphaMode) -> Self {
        let has_alpha = matches!(image, GltfImage::Bitmap(bitmap) if matches!(bitmap.channels(), 2 | 4));
        let alpha = has_alpha && role == TextureRole::BaseColor && alpha != AlphaMode::Opaque;
        Self { image, codec: ImageCodec::Png, roles: vec![role], alpha, bytes: Vec::new() }
    }

    /// Chooses the format; images with alpha become PNG if the format of colours does not support it.
    fn packed(self, format: &GltfFormat) -> Self {
        let wanted = format.images.of(self.encoding());
        let codec = if self.alpha && !wanted.holds_alpha() { ImageCodec::Png } else { wanted };
        Self { codec, ..self }
    }
}

impl Encoded<'_> {
    /// Returns the uses of the texture, given by index, that shows it on a material.
    pub fn uses(&self, texture: usize, material: &GltfMaterial) -> impl Iterator<Item = TextureInfo> {
        self.roles.iter().map(move |role| material.texture(*role, texture))
    }

    /// Returns the encoding of its texels, which all uses share.
    fn encoding(&self) -> Encoding {
        self.roles[0].encoding()
    }

    /// Returns the bytes of its file; `None` if the file already exists.
    pub fn bytes(&self) -> Option<&[u8]> {
        matches!(self.image, GltfImage::Bitmap(_)).then_some(&self.bytes)
    }

    /// Returns its file next to the model `path`; `None` if it already exists.
    pub fn into_file(self, path: &Path) -> Option<FileBytes> {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let file = path.with_file_name(self.file_name(&stem));
        matches!(self.image, GltfImage::Bitmap(_)).then_some(FileBytes { path: file, bytes: self.bytes })
    }

    /// Returns the name of its file next to a model.
    pub fn file_name(&self, stem: &str) -> String {
        match self.image {
            GltfImage::File(name) => name.to_owned(),
            GltfImage::Bitmap(_) => format!("{stem}_{}.{}", self.role(), self.codec.kind().file_extension()),
        }
    }

    /// Returns its media type.
    pub fn mime_type(&self) -> &'static str {
        self.codec.kind().media_type()
    }

    /// Returns a word for its content.
    pub fn role(&self) -> &'static str {
        match self.roles[..] {
            [TextureRole::MetallicRoughness, TextureRole::Occlusion] => "orm",
            [TextureRole::BaseColor, ..] => "color",
            [TextureRole::MetallicRoughness, ..] => "metallic_roughness",
            [TextureRole::Occlusion, ..] => "occlusion",
            [TextureRole::Emissive, ..] => "emissive",
            _ => "normal",
        }
    }

    /// Returns the texture for image `source`.
    pub fn texture(&self, source: usize) -> Value {
        match self.extension() {
            None => json!({ "sampler": 0, "source": source }),
            Some(name) => json!({ "sampler": 0, "extensions": { name: { "source": source } } }),
        }
    }

    /// Returns the extension of its texture; an existing file is used without one.
    pub fn extension(&self) -> Option<&'static str> {
        self.bytes().and(self.codec.kind().extension())
    }
}

/// The roles in the names of external images.
pub(super) const ROLES: [&str; 6] = ["orm", "color", "metallic_roughness", "occlusion", "emissive", "normal"];

/// Returns the name of every file that an image of these kinds, or PNG as a fallback, may have next to a model with
/// `coarser` coarser levels of detail.
pub(super) fn possible_names(stem: &str, (kinds, coarser): (&[CodecKind], usize)) -> Vec<String> {
    let kinds = [CodecKind::Png].iter().chain(kinds);
    let extensions: BTreeSet<&str> = kinds.map(|kind| kind.file_extension()).collect();
    let named = |role: &str| -> Vec<String> {
        extensions.iter().map(|extension| format!("{stem}_{role}.{extension}")).collect()
    };
    let of_level = |number: usize| ROLES.map(|role| level_role(number, role));
    let roles = ROLES.map(str::to_owned).into_iter().chain((1..=coarser).flat_map(of_level));
    roles.flat_map(|role| named(&role)).collect()
}

/// The prefix of the roles of images at a coarser level of detail.
pub(super) const LEVEL: &str = "lod";

/// Returns the role of an image at a coarser level of detail: `lod1_normal`.
pub(super) fn level_role(number: usize, role: &str) -> String {
    format!("{LEVEL}{number}_{role}")
}

/// Encodes every image of a material, in the order of writing. Roles with the same image in the same encoding share
/// it.
pub(super) fn encode<'a>(material: &GltfMaterial<'a>, format: &GltfFormat) -> Result<Vec<Encoded<'a>>> {
    format.check()?;
    let mut images: Vec<Encoded> = Vec::new();
    for (role, image) in material.maps() {
        let shared = |known: &&mut Encoded| known.image.is(&image) && known.encoding() == role.encoding();
        match images.iter_mut().find(shared) {
            Some(known) => known.roles.push(role),
            None => images.push(Encoded::new(role, image, material.alpha).packed(format)),
        }
    }
    let bytes = parallel::tasks(images.len(), &|i| match images[i].image {
        GltfImage::Bitmap(bitmap) => {
            let Encoded { alpha, codec, .. } = images[i];
            let stored = Stored { encoding: images[i].encoding(), alpha, for_page: format.for_page };
            image_encoding::encode(bitmap, stored, codec)
        }
        GltfImage::File(_) => Ok(Vec::new()),
    });
    for (encoded, bytes) in images.iter_mut().zip(bytes) {
        encoded.bytes = bytes?;
    }
    Ok(images)
}

/// The storage of images: within the document or in external files.
pub(super) enum ImageStorage<'a> {
    /// In the document's buffer.
    Inside,
    /// In files next to the model; this is its name without extension.
    Separate(&'a str),
}

/// Adds images, and a texture for each, all with one sampler.
pub(super) fn add(draft: &mut GltfDraft, images: &[Encoded], storage: &ImageStorage, sampler: &Sampler) {
    if images.is_empty() {
        return;
    }
    let json: Vec<Value> = images.iter().map(|image| entry(draft, image, storage)).collect();
    images.iter().filter_map(Encoded::extension).for_each(|name| draft.require(name));
    let textures: Vec<Value> = images.iter().enumerate().map(|(i, image)| image.texture(i)).collect();
    draft.json["images"] = json!(json);
    draft.json["textures"] = json!(textures);
    draft.json["samplers"] = json!([sampler_json(sampler)]);
}

fn entry(draft: &mut GltfDraft, image: &Encoded, storage: &ImageStorage) -> Value {
    match (image.bytes(), storage) {
        (Some(bytes), ImageStorage::Inside) => {
            let view = draft.view(bytes);
            json!({ "name": image.role(), "bufferView": view, "mimeType": image.mime_type() })
        }
        (Some(_), ImageStorage::Separate(stem)) => json!({ "uri": uri(&image.file_name(stem)) }),
        (None, _) => json!({ "uri": uri(&image.file_name("")) }),
    }
}

/// Returns the sampler of all textures of a [`GltfAsset`](super::GltfAsset) with these meshes: trilinear, and
/// clamped, or repeated if uvs of the first set leave [0, 1].
pub fn gltf_sampler<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Sampler {
    let is_inside = |uv: &Vec2| (0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y);
    let mut sets = meshes.into_iter().filter_map(|mesh| mesh.uvs().first());
    let wrap = if sets.all(|uvs| uvs.iter().all(is_inside)) { Wrap::Clamp } else { Wrap::Repeat };
    Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() }
}

/// Returns the constants of a sampler, which glTF takes from OpenGL: wrapping along u and v, magnification and
/// minification. WebGL has the same.
///
/// ```
/// use taotie_engine::image::Sampler;
///
/// assert_eq!(taotie_io::sampler_constants(&Sampler::default()), [10497, 10497, 9729, 9987]);
/// ```
pub fn sampler_constants(sampler: &Sampler) -> [u32; 4] {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    };
    let texels = |filter| match filter {
        TexelFilter::Nearest => 0,
        TexelFilter::Linear => 1,
    };
    let min = match sampler.mip {
        MipFilter::None => 9728,
        MipFilter::Nearest => 9984,
        MipFilter::Linear => 9986,
    };
    [wrap(sampler.wrap_u), wrap(sampler.wrap_v), 9728 + texels(sampler.magnify), min + texels(sampler.minify)]
}

/// Returns the JSON of a sampler.
pub(super) fn sampler_json(sampler: &Sampler) -> Value {
    let [wrap_s, wrap_t, magnify, minify] = sampler_constants(sampler);
    json!({ "magFilter": magnify, "minFilter": minify, "wrapS": wrap_s, "wrapT": wrap_t })
}
