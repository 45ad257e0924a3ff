//! A material: its factors, the layers that glTF's extensions add, its textures, and the kind of its normal map, as
//! drawn and as guessed from its pixels.

use std::collections::HashMap;
use taotie_engine::image::{Bitmap, Encoding};
use taotie_engine::scene::{
    AlphaMode, Classic, GreenChannel, Material, NormalMap, NormalSpace, TextureRef, TextureRole,
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
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// The layers that extensions of glTF add.
    #[serde(flatten)]
    pub layers: LayersReport,
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
    /// `base-color`, `metallic-roughness`, `normal`, `height`, `occlusion`, `emissive`, `specular`, `specular-color`,
    /// `clearcoat`, `clearcoat-roughness`, `clearcoat-normal`, `anisotropy`, `sheen-color` or `sheen-roughness`.
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
        Self { loaded, pixels: HashMap::new() }
    }

    /// Returns one report per material, in order.
    pub fn reports(mut self) -> Vec<MaterialReport> {
        self.loaded.scene.materials().iter().map(|material| self.report(material)).collect()
    }

    fn report(&mut self, material: &Material) -> MaterialReport {
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
            layers: LayersReport::new(material),
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
                .map(|map| NormalMapReport::new(&map, self.pixels(map.texture.texture))),
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

    fn pixels(&mut self, texture: usize) -> Pixels {
        let bitmap = self.loaded.scene.textures()[texture].bitmap();
        self.pixels.entry(texture).or_insert_with(|| Pixels::of(bitmap)).clone()
    }
}

impl ClassicReport {
    fn new(classic: &Classic) -> Self {
        let Classic { ambient, diffuse, specular, shininess, slope } = *classic;
        Self { ambient, diffuse, specular, shininess, slope }
    }
}

/// The layers that glTF's extensions add to a material.
///
/// ```
/// use taotie::inspection::LayersReport;
///
/// /// Returns `true` if a viewer without extensions shows the same.
/// fn is_plain(layers: &LayersReport) -> bool {
///     layers.ior == 1.5
///         && layers.specular.factor == 1.0
///         && layers.specular.color == [1.0; 3]
///         && layers.clearcoat.is_none()
///         && layers.anisotropy.is_none()
///         && layers.sheen.is_none()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct LayersReport {
    /// Index of refraction of the dielectric part.
    pub ior: f32,
    /// The strength of the dielectric part's reflection.
    pub specular: SpecularReport,
    /// A clearcoat.
    pub clearcoat: Option<ClearcoatReport>,
    /// Anisotropic highlights.
    pub anisotropy: Option<AnisotropyReport>,
    /// The sheen layer.
    pub sheen: Option<SheenReport>,
}

/// The strength of the dielectric part's reflection.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SpecularReport {
    /// [0, 1].
    pub factor: f32,
    /// Linear RGB.
    pub color: [f32; 3],
}

/// A clearcoat.
///
/// ```
/// use taotie::inspection::ClearcoatReport;
///
/// /// Returns `true` if the clearcoat is flat and mirrors.
/// fn is_mirror(coat: &ClearcoatReport) -> bool {
///     coat.normal_scale.is_none() && coat.roughness == 0.0
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct ClearcoatReport {
    /// [0, 1].
    pub factor: f32,
    /// [0, 1].
    pub roughness: f32,
    /// The scale of its normal map, if it has one.
    pub normal_scale: Option<f32>,
}

/// Anisotropic highlights.
///
/// ```
/// use taotie::inspection::AnisotropyReport;
///
/// /// Returns `true` if highlights run along the tangent.
/// fn runs_along_tangent(anisotropy: &AnisotropyReport) -> bool {
///     anisotropy.strength > 0.0 && anisotropy.rotation_deg == 0.0
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct AnisotropyReport {
    /// [0, 1].
    pub strength: f32,
    /// Degrees counter-clockwise from the tangent.
    pub rotation_deg: f64,
}

/// A sheen layer.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SheenReport {
    /// Linear RGB.
    pub color: [f32; 3],
    /// [0, 1].
    pub roughness: f32,
}

impl LayersReport {
    fn new(material: &Material) -> Self {
        let specular = &material.specular;
        Self {
            ior: material.ior,
            specular: SpecularReport { factor: specular.factor, color: specular.color },
            clearcoat: material.clearcoat.map(|coat| ClearcoatReport {
                factor: coat.factor,
                roughness: coat.roughness,
                normal_scale: coat.normal.map(|map| map.scale),
            }),
            anisotropy: material.anisotropy.map(|anisotropy| AnisotropyReport {
                strength: anisotropy.strength,
                rotation_deg: anisotropy.rotation.to_degrees(),
            }),
            sheen: material.sheen.map(|sheen| SheenReport { color: sheen.color, roughness: sheen.roughness }),
        }
    }
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
