//! Textures of a low-poly mesh's material that stay in the asset.

use crate::image::Bitmap;
use crate::scene::{Material, Scene, TextureRef};

/// Textures of a low-poly mesh's material that stay where nothing is baked in their place.
#[derive(Default)]
pub(super) struct KeptTextures {
    pub color: Option<Bitmap>,
    pub metallic_roughness: Option<Bitmap>,
    pub occlusion: Option<Bitmap>,
    pub emission: Option<Bitmap>,
}

impl KeptTextures {
    /// Takes those of a material whose textures can stay.
    pub fn of(material: &Material, scene: &Scene) -> Self {
        let bitmap = |texture: &Option<TextureRef>| {
            texture.as_ref().map(|texture| scene.textures()[texture.texture].bitmap().clone())
        };
        Self {
            color: bitmap(&material.base_color_texture),
            metallic_roughness: bitmap(&material.metallic_roughness_texture),
            occlusion: bitmap(&material.occlusion_texture),
            // A texture that multiplies nothing shows nothing.
            emission: bitmap(&material.emissive_texture).filter(|_| material.emissive != [0.0; 3]),
        }
    }
}
