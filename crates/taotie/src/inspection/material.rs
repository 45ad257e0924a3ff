//! A material: its factors, the layers that glTF's extensions add, its textures, and the kind of its normal map, as
//! drawn and as guessed from its pixels.

use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};
use taotie_engine::image::{Bitmap, Encoding};
use taotie_engine::scene::{
    AlphaMode, Classic, Factor, FactorValue, GreenChannel, LAYERS, Layer, Material, NormalMap, NormalSpace,
    TextureRef, TextureRole,
};
use taotie_engine::surface::{GreenVerdict, NormalMapKind, green_direction, invalid_texels, is_normal_map};
use taotie_io::Loaded;

/// A material: its factors, its textures, and information about its normal map.
///
/// ```
/// use taotie::inspection::{Inspection, MaterialReport};
///
/// /// Returns the materials that are see-through.
/// fn blended(inspection: &Inspection) -> impl Iterator<Item = &MaterialReport> {
///     inspection.materials.iter().filter(|material| material.alpha_mode == "blend")
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct MaterialReport {
    /// As in the file; may be empty.
    pub name: String,
    /// Linear RGB and alpha.
    pub base_color: [f32; 4],
    /// [0, 1].
    pub metallic: f32,
    /// [0, 1].
    pub roughness: f32,
    /// Reflectance at normal incidence, linear RGB, if specified in the file.
    pub f0: Option<[f32; 3]>,
    /// Index of refraction of the dielectric part.
    pub ior: f32,
    /// The layers that extensions of glTF add: one for each of [`LAYERS`], in order.
    #[serde(flatten, serialize_with = "by_name")]
    pub layers: Vec<LayerReport>,
    /// Emitted radiance, linear RGB.
    pub emissive: [f32; 3],
    /// `opaque`, `mask` or `blend`.
    pub alpha_mode: String,
    /// The cutoff of `mask`.
    pub alpha_cutoff: Option<f32>,
    /// `true` if back faces are drawn.
    pub double_sided: bool,
    /// `true` if lighting is ignored.
    pub unlit: bool,
    /// The weight of the occlusion texture, [0, 1].
    pub occlusion_strength: f32,
    /// The height of white of the height map, model units.
    pub height_scale: Option<f32>,
    /// The parameters of the classic models.
    pub classic: ClassicReport,
    /// The textures that it uses.
    pub textures: Vec<TextureReport>,
    /// The normal map: how it is drawn, and the guess from its pixels.
    pub normal_map: Option<NormalMapReport>,
}

/// Parameters of the classic models specified in the file.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct ClassicReport {
    /// k_a, linear RGB.
    pub ambient: Option<[f32; 3]>,
    /// k_d, linear RGB.
    pub diffuse: Option<[f32; 3]>,
    /// k_s, linear RGB.
    pub specular: Option<[f32; 3]>,
    /// Exponent.
    pub shininess: Option<f32>,
    /// Beckmann rms slope.
    pub slope: Option<f32>,
}

/// A texture in its role.
///
/// ```
/// use taotie::inspection::{MaterialReport, TextureReport};
///
/// /// Returns the largest texture of a material.
/// fn largest(material: &MaterialReport) -> Option<&TextureReport> {
///     material.textures.iter().max_by_key(|texture| texture.width * texture.height)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct TextureReport {
    /// The [label](TextureRole::label) of its role, such as `base-color` or `clearcoat-normal`.
    pub role: String,
    /// The file or name.
    pub file: String,
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Bits per channel.
    pub bits: u8,
    /// Channels in the file, 1 to 4.
    pub channels: u8,
    /// `srgb` or `linear`.
    pub encoding: String,
    /// The uv set of the mesh.
    pub uv_set: usize,
}

/// Reports on materials, analysing the pixels of each normal map once.
pub(super) struct Materials<'a> {
    loaded: &'a Loaded,
    pixels: HashMap<usize, Pixels>,
}

impl<'a> Materials<'a> {
    /// Prepares reports on the materials of `loaded`.
    pub fn new(loaded: &'a Loaded) -> Self {
        let scene = &loaded.scene;
        let maps = scene.materials().iter().filter_map(|material| Some(material.normal?.texture.texture));
        let maps: BTreeSet<usize> = maps.collect();
        let pixels = maps.into_par_iter().map(|map| (map, Pixels::of(scene.textures()[map].bitmap())));
        Self { loaded, pixels: pixels.collect() }
    }

    /// Returns one report per material, in order.
    pub fn reports(&self) -> Vec<MaterialReport> {
        self.loaded.scene.materials().par_iter().map(|material| self.report(material)).collect()
    }

    fn report(&self, material: &Material) -> MaterialReport {
        let (alpha_mode, alpha_cutoff) = match material.alpha {
            AlphaMode::Opaque => ("opaque", None),
            AlphaMode::Mask(cutoff) => ("mask", Some(cutoff)),
            AlphaMode::Blend => ("blend", None),
        };
        MaterialReport {
            name: material.name.clone(),
            base_color: material.base_color,
            metallic: material.metallic,
            roughness: material.roughness,
            f0: material.f0,
            ior: material.ior,
            layers: LAYERS.iter().map(|layer| LayerReport::new(layer, material)).collect(),
            emissive: material.emissive,
            alpha_mode: alpha_mode.into(),
            alpha_cutoff,
            double_sided: material.double_sided,
            unlit: material.unlit,
            occlusion_strength: material.occlusion_strength,
            height_scale: material.height.map(|map| map.scale),
            classic: ClassicReport::new(&material.classic),
            textures: self.textures(material),
            normal_map: material
                .normal
                .map(|map| NormalMapReport::new(&map, self.pixels[&map.texture.texture].clone())),
        }
    }

