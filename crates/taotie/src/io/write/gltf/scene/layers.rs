//! Material layers by extensions: index of refraction, specular strength, clearcoat, anisotropy, sheen, no light. Their
//! factors are [`layers::factors`]; here they get their textures.

use super::super::layers;
use super::materials::Extensions;
use super::writer::Writer;
use crate::scene::{Material, TextureRef};

/// A texture of a layer.
struct LayerMap {
    /// The layer's extension.
    layer: &'static str,
    /// The extension's member.
    member: &'static str,
    texture: Option<TextureRef>,
}

impl Writer<'_> {
    /// Adds the layers of a material beyond glTF's own factors.
    pub(super) fn layers(&mut self, mut extensions: Extensions, material: &Material) -> Extensions {
        if let Some(sheen) = &material.sheen {
            self.note_above_one("colours of sheen", &sheen.color);
        }
        let maps = maps(material);
        for (name, mut json) in layers::factors(material) {
            self.draft.uses(name);
            for map in maps.iter().filter(|map| map.layer == name) {
                if let Some(texture) = &map.texture {
                    json[map.member] = self.slot(texture);
                }
            }
            let coat = material.clearcoat.filter(|_| name == layers::CLEARCOAT);
            if let Some(map) = self.normal_map(coat.and_then(|coat| coat.normal).as_ref()) {
                json["clearcoatNormalTexture"] = map;
            }
            extensions.insert(name.into(), json);
        }
        extensions
    }
}

/// Returns the places of textures in a material's layers; normal maps have their own way.
fn maps(material: &Material) -> Vec<LayerMap> {
    let of = |layer, member, texture| LayerMap { layer, member, texture };
    let mut maps = vec![
        of(layers::SPECULAR, "specularTexture", material.specular.factor_texture),
        of(layers::SPECULAR, "specularColorTexture", material.specular.color_texture),
    ];
    if let Some(coat) = &material.clearcoat {
        maps.push(of(layers::CLEARCOAT, "clearcoatTexture", coat.factor_texture));
        maps.push(of(layers::CLEARCOAT, "clearcoatRoughnessTexture", coat.roughness_texture));
    }
    if let Some(anisotropy) = &material.anisotropy {
        maps.push(of(layers::ANISOTROPY, "anisotropyTexture", anisotropy.texture));
    }
    if let Some(sheen) = &material.sheen {
        maps.push(of(layers::SHEEN, "sheenColorTexture", sheen.color_texture));
        maps.push(of(layers::SHEEN, "sheenRoughnessTexture", sheen.roughness_texture));
    }
    maps
}
