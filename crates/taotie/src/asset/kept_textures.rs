//! Textures of a low-poly mesh's material that the asset keeps.

use super::notes::is_plain;
use super::options::BakeOptions;
use super::slots::SLOTS;
use crate::bake::MapKind;
use crate::error::Warnings;
use crate::image::{Bitmap, Sampler, TexelFilter, Wrap};
use crate::io;
use crate::scene::{Material, Scene, TextureRef};

/// Textures of a low-poly mesh's material that are kept unless something is baked in their place.
#[derive(Default)]
pub(super) struct KeptTextures {
    pub color: Option<Bitmap>,
    pub metallic_roughness: Option<Bitmap>,
    pub occlusion: Option<Bitmap>,
    pub emission: Option<Bitmap>,
}

impl KeptTextures {
    /// Takes the textures of a material that can be kept.
    pub fn of(material: &Material, scene: &Scene) -> Self {
        let bitmap = |texture: &Option<TextureRef>| {
            texture.as_ref().map(|texture| scene.textures()[texture.texture].bitmap().clone())
        };
        Self {
            color: bitmap(&material.base_color_texture),
            metallic_roughness: bitmap(&material.metallic_roughness_texture),
            occlusion: bitmap(&material.occlusion_texture),
            // A texture multiplied by zero shows nothing.
            emission: bitmap(&material.emissive_texture).filter(|_| material.emissive != [0.0; 3]),
        }
    }

    /// Takes the metalness to keep next to a baked roughness; a texture that cannot be kept there is noted. All other
    /// slots of a kept file are unchanged.
    pub fn beside_roughness(
        material: &mut Material,
        scene: &Scene,
        options: &BakeOptions,
        warnings: &mut Warnings,
    ) -> Self {
        let is_alone = options.bakes(&[MapKind::Roughness]) && !options.bakes(&[MapKind::MetallicRoughness]);
        let Some(texture) = material.metallic_roughness_texture.filter(|_| is_alone) else {
            return Self::default();
        };
        if is_plain(&texture) {
            let bitmap = scene.textures()[texture.texture].bitmap().clone();
            return Self { metallic_roughness: Some(bitmap), ..Self::default() };
        }
        warnings.note(
            "the low-poly mesh's metalness is left out: its texture uses another uv set, or a transform",
            1,
        );
        material.metallic = 0.0;
        Self::default()
    }
}

/// Notes kept textures that look different in the asset, which repeats all textures beyond [0, 1] and smooths them.
pub(super) fn note_samplers(
    material: &Material,
    scene: &Scene,
    options: &BakeOptions,
    warnings: &mut Warnings,
) {
    let asset = io::gltf_sampler(scene.meshes());
    for slot in SLOTS.iter().filter(|slot| slot.property.is_textured(material) && !slot.is_baked(options)) {
        let other = slot.texture(material).is_some_and(|texture| differs(&texture.sampler, &asset));
        let texture = format!("the low-poly mesh's {} texture", slot.name);
        let why = "its file mirrors it, clamps it, or does not smooth it";
        warnings.note(format!("{texture} is repeated and smoothed in the asset: {why}"), usize::from(other));
    }
}

/// Returns true if a texture looks different with the asset's sampler, which smooths, and clamps if no uv lies
/// outside [0, 1].
fn differs(own: &Sampler, asset: &Sampler) -> bool {
    let is_rough = [own.magnify, own.minify].contains(&TexelFilter::Nearest);
    is_rough || (asset.wrap_u == Wrap::Repeat && [own.wrap_u, own.wrap_v] != [Wrap::Repeat; 2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::mesh::Mesh;
    use crate::scene::UvTransform;

    /// Returns the number of notes about a base colour texture on a sphere whose uvs are multiplied by `scale`.
    fn said(sampler: Sampler, scale: f32, maps: Vec<MapKind>) -> usize {
        let mut data = Mesh::sphere(1.0, 8, 4).into_data();
        data.uvs[0].iter_mut().for_each(|uv| *uv = Vec2::new(uv.x * scale, uv.y * scale));
        let scene = Scene::of_mesh(Mesh::new(data).unwrap(), Material::default()).unwrap();
        let used = TextureRef { texture: 0, uv_set: 0, sampler, transform: UvTransform::default() };
        let material = Material { base_color_texture: Some(used), ..Material::default() };
        let mut warnings = Warnings::default();
        note_samplers(&material, &scene, &BakeOptions { maps, ..BakeOptions::default() }, &mut warnings);
        warnings.iter().count()
    }

    #[test]
    fn samplers_that_the_asset_has_not_are_told() {
        let mirror = Sampler { wrap_u: Wrap::Mirror, ..Sampler::default() };
        let rough = Sampler { magnify: TexelFilter::Nearest, ..Sampler::default() };
        assert_eq!([0.5, 2.0].map(|scale| said(mirror, scale, vec![])), [0, 1]);
        assert_eq!([0.5, 2.0].map(|scale| said(rough, scale, vec![])), [1, 1]);
        assert_eq!(said(Sampler::default(), 2.0, vec![]), 0);
        assert_eq!(said(rough, 2.0, vec![MapKind::Albedo]), 0, "a baked one replaces it");
    }
}
