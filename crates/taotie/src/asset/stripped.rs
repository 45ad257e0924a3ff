//! The parts of a low-poly mesh's material that no asset can keep: removed first, so that the scan's can replace
//! them.

use super::notes::is_plain;
use super::options::BakeOptions;
use super::property::Property;
use super::slots::{SLOTS, Slot};
use crate::error::Warnings;
use crate::scene::{AlphaMode, Material, Scene};

/// The parts removed from a low-poly mesh's material.
#[derive(Debug, Default)]
pub(super) struct Stripped {
    /// The slots whose textures use another uv set, or a transform.
    slots: Vec<&'static Slot>,
    /// Layers with textures, and reflectances that glTF cannot represent.
    layers: Vec<Property>,
    /// `true` if alpha was in a removed texture.
    alpha: bool,
}

impl Stripped {
    /// Removes what cannot be kept. A property whose texture is removed counts as unspecified in the file.
    pub fn off(material: &mut Material, scene: &Scene) -> Self {
        let is_moved = |slot: &&Slot| slot.texture(material).is_some_and(|texture| !is_plain(&texture));
        let slots: Vec<&Slot> = SLOTS.iter().filter(is_moved).collect();
        let color = material.base_color_texture.map(|used| scene.textures()[used.texture].bitmap());
        let holds_alpha = color.is_some_and(|color| matches!(color.channels(), 2 | 4));
        let is_color = slots.iter().any(|slot| slot.property == Property::BaseColor);
        let alpha = is_color && holds_alpha && material.alpha != AlphaMode::Opaque;
        slots.iter().for_each(|slot| reset(slot.property, material));
        if alpha {
            material.alpha = AlphaMode::Opaque;
        }
        Self { slots, layers: layers_off(material), alpha }
    }

    /// Notes what is removed and not replaced by a baked map.
    pub fn note(&self, options: &BakeOptions, warnings: &mut Warnings) {
        for slot in self.slots.iter().filter(|slot| !slot.is_baked(options)) {
            let texture = format!("the low-poly mesh's {} texture", slot.name);
            warnings.note(format!("{texture} is left out: it uses another uv set, or a transform"), 1);
        }
        warnings.note(
            "the low-poly mesh's alpha is left out: its texture uses another uv set, or a transform",
            usize::from(self.alpha),
        );
        for layer in &self.layers {
            warnings.note(format!("left out: the low-poly mesh's {}", layer.name()), 1);
        }
    }
}

/// Resets a property to the default material's. Without its texture, the whole surface would glow, or be metallic.
fn reset(property: Property, material: &mut Material) {
    let unsaid = Material::default();
    match property {
        Property::Occlusion => material.occlusion_texture = None,
        Property::Emission => (material.emissive, material.emissive_texture) = (unsaid.emissive, None),
        _ => property.copy(&unsaid, material),
    }
}

