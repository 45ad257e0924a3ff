//! Object-space normal maps, which glTF cannot reference, added to a scene.

use crate::error::Result;
use crate::image::{Sampler, Texture};
use crate::scene::{GreenChannel, NormalMap, NormalSpace, Scene, TextureRef, UvTransform};

/// Assigns an object-space normal map to the material with this number, or to all of them.
pub(super) fn show(
    scene: &mut Scene,
    material: Option<usize>,
    (texture, sampler): (&Texture, Sampler),
) -> Result<()> {
    scene.edit(|scene| {
        scene.textures.push(texture.clone());
        let (number, transform) = (scene.textures.len() - 1, UvTransform::default());
        let texture = TextureRef { texture: number, uv_set: 0, sampler, transform };
        let map = NormalMap { texture, scale: 1.0, space: NormalSpace::Object, green: GreenChannel::Up };
        let shown =
            scene.materials.iter_mut().enumerate().filter(|(i, _)| material.is_none_or(|own| own == *i));
        shown.for_each(|(_, material)| material.normal = Some(map));
    })
}