    fn textures(&self, material: &Material) -> Vec<TextureReport> {
        let used = TextureRole::ALL.into_iter().filter_map(|role| Some((role, role.of(material)?)));
        used.map(|(role, texture)| self.texture(role, texture)).collect()
    }

    fn texture(&self, role: TextureRole, used: &TextureRef) -> TextureReport {
        let texture = &self.loaded.scene.textures()[used.texture];
        let name = self.loaded.texture_names.get(used.texture).cloned();
        TextureReport {
            role: role.label(),
            file: name.unwrap_or_else(|| format!("texture {}", used.texture)),
            width: texture.width(),
            height: texture.height(),
            bits: texture.bitmap().bits(),
            channels: texture.bitmap().channels(),
            encoding: match texture.encoding() {
                Encoding::Srgb => "srgb".into(),
                Encoding::Linear | Encoding::Normal => "linear".into(),
            },
            uv_set: used.uv_set,
        }
    }
}

impl ClassicReport {
    fn new(classic: &Classic) -> Self {
        let Classic { ambient, diffuse, specular, shininess, slope } = *classic;
        Self { ambient, diffuse, specular, shininess, slope }
    }
}

/// A layer that an extension of glTF adds to a material.
///
/// ```
/// use taotie::inspection::{LayerReport, MaterialReport};
///
/// /// Returns the layers that the material has.
/// fn present(material: &MaterialReport) -> impl Iterator<Item = &LayerReport> {
///     material.layers.iter().filter(|layer| !layer.values.is_empty())
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LayerReport {
    /// Its name, such as `clearcoat`.
    pub name: &'static str,
    /// Its factors by name, then `normal_scale`, `None` without a normal map, if the layer can have one; empty if the
    /// material lacks the layer.
    pub values: Vec<(String, Option<FactorValue>)>,
}

impl LayerReport {
    fn new(layer: &Layer, material: &Material) -> Self {
        let factor = |factor: &Factor| {
            let value = (factor.get)(material)?;
            let unit = if matches!(value, FactorValue::Angle(_)) { "_deg" } else { "" };
            Some((format!("{}{unit}", factor.field), Some(value)))
        };
        let mut values: Vec<_> = layer.factors.iter().filter_map(factor).collect();
        if !values.is_empty() {
            let maps = layer.textures.iter().filter(|role| role.encoding() == Encoding::Normal);
            let scales = maps.map(|role| role.normal_map(material).map(|map| FactorValue::Number(map.scale)));
            values.extend(scales.map(|scale| ("normal_scale".to_owned(), scale)));
        }
        Self { name: layer.key(), values }
    }
}

impl serde::Serialize for LayerReport {
    /// Writes a map of the values, or null.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.values.is_empty() {
            true => serializer.serialize_none(),
            false => serializer.collect_map(self.values.iter().map(|(name, value)| (name, value))),
        }
    }
}

/// Writes a map of layers.
fn by_name<S: serde::Serializer>(layers: &[LayerReport], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(layers.iter().map(|layer| (layer.name, layer)))
}

/// A normal map: how it is drawn, and the guess from its pixels.
///
/// ```
/// use taotie::inspection::{MaterialReport, NormalMapReport};
/// use taotie_engine::scene::GreenChannel;
///
/// /// Returns `true` if green points down, as in DirectX.
/// fn is_directx(material: &MaterialReport) -> bool {
///     let is_down = |map: &NormalMapReport| map.green == GreenChannel::Down;
///     material.normal_map.as_ref().is_some_and(is_down)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct NormalMapReport {
    /// Multiplies x and y.
    pub scale: f32,
    /// The space in which it is drawn.
    pub space: NormalSpace,
    /// The green direction with which it is drawn.
    pub green: GreenChannel,
    /// The guess from its pixels.
    #[serde(flatten)]
    pub pixels: Pixels,
}

/// The guess about a normal map from its pixels.
///
/// ```
/// use taotie::inspection::Pixels;
/// use taotie_engine::surface::NormalMapKind;
///
/// /// Returns `true` if the pixels leave no doubt that this is a tangent-space map.
/// fn is_surely_tangent(pixels: &Pixels) -> bool {
///     pixels.kind_by_pixels == NormalMapKind::Tangent && pixels.invalid_texels == Some(0)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Pixels {
    /// Its kind.
    pub kind_by_pixels: NormalMapKind,
    /// Its green direction; `None` unless it is a tangent-space map.
    pub green_by_pixels: Option<GreenVerdict>,
    /// The confidence in the green direction, [0, 1]; 0 if unclear.
    pub green_confidence: Option<f32>,
    /// Texels that cannot be tangent-space normals; `None` unless it is such a map.
    pub invalid_texels: Option<usize>,
    /// The number of texels.
    pub texels: usize,
}

impl NormalMapReport {
    /// Makes the report on `map`, given the analysis of its `pixels`.
    fn new(map: &NormalMap, pixels: Pixels) -> Self {
        Self { scale: map.scale, space: map.space, green: map.green, pixels }
    }
}

impl Pixels {
    /// Reports on a texture that is used as a normal map.
    pub(crate) fn of(bitmap: &Bitmap) -> Self {
        let kind = is_normal_map(bitmap);
        let guess = (kind == NormalMapKind::Tangent).then(|| green_direction(bitmap));
        Self {
            kind_by_pixels: kind,
            green_by_pixels: guess.map(|guess| guess.verdict),
            green_confidence: guess.map(|guess| guess.confidence),
            invalid_texels: guess.map(|_| invalid_texels(bitmap)),
            texels: bitmap.texels().len(),
        }
    }
}