/// Removes layers with textures, and reflectances that glTF cannot represent.
fn layers_off(material: &mut Material) -> Vec<Property> {
    let layers = [Property::Specular, Property::Clearcoat, Property::Sheen, Property::Anisotropy];
    let textured = layers.into_iter().filter(|layer| layer.is_textured(material));
    let unsaid = [Property::Reflectance, Property::Classic].into_iter().filter(|p| p.is_said(material));
    let left: Vec<Property> = textured.chain(unsaid).collect();
    left.iter().for_each(|property| property.copy(&Material::default(), material));
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::carried::{Carried, Found};
    use crate::asset::plan::{BakePlan, LowLook};
    use crate::bake::MapKind;
    use crate::image::{Bitmap, Encoding, Sampler, Texels, Texture};
    use crate::mesh::Mesh;
    use crate::scene::{Clearcoat, TextureRef, UvTransform};

    /// A scene with a texture of four channels.
    fn scene() -> Scene {
        let bitmap = Bitmap::new(1, 1, 4, Texels::U8(vec![[255; 4]])).unwrap();
        let sphere = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        let mut data = sphere.into_data();
        data.textures = vec![Texture::new(bitmap, Encoding::Linear)];
        Scene::new(data).unwrap()
    }

    fn texture(uv_set: usize) -> TextureRef {
        TextureRef { texture: 0, uv_set, sampler: Sampler::default(), transform: UvTransform::default() }
    }

    /// A white and metallic material, like glTF's default, with a texture of this uv set in each slot.
    fn textured(uv_set: usize) -> Material {
        let texture = Some(texture(uv_set));
        Material {
            base_color: [1.0; 4],
            metallic: 1.0,
            roughness: 1.0,
            emissive: [1.0; 3],
            base_color_texture: texture,
            metallic_roughness_texture: texture,
            occlusion_texture: texture,
            emissive_texture: texture,
            ..Material::default()
        }
    }

    /// Returns the maps baked onto a mesh with this material if all maps of the scan vary.
    fn baked(material: &Material) -> Vec<MapKind> {
        let all = SLOTS.iter().map(|slot| Found { property: slot.property, is_uniform: false, part: 1.0 });
        let scan = Carried { found: all.collect(), ..Carried::default() };
        let low = LowLook { material, has_colors: false };
        BakePlan::of(&BakeOptions::default(), &scan, &[low]).options.maps
    }

    fn said(stripped: &Stripped, options: &BakeOptions) -> Vec<String> {
        let mut warnings = Warnings::default();
        stripped.note(options, &mut warnings);
        warnings.iter().map(|(what, _)| what.to_owned()).collect()
    }

    #[test]
    fn textures_that_stay_are_the_meshs_own() {
        let mut material = textured(0);
        let stripped = Stripped::off(&mut material, &scene());
        assert_eq!((&material, said(&stripped, &BakeOptions::default()).len()), (&textured(0), 0));
        assert_eq!(baked(&material), [MapKind::Normal]);
    }

    #[test]
    fn the_scans_maps_are_baked_where_textures_cannot_stay() {
        let mut material = textured(1);
        assert_eq!(baked(&material), [MapKind::Normal], "they count as its own");
        let stripped = Stripped::off(&mut material, &scene());
        assert_eq!(material, Material::default());
        let maps = baked(&material);
        let all = [MapKind::Albedo, MapKind::MetallicRoughness, MapKind::OcclusionMap, MapKind::Emission];
        assert!(all.iter().all(|map| maps.contains(map)), "{maps:?}");
        assert_eq!(said(&stripped, &BakeOptions::default()).len(), 4);
        assert!(said(&stripped, &BakeOptions { maps, ..BakeOptions::default() }).is_empty());
    }

    #[test]
    fn alpha_goes_with_its_texture() {
        let mut material = Material { alpha: AlphaMode::Blend, ..textured(1) };
        let stripped = Stripped::off(&mut material, &scene());
        assert_eq!(material.alpha, AlphaMode::Opaque);
        assert!(said(&stripped, &BakeOptions::default()).iter().any(|what| what.contains("alpha")));
    }

    #[test]
    fn layers_of_textures_go() {
        let coat = |factor_texture| Clearcoat {
            factor: 1.0,
            factor_texture,
            roughness: 0.0,
            roughness_texture: None,
            normal: None,
        };
        let mut kept = Material { clearcoat: Some(coat(None)), ..Material::default() };
        assert!(said(&Stripped::off(&mut kept, &scene()), &BakeOptions::default()).is_empty());
        assert!(kept.clearcoat.is_some());
        let mut material = Material { clearcoat: Some(coat(Some(texture(0)))), ..Material::default() };
        let stripped = Stripped::off(&mut material, &scene());
        assert_eq!(material, Material::default());
        let left = "left out: the low-poly mesh's clearcoat".to_owned();
        assert_eq!(said(&stripped, &BakeOptions::default()), [left]);
    }
}
