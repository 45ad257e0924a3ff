//! The factors and textures of a material.

use super::layers::LayersReport;
use super::normal_map::{NormalMapReport, Pixels};
use crate::image::Encoding;
use crate::io::Loaded;
use crate::scene::{AlphaMode, Classic, Material, TextureRef, TextureRole};
use std::collections::HashMap;

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
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    #[cfg_attr(feature = "serde", serde(flatten))]
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
///
/// ```
/// use taotie::inspection::ClassicReport;
///
/// /// Returns `true` if the file specifies parameters of Phong's model.
/// fn is_for_phong(classic: &ClassicReport) -> bool {
///     classic.specular.is_some() && classic.shininess.is_some()
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
