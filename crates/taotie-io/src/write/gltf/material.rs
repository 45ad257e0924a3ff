//! The material of a model to be written: its factors, and its textures by role.

use super::material_json::{self, CORE_TEXTURES, MaterialParts, TextureInfo};
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Bitmap;
use taotie_engine::scene::{AlphaMode, Material, TextureRole, UvTransform};

/// glTF's metallic-roughness material; textures are multiplied by the factors and use the first uv set.
#[derive(Debug, Clone, Copy)]
pub struct GltfMaterial<'a> {
    /// Its name; may be empty.
    pub name: &'a str,
    /// The base colour, linear RGBA, each in [0, 1]; `alpha` determines whether the last is used.
    pub base_color: [f32; 4],
    /// The metalness, [0, 1].
    pub metallic: f32,
    /// The roughness, [0, 1]; α is its square.
    pub roughness: f32,
    /// The base colour texture, sRGB-encoded; its alpha is written if `alpha` uses it.
    pub base_color_map: Option<GltfImage<'a>>,
    /// The roughness in green and the metalness in blue; linear.
    pub metallic_roughness_map: Option<GltfImage<'a>>,
    /// The occlusion in red, 1 where nothing is occluded; linear. It may be the image of `metallic_roughness_map`,
    /// which is then written once.
    pub occlusion_map: Option<GltfImage<'a>>,
    /// The strength of the occlusion, [0, 1].
    pub occlusion_strength: f32,
    /// The tangent-space normal map, linear, +Y up.
    pub normal_map: Option<GltfImage<'a>>,
    /// The scale of x and y of the normals; finite.
    pub normal_scale: f32,
    /// The emitted radiance, linear RGB, 0 or more.
    pub emissive: [f32; 3],
    /// The texture that multiplies `emissive`, sRGB-encoded.
    pub emissive_map: Option<GltfImage<'a>>,
    /// The alpha mode.
    pub alpha: AlphaMode,
    /// A material whose layers this one shares: index of refraction, specular strength, clearcoat, anisotropy, sheen,
    /// unlit. Their factors are written, but not their textures.
    pub layers: Option<&'a Material>,
    /// `true` if triangles are visible from both sides.
    pub double_sided: bool,
}

impl Default for GltfMaterial<'_> {
    /// Returns a white, rough, non-metallic material.
    fn default() -> Self {
        Self {
            name: "",
            base_color: [1.0; 4],
            metallic: 0.0,
            roughness: 1.0,
            base_color_map: None,
            metallic_roughness_map: None,
            occlusion_map: None,
            occlusion_strength: 1.0,
            normal_map: None,
            normal_scale: 1.0,
            emissive: [0.0; 3],
            emissive_map: None,
            alpha: AlphaMode::Opaque,
            layers: None,
            double_sided: false,
        }
    }
}

impl<'a> GltfMaterial<'a> {
    /// Describes it as a new material with these textures.
    pub(super) fn parts(&self, textures: Vec<TextureInfo>) -> MaterialParts<'a> {
        MaterialParts {
            name: self.name,
            double_sided: Some(self.double_sided),
            base_color: Some(self.base_color),
            metallic: Some(self.metallic),
            roughness: Some(self.roughness),
            emissive: Some(self.emissive).filter(|radiance| *radiance != [0.0; 3]),
            alpha: Some(self.alpha),
            layers: self.layers.into_iter().flat_map(material_json::layers).collect(),
            textures,
        }
    }

    /// Describes the use of a texture, given by index: uv set 0, untransformed.
    pub(super) fn texture(&self, role: TextureRole, texture: usize) -> TextureInfo {
        let weight = if role == TextureRole::Occlusion { self.occlusion_strength } else { self.normal_scale };
        TextureInfo { role, texture, uv_set: 0, transform: UvTransform::default(), weight }
    }

    /// Returns its textures in the order of writing.
    pub(super) fn maps(&self) -> impl Iterator<Item = (TextureRole, GltfImage<'a>)> {
        let maps = [
            self.base_color_map,
            self.metallic_roughness_map,
            self.occlusion_map,
            self.normal_map,
            self.emissive_map,
        ];
        CORE_TEXTURES.into_iter().zip(maps).filter_map(|(role, image)| Some((role, image?)))
    }

    /// Returns true if the material has at least one map.
    pub fn has_maps(&self) -> bool {
        self.maps().next().is_some()
    }

    /// Checks that its numbers are valid in glTF.
    pub(super) fn check(&self) -> Result<()> {
        let fractions = [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("occlusion strength", self.occlusion_strength),
        ];
        let colors = self.base_color.map(|v| ("base colour", v));
        for (name, value) in fractions.into_iter().chain(colors) {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::invalid(name, format!("{value} is not in [0, 1]")));
            }
        }
        if let Some(value) = self.emissive.into_iter().find(|v| !(0.0..=f32::MAX).contains(v)) {
            return Err(Error::invalid("emission", format!("{value} is negative, infinite or NaN")));
        }
        check_alpha(self.alpha)?;
        if !self.normal_scale.is_finite() {
            return Err(Error::invalid("normal scale", format!("{} is not finite", self.normal_scale)));
        }
        Ok(())
    }
}

/// Checks that the cutoff of a mask is valid in glTF.
pub(super) fn check_alpha(mode: AlphaMode) -> Result<()> {
    match mode {
        AlphaMode::Mask(cutoff) if !(0.0..=f32::MAX).contains(&cutoff) => {
            Err(Error::invalid("alpha cutoff", format!("{cutoff} is negative, infinite or NaN")))
        }
        _ => Ok(()),
    }
}

/// A texture's image.
#[derive(Debug, Clone, Copy)]
pub enum GltfImage<'a> {
    /// 8-bit or 16-bit texels; alpha is written if the material reads it.
    Bitmap(&'a Bitmap),
    /// An existing file next to the model, by its relative path with `/`.
    File(&'a str),
}

impl<'a> From<&'a Bitmap> for GltfImage<'a> {
    fn from(bitmap: &'a Bitmap) -> Self {
        Self::Bitmap(bitmap)
    }
}

impl GltfImage<'_> {
    /// Returns `true` if both are the same image, so that it only has to be written once.
    pub(super) fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bitmap(a), Self::Bitmap(b)) => std::ptr::eq(*a, *b),
            (Self::File(a), Self::File(b)) => a == b,
            _ => false,
        }
    }
}
