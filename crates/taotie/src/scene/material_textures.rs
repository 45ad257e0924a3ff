//! All the textures of a material, wherever in it they stand.

use super::{Material, TextureRef};

impl Material {
    /// Every texture in use, in no special order.
    pub fn textures(&self) -> Vec<TextureRef> {
        let mut textures = Vec::new();
        self.clone().retain_textures(|texture| {
            textures.push(*texture);
            true
        });
        textures
    }

    /// Lets `keep` see and change every texture in use, and takes out those for which it is false; normal and height
    /// maps go as a whole.
    pub fn retain_textures(&mut self, mut keep: impl FnMut(&mut TextureRef) -> bool) {
        let mut slots = vec![
            &mut self.base_color_texture,
            &mut self.metallic_roughness_texture,
            &mut self.occlusion_texture,
            &mut self.emissive_texture,
            &mut self.specular.factor_texture,
            &mut self.specular.color_texture,
        ];
        let mut normals = vec![&mut self.normal];
        if let Some(coat) = &mut self.clearcoat {
            slots.extend([&mut coat.factor_texture, &mut coat.roughness_texture]);
            normals.push(&mut coat.normal);
        }
        if let Some(anisotropy) = &mut self.anisotropy {
            slots.push(&mut anisotropy.texture);
        }
        if let Some(sheen) = &mut self.sheen {
            slots.extend([&mut sheen.color_texture, &mut sheen.roughness_texture]);
        }
        for slot in slots {
            slot.take_if(|texture| !keep(texture));
        }
        for slot in normals {
            slot.take_if(|map| !keep(&mut map.texture));
        }
        self.height.take_if(|map| !keep(&mut map.texture));
    }
}
