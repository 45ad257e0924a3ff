//! The material of a given low-poly mesh: what it specifies, what no asset can keep, and the textures that an asset
//! keeps.

use super::low_poly::KeptTextures;
use super::material::Property;
use crate::asset::ask::BakeOptions;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use taotie_engine::bake::{self, MapKind};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::image::{Bitmap, Encoding, Sampler, TexelFilter, Texture, Wrap};
use taotie_engine::math::{Vec2, poly};
use taotie_engine::scene::{
    AlphaMode, GreenChannel, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform,
};

/// The appearance of a given low-poly mesh.
#[derive(Clone, Copy)]
pub(in crate::asset) struct LowLook<'a> {
    pub material: &'a Material,
    /// `true` if its vertices have colours.
    pub has_colors: bool,
}

impl LowLook<'_> {
    /// Returns true if it leaves a property at its default: it has no texture, and no factor other than a format's
    /// default.
    pub fn is_free(&self, property: Property) -> bool {
        // glTF's default is white and metallic, that of other formats grey.
        let unsaid = Material { base_color: [1.0; 4], metallic: 1.0, roughness: 1.0, ..Material::default() };
        let own = property.isolated(self.material);
        let is_unsaid = own == Material::default() || own == property.isolated(&unsaid);
        match property {
            Property::BaseColor => is_unsaid && !self.has_colors,
            Property::Alpha => is_unsaid && self.is_free(Property::BaseColor),
            // A baked normal map replaces its own, which is reported.
            Property::NormalMap | Property::HeightMap => true,
            _ => is_unsaid,
        }
    }
}

/// Makes all materials of a scene single-sided if both sides of its cards are modelled: seen from both sides, they would
/// flicker. For formats that do not state the sidedness.
pub(super) fn show_fronts_of_cards(scene: Scene, warnings: &mut Warnings) -> Result<Scene> {
    let count = scene.meshes().iter().map(bake::coinciding_sides).sum();
    if count == 0 || !scene.materials().iter().any(|material| material.double_sided) {
        return Ok(scene);
    }
    let what = "triangles of the low-poly mesh at the same place face opposite ways, as the sides of a card do: all of \
                it is single-sided";
    warnings.note(what, count);
    let mut data = scene.into_data();
    data.materials.iter_mut().for_each(|material| material.double_sided = false);
    Scene::new(data)
}

/// Returns the numbers of the visible materials, in order.
pub(super) fn shown_materials(scene: &Scene) -> BTreeSet<usize> {
    scene.instances().iter().map(|instance| instance.material).collect()
}

/// Returns the triangles of each material among all visible ones.
pub(super) fn triangles_by_material(scene: &Scene) -> BTreeMap<usize, Vec<Range<usize>>> {
    let mut ranges: BTreeMap<usize, Vec<Range<usize>>> = BTreeMap::new();
    let mut first = 0;
    for instance in scene.instances() {
        let end = first + scene.meshes()[instance.mesh].triangles().len();
        ranges.entry(instance.material).or_default().push(first..end);
        first = end;
    }
    ranges
}

/// The parts of a low-poly mesh's material that no asset can keep: removed first, so that the scan's can replace
/// them.
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

/// A texture slot of a material that an asset has too, with the maps that are baked in its place.
#[derive(Debug)]
struct Slot {
    /// Its name in words.
    pub name: &'static str,
    /// The property that it stores.
    pub property: Property,
    maps: &'static [MapKind],
}

/// All slots except the normal map, which is never kept.
static SLOTS: [Slot; 4] = [
    Slot { name: "base colour", property: Property::BaseColor, maps: &[MapKind::Albedo] },
    Slot {
        name: "metallic-roughness",
        property: Property::MetallicRoughness,
        maps: &[MapKind::Roughness, MapKind::MetallicRoughness],
    },
    Slot {
        name: "occlusion",
        property: Property::Occlusion,
        maps: &[MapKind::Occlusion, MapKind::OcclusionMap],
    },
    Slot { name: "emission", property: Property::Emission, maps: &[MapKind::Emission] },
];

impl Slot {
    /// Returns the texture that a material has in this slot.
    pub fn texture(&self, material: &Material) -> Option<TextureRef> {
        match self.property {
            Property::BaseColor => material.base_color_texture,
            Property::MetallicRoughness => material.metallic_roughness_texture,
            Property::Occlusion => material.occlusion_texture,
            _ => material.emissive_texture,
        }
    }

    /// Returns true if a map is baked in its place.
    pub fn is_baked(&self, options: &BakeOptions) -> bool {
        options.bakes(self.maps)
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
    let is_left = |property: &Property| match property {
        Property::Layer(_) => property.is_textured(material),
        Property::Reflectance | Property::Classic => property.is_said(material),
        _ => false,
    };
    let left: Vec<Property> = Property::all().into_iter().filter(is_left).collect();
    left.iter().for_each(|property| property.copy(&Material::default(), material));
    left
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
    let asset = taotie_io::gltf_sampler(scene.meshes());
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

/// Returns `true` if a texture uses uv set 0 without a transform.
fn is_plain(texture: &TextureRef) -> bool {
    texture.uv_set == 0 && texture.transform == UvTransform::default()
}

/// The metalness stored with a baked roughness: that of the low-poly mesh's own material, over the texels of a map.
pub(in crate::asset) struct Metalness {
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

/// Assigns an object-space normal map, which glTF cannot reference, to the material with this number, or to all of
/// them.
pub(in crate::asset) fn assign_object_map(
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

#[cfg(test)]
mod tests {
    use super::super::material::{Carried, Found};
    use super::*;
    use crate::asset::bake::BakePlan;
    use taotie_engine::image::Texels;
    use taotie_engine::math::Vec3;
    use taotie_engine::mesh::{Mesh, MeshData};
    use taotie_engine::scene::Clearcoat;

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

    /// Returns the number of notes about a base colour texture on a sphere whose uvs are multiplied by `scale`.
    fn noted(sampler: Sampler, scale: f32, maps: Vec<MapKind>) -> usize {
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
        assert_eq!([0.5, 2.0].map(|scale| noted(mirror, scale, vec![])), [0, 1]);
        assert_eq!([0.5, 2.0].map(|scale| noted(rough, scale, vec![])), [1, 1]);
        assert_eq!(noted(Sampler::default(), 2.0, vec![]), 0);
        assert_eq!(noted(rough, 2.0, vec![MapKind::Albedo]), 0, "a baked one replaces it");
    }

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
    fn sides_of_cards_are_single() {
        let positions = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
        let is_double = |triangles: &[[u32; 3]]| {
            let triangles = triangles.to_vec();
            let mesh = Mesh::new(MeshData { positions: positions.clone(), triangles, ..MeshData::default() });
            let material = Material { double_sided: true, ..Material::default() };
            let mut warnings = Warnings::default();
            let scene = Scene::of_mesh(mesh.unwrap(), material).unwrap();
            let shown = show_fronts_of_cards(scene, &mut warnings).unwrap();
            (shown.materials()[0].double_sided, warnings.iter().count())
        };
        assert_eq!(is_double(&[[0, 1, 2], [2, 1, 0]]), (false, 1));
        assert_eq!(is_double(&[[0, 1, 2], [1, 2, 0]]), (true, 0));
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
