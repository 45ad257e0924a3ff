//! Maps from files, applied to every material of a scene.

use super::change::Change;
use crate::error::{Error, Result};
use crate::image::{Encoding, Sampler, Texture};
use crate::io::{self, Limits};
use crate::scene::{GreenChannel, HeightMap, NormalMap, NormalSpace, Scene, TextureRef, UvTransform};
use std::path::PathBuf;

/// Default height of white, as a fraction of the model's size.
const DEFAULT_HEIGHT: f64 = 0.01;

/// Maps for every material of a scene: paths of images. Maps not specified are unchanged.
///
/// ```
/// use taotie::scene::GreenChannel;
/// use taotie::studio::MapOptions;
///
/// let maps = MapOptions { normal: Some("dx.png".into()), green: GreenChannel::Down, ..MapOptions::default() };
/// assert_eq!((maps.normal_scale, maps.height), (1.0, None));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct MapOptions {
    /// Base colour, sRGB.
    pub base_color: Option<PathBuf>,
    /// Roughness in green and metallic in blue, linear.
    pub metallic_roughness: Option<PathBuf>,
    /// A normal map.
    pub normal: Option<PathBuf>,
    /// Multiplies x and y of the normal map.
    pub normal_scale: f32,
    /// The space of the normal map.
    pub normal_space: NormalSpace,
    /// The direction of green in the normal map.
    pub green: GreenChannel,
    /// A height map; white is high.
    pub height: Option<PathBuf>,
    /// The height of white, in model units; `None` for a hundredth of the model's size.
    pub height_scale: Option<f32>,
    /// Occlusion in red, linear.
    pub occlusion: Option<PathBuf>,
    /// Emitted light, sRGB.
    pub emissive: Option<PathBuf>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            base_color: None,
            metallic_roughness: None,
            normal: None,
            normal_scale: 1.0,
            normal_space: NormalSpace::Tangent,
            green: GreenChannel::Up,
            height: None,
            height_scale: None,
            occlusion: None,
            emissive: None,
        }
    }
}

impl MapOptions {
    /// Reads the maps and applies them to every material of `scene`.
    ///
    /// # Errors
    /// Those of the files.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        self.apply_within(scene, &Limits::default())
    }

    /// Like [`MapOptions::apply`], within limits of memory and pixels.
    pub(super) fn apply_within(&self, scene: &mut Scene, limits: &Limits) -> Result<()> {
        self.load(scene, limits)?.apply(scene)?;
        Ok(())
    }

    /// Returns the files of the maps.
    pub fn files(&self) -> Vec<PathBuf> {
        let Self { base_color, metallic_roughness, normal, height, occlusion, emissive, .. } = self;
        let all = [base_color, metallic_roughness, normal, height, occlusion, emissive];
        all.into_iter().flatten().cloned().collect()
    }

    /// Adds the maps to the textures of `scene`; returns the change to its materials.
    pub(super) fn load(&self, scene: &mut Scene, limits: &Limits) -> Result<Change> {
        let size = scene.bounds().map_or(1.0, |bounds| bounds.diagonal());
        let mut load = |path: &Option<PathBuf>, encoding| {
            let bitmap = path.as_ref().map(|path| io::read_bitmap_within(path, limits)).transpose()?;
            Ok::<_, Error>(bitmap.map(|bitmap| whole(scene, Texture::new(bitmap, encoding))))
        };
        Ok(Change {
            reflectance: None,
            base_color: load(&self.base_color, Encoding::Srgb)?,
            metallic_roughness: load(&self.metallic_roughness, Encoding::Linear)?,
            normal: load(&self.normal, Encoding::Normal)?.map(|texture| NormalMap {
                texture,
                scale: self.normal_scale,
                space: self.normal_space,
                green: self.green,
            }),
            height: load(&self.height, Encoding::Linear)?.map(|texture| HeightMap {
                texture,
                scale: self.height_scale.unwrap_or((size * DEFAULT_HEIGHT) as f32),
            }),
            occlusion: load(&self.occlusion, Encoding::Linear)?,
            emissive: load(&self.emissive, Encoding::Srgb)?,
        })
    }
}

/// Adds a texture, shown unchanged.
fn whole(scene: &mut Scene, texture: Texture) -> TextureRef {
    let (sampler, transform) = (Sampler::default(), UvTransform::default());
    TextureRef { texture: scene.add_texture(texture), uv_set: 0, sampler, transform }
}
