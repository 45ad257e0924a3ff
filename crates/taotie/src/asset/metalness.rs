//! The metalness stored with a baked roughness: that of the low-poly mesh's own material.

use super::kept_textures::KeptTextures;
use crate::image::{Bitmap, Encoding, Sampler, Texture};
use crate::math::{Vec2, poly};
use crate::scene::Material;

/// The metalness of a material over the texels of a map.
pub(super) struct Metalness {
    factor: f32,
    /// Its blue channel multiplies `factor`.
    texture: Option<Texture>,
    /// Texels of the map across and down.
    size: [u32; 2],
}

impl Metalness {
    /// Takes the metalness of a material with kept textures, for a map of this size.
    pub fn of(material: &Material, kept: &KeptTextures, size: [u32; 2]) -> Self {
        let texture = |bitmap: &Bitmap| Texture::new(bitmap.clone(), Encoding::Linear);
        Self { factor: material.metallic, texture: kept.metallic_roughness.as_ref().map(texture), size }
    }

    /// Returns the metalness at the centre of texel `i`, [0, 1]; for a finer texture, the mean over the texel.
    pub fn at(&self, i: usize) -> f32 {
        let Some(texture) = &self.texture else { return self.factor };
        let [width, height] = self.size.map(|texels| texels as f32);
        let (x, y) = (i % self.size[0] as usize, i / self.size[0] as usize);
        let uv = Vec2::new((x as f32 + 0.5) / width, (y as f32 + 0.5) / height);
        let texels = (texture.width() as f32 / width).max(texture.height() as f32 / height);
        self.factor * Sampler::default().sample(texture, uv, poly::log2(texels))[2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Texels;

    /// Returns the metalness of all texels of a map, from a one-row texture with these blue values.
    fn of(blue: &[u8], map: u32) -> Vec<f32> {
        let texels = blue.iter().map(|blue| [255, 255, *blue, 255]).collect();
        let bitmap = Bitmap::new(blue.len() as u32, 1, 3, Texels::U8(texels)).unwrap();
        let kept = KeptTextures { metallic_roughness: Some(bitmap), ..KeptTextures::default() };
        let material = Material { metallic: 0.5, ..Material::default() };
        let metalness = Metalness::of(&material, &kept, [map, 1]);
        (0..map as usize).map(|i| metalness.at(i)).collect()
    }

    #[test]
    fn blue_times_the_factor_stands_there() {
        let is_near = |found: &[f32], wanted: &[f32]| {
            found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-6)
        };
        assert!(is_near(&of(&[0, 255, 255, 0], 4), &[0.0, 0.5, 0.5, 0.0]));
        assert!(is_near(&of(&[0, 0, 255, 255], 2), &[0.0, 0.5]), "the mean of two texels");
    }

    #[test]
    fn without_a_texture_it_is_the_factor() {
        let material = Material { metallic: 0.25, ..Material::default() };
        let metalness = Metalness::of(&material, &KeptTextures::default(), [2, 2]);
        assert_eq!([0, 3].map(|i| metalness.at(i)), [0.25; 2]);
    }
}
