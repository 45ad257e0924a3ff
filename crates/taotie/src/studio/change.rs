//! A change to every material of a scene.

use crate::error::Result;
use crate::scene::{HeightMap, Material, NormalMap, Scene, TextureRef};

/// A change to every material; parts that are `None` are unchanged.
#[derive(Debug, Default)]
pub(super) struct Change {
    /// Replaces the reflectance; relief and occlusion maps are kept.
    pub reflectance: Option<Material>,
    pub base_color: Option<TextureRef>,
    pub metallic_roughness: Option<TextureRef>,
    pub normal: Option<NormalMap>,
    pub height: Option<HeightMap>,
    pub occlusion: Option<TextureRef>,
    pub emissive: Option<TextureRef>,
}

impl Change {
    /// Changes every material of `scene`.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a factor is out of range.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        scene.edit(|scene| scene.materials.iter_mut().for_each(|material| self.change(material)))
    }

    fn change(&self, material: &mut Material) {
        if let Some(reflectance) = &self.reflectance {
            *material = Material {
                name: std::mem::take(&mut material.name),
                normal: material.normal,
                height: material.height,
                occlusion_texture: material.occlusion_texture,
                occlusion_strength: material.occlusion_strength,
                double_sided: material.double_sided || reflectance.double_sided,
                ..reflectance.clone()
            };
        }
        material.base_color_texture = self.base_color.or(material.base_color_texture);
        material.metallic_roughness_texture = self.metallic_roughness.or(material.metallic_roughness_texture);
        material.normal = self.normal.or(material.normal);
        material.height = self.height.or(material.height);
        material.occlusion_texture = self.occlusion.or(material.occlusion_texture);
        material.emissive_texture = self.emissive.or(material.emissive_texture);
    }
}
