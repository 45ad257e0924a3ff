//! The material of a scan over all its parts: which properties are uniform, and which vary and need a map.

use taotie_engine::bake::{MapKind, Maps};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{AlphaMode, Instance, LAYERS, Material, Scene};

/// The material of a scan as an asset can carry it.
#[derive(Debug, Clone, Default)]
pub(in crate::asset) struct Carried {
    /// The uniform properties; defaults for all others.
    pub material: Material,
    /// The properties in which the scan differs from a default material.
    pub found: Vec<Found>,
    /// `true` if some of its materials are double-sided and others are not.
    pub has_mixed_sides: bool,
}

/// A property of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::asset) struct Found {
    pub property: Property,
    /// `true` if it has one value everywhere, which a factor stores.
    pub is_uniform: bool,
    /// The share of the surface that has it, [0, 1].
    pub part: f64,
}

impl Carried {
    /// Collects the materials of all instances. If none of them specifies any, factors are those of the first: formats
    /// have different defaults.
    pub fn of(scene: &Scene) -> Self {
        let parts: Vec<Part> = scene.instances().iter().map(|instance| Part::of(scene, instance)).collect();
        let is_plain = is_plain(scene);
        let is_default = |property: Property| is_plain && property.has_factor();
        let has = |property: &Property| match parts.first() {
            Some(first) if is_default(*property) => first.has(*property),
            _ => parts.iter().any(|part| part.has(*property)),
        };
        let properties: Vec<Property> = Property::all().into_iter().filter(has).collect();
        let areas = areas(scene, &parts, &properties);
        let found = properties.into_iter().map(|property| Found {
            property,
            is_uniform: is_default(property) || is_uniform(&parts, property),
            part: share(&parts, &areas, |part| part.has(property)),
        });
        let found: Vec<Found> = found.collect();
        let is_double = |part: &Part| part.material.double_sided;
        let has_mixed_sides = parts.iter().any(is_double) && !parts.iter().all(is_double);
        Self { material: material(&parts, &found), found, has_mixed_sides }
    }

    /// Returns the properties that no factor can store.
    pub fn varying(&self) -> impl Iterator<Item = Property> {
        self.found.iter().filter(|found| !found.is_uniform).map(|found| found.property)
    }

    /// Returns the maps that store the varying properties. Alpha is stored in the base colour texture.
    pub fn maps(&self) -> Maps {
        let maps: Maps = self.varying().filter_map(Property::map).collect();
        if maps.has(MapKind::Alpha) { maps.with(MapKind::Albedo) } else { maps }
    }

    /// Returns true if a property varies.
    pub fn varies(&self, property: Property) -> bool {
        self.varying().any(|varying| varying == property)
    }
}

/// An instance of a scan, by its appearance.
struct Part<'a> {
    material: &'a Material,
    /// `true` if its vertices have colours.
    has_colors: bool,
    /// `true` if alpha varies over its vertices or its texture.
    has_alpha: bool,
}

impl<'a> Part<'a> {
    fn of(scene: &'a Scene, instance: &Instance) -> Self {
        let (mesh, material) = (&scene.meshes()[instance.mesh], &scene.materials()[instance.material]);
        Self {
            material,
            has_colors: !mesh.colors().is_empty(),
            has_alpha: material.alpha != AlphaMode::Opaque && has_alpha(scene, mesh, material),
        }
    }

    fn varies(&self, property: Property) -> bool {
        match property {
            Property::BaseColor => self.has_colors || property.is_textured(self.material),
            Property::Alpha => self.has_alpha,
            _ => property.is_textured(self.material),
        }
    }

    fn has(&self, property: Property) -> bool {
        property.is_said(self.material) || self.varies(property)
    }
}

fn has_alpha(scene: &Scene, mesh: &Mesh, material: &Material) -> bool {
    let texture = material.base_color_texture.as_ref().map(|used| scene.textures()[used.texture].bitmap());
    texture.is_some_and(|bitmap| matches!(bitmap.channels(), 2 | 4))
        || mesh.colors().iter().any(|color| color[3] != 1.0)
}

fn is_uniform(parts: &[Part], property: Property) -> bool {
    let first = parts.first().map(|part| property.isolated(part.material));
    property.has_factor()
        && parts.iter().all(|part| !part.varies(property) && Some(property.isolated(part.material)) == first)
}

/// Returns the share of the surface for which `is` holds, [0, 1].
fn share(parts: &[Part], areas: &[f64], is: impl Fn(&Part) -> bool) -> f64 {
    let with = parts.iter().zip(areas).filter(|(part, _)| is(part));
    let with: f64 = with.map(|(_, area)| area).sum();
    let all: f64 = areas.iter().sum();
    if all > 0.0 { with / all } else { 1.0 }
}

/// Returns the area of each instance, world space; if all have all properties, nothing is measured and each counts 1.
fn areas(scene: &Scene, parts: &[Part], properties: &[Property]) -> Vec<f64> {
    let has_all = |part: &Part| properties.iter().all(|property| part.has(*property));
    if parts.iter().all(has_all) {
        return vec![1.0; parts.len()];
    }
    let area = |instance: &Instance| scene.meshes()[instance.mesh].area(&instance.world_from_object);
    scene.instances().iter().map(area).collect()
}

/// Returns a material with all uniform properties. If all parts use the same material, it keeps that material's name.
fn material(parts: &[Part], found: &[Found]) -> Material {
    let Some(first) = parts.first().map(|part| part.material) else { return Material::default() };
    let mut material =
        Material { double_sided: parts.iter().any(|part| part.material.double_sided), ..Material::default() };
    if parts.iter().all(|part| std::ptr::eq(part.material, first)) {
        material.name.clone_from(&first.name);
    }
    // A uniform property has its value in the first part too.
    found.iter().filter(|found| found.is_uniform).for_each(|f| f.property.copy(first, &mut material));
    material
}

/// A property of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::asset) enum Property {
    BaseColor,
    Alpha,
    NormalMap,
    HeightMap,
    MetallicRoughness,
    Occlusion,
    Emission,
    RefractiveIndex,
    /// Index into [`LAYERS`].
    Layer(usize),
    Unlit,
    /// The reflectance at 0° and 82°.
    Reflectance,
    /// The parameters of classic models.
    Classic,
}

impl Property {
    /// Returns all properties, in reporting order: layers in the order of their textures.
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::BaseColor,
            Self::Alpha,
            Self::NormalMap,
            Self::HeightMap,
            Self::MetallicRoughness,
            Self::Occlusion,
            Self::Emission,
            Self::RefractiveIndex,
        ];
        let mut layers: Vec<usize> = (0..LAYERS.len()).collect();
        layers.sort_by_key(|layer| (LAYERS[*layer].textures.is_empty(), LAYERS[*layer].textures.first()));
        all.extend(layers.into_iter().map(Self::Layer));
        all.extend([Self::Unlit, Self::Reflectance, Self::Classic]);
        all
    }

    /// Returns its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BaseColor => "base colour",
            Self::Alpha => "alpha",
            Self::NormalMap => "normal map",
            Self::HeightMap => "height map",
            Self::MetallicRoughness => "metallic-roughness",
            Self::Occlusion => "occlusion texture",
            Self::Emission => "emission",
            Self::RefractiveIndex => "index of refraction",
            Self::Layer(layer) => LAYERS[layer].name,
            Self::Unlit => "unlit look",
            Self::Reflectance => "reflectance at 0° or 82°",
            Self::Classic => "parameters of classic models",
        }
    }

    /// Returns the map that stores it if it varies over the surface.
    pub fn map(self) -> Option<MapKind> {
        match self {
            Self::BaseColor => Some(MapKind::Albedo),
            Self::Alpha => Some(MapKind::Alpha),
            Self::NormalMap | Self::HeightMap => Some(MapKind::Normal),
            Self::MetallicRoughness => Some(MapKind::MetallicRoughness),
            Self::Occlusion => Some(MapKind::OcclusionMap),
            Self::Emission => Some(MapKind::Emission),
            _ => None,
        }
    }

    /// Returns true if a factor can store it: if glTF has one that means the same on any uvs.
    pub fn has_factor(self) -> bool {
        match self {
            Self::NormalMap | Self::HeightMap | Self::Occlusion | Self::Reflectance | Self::Classic => false,
            Self::Layer(layer) => !LAYERS[layer].has_direction(),
            _ => true,
        }
    }

    /// Copies it, with its textures; base colour textures also contain alpha but are copied only as colours.
    pub fn copy(self, from: &Material, to: &mut Material) {
        match self {
            Self::BaseColor => {
                let [r, g, b, _] = from.base_color;
                to.base_color = [r, g, b, to.base_color[3]];
                to.base_color_texture = from.base_color_texture;
            }
            Self::Alpha if from.alpha == AlphaMode::Opaque => {}
            Self::Alpha => {
                to.alpha = from.alpha;
                to.base_color[3] = from.base_color[3];
            }
            Self::NormalMap => to.normal = from.normal,
            // A normal map overrides it.
            Self::HeightMap => to.height = from.height.filter(|_| from.normal.is_none()),
            Self::MetallicRoughness => {
                (to.metallic, to.roughness) = (from.metallic, from.roughness);
                to.metallic_roughness_texture = from.metallic_roughness_texture;
            }
            Self::Occlusion if from.occlusion_strength == 0.0 => {}
            Self::Occlusion => {
                to.occlusion_texture = from.occlusion_texture;
                if from.occlusion_texture.is_some() {
                    to.occlusion_strength = from.occlusion_strength;
                }
            }
            Self::Emission if from.emissive == [0.0; 3] => {}
            Self::Emission => {
                to.emissive = from.emissive;
                to.emissive_texture = from.emissive_texture;
            }
            Self::RefractiveIndex => to.ior = from.ior,
            Self::Layer(layer) if (LAYERS[layer].is_visible)(from) => (LAYERS[layer].copy)(from, to),
            Self::Layer(layer) => LAYERS[layer].remove(to),
            Self::Unlit => to.unlit = from.unlit,
            Self::Reflectance => (to.f0, to.f82) = (from.f0, from.f82),
            Self::Classic => to.classic = from.classic,
        }
    }

    /// Returns the default material with this property of another.
    pub fn isolated(self, material: &Material) -> Material {
        let mut only = Material::default();
        self.copy(material, &mut only);
        only
    }

    /// Returns true if a material differs from the default one in it.
    pub fn is_said(self, material: &Material) -> bool {
        self.isolated(material) != Material::default()
    }

    /// Returns true if it is stored in textures.
    pub fn is_textured(self, material: &Material) -> bool {
        !self.isolated(material).textures().is_empty()
    }
}

/// Returns `true` if a material differs from the default in metallic or roughness.
pub(super) fn has_finish(scene: &Scene) -> bool {
    used_materials(scene).any(|material| Property::MetallicRoughness.is_said(material))
}

/// Returns `true` if a scene specifies no colour and no material: no vertex colours, and materials that are the
/// default of their format, except for their relief.
pub(in crate::asset) fn is_plain(scene: &Scene) -> bool {
    let is_plain = |instance: &Instance| {
        let own = &scene.materials()[instance.material];
        let plain = |default: Material| Material {
            name: own.name.clone(),
            normal: own.normal,
            height: own.height,
            double_sided: own.double_sided,
            ..default
        };
        let is_default = [Material::default(), Material::default_of_gltf()].map(plain).contains(own);
        scene.meshes()[instance.mesh].colors().is_empty() && is_default
    };
    scene.instances().iter().all(is_plain)
}

/// Returns the visible materials, one for each instance.
pub(in crate::asset) fn used_materials(scene: &Scene) -> impl Iterator<Item = &Material> {
    scene.instances().iter().map(|instance| &scene.materials()[instance.material])
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
    use taotie_engine::math::{Mat4, Vec3};
    use taotie_engine::mesh::MeshData;
    use taotie_engine::scene::{
        Clearcoat, FactorValue, HeightMap, Layer, SceneData, TextureRef, UvTransform,
    };

    /// A rectangle of this area.
    fn rectangle(area: f32) -> MeshData {
        let at = |x: f32, y: f32| Vec3::new(x * area, y, 0.0);
        MeshData {
            positions: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        }
    }

    /// A scene with one rectangle per material, of area 1, 3, 5 …, and two textures: with three and with four
    /// channels.
    fn scene(materials: Vec<Material>) -> Scene {
        let bitmap = |channels: u8| Bitmap::new(1, 1, channels, Texels::U8(vec![[255; 4]])).unwrap();
        let textures = [3, 4].map(|channels| Texture::new(bitmap(channels), Encoding::Srgb)).into();
        let count = materials.len();
        let meshes = (0..count).map(|i| Mesh::new(rectangle(2.0 * i as f32 + 1.0)).unwrap()).collect();
        let world_from_object = Mat4::IDENTITY;
        let instances = (0..count).map(|i| Instance { mesh: i, material: i, world_from_object }).collect();
        Scene::new(SceneData { meshes, materials, textures, instances, ..SceneData::default() }).unwrap()
    }

    fn texture(texture: usize) -> TextureRef {
        TextureRef { texture, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() }
    }

    fn clay() -> Material {
        Material::default()
    }

    fn coated(factor: f32) -> Material {
        let coat =
            Clearcoat { factor, factor_texture: None, roughness: 0.1, roughness_texture: None, normal: None };
        Material { clearcoat: Some(coat), ..clay() }
    }

    fn coat() -> Property {
        Property::all().into_iter().find(|property| property.name() == "clearcoat").unwrap()
    }

    fn of(materials: &[Material]) -> Carried {
        Carried::of(&scene(materials.to_vec()))
    }

    fn found(property: Property, is_uniform: bool, part: f64) -> Found {
        Found { property, is_uniform, part }
    }

    #[test]
    fn plain_clay_has_nothing_to_carry() {
        let carried = of(&[Material { name: "clay".into(), ..clay() }]);
        assert_eq!((carried.found.as_slice(), carried.maps()), (&[][..], Maps::default()));
        assert_eq!(carried.material, Material { name: "clay".into(), ..clay() });
    }

    #[test]
    fn what_is_one_value_everywhere_is_a_factor() {
        let gold =
            Material { base_color: [1.0, 0.8, 0.3, 1.0], metallic: 1.0, roughness: 0.2, ..coated(0.5) };
        let carried = of(&[gold.clone(), gold.clone()]);
        assert_eq!(carried.found.iter().filter(|found| found.is_uniform && found.part == 1.0).count(), 3);
        assert_eq!((carried.maps(), carried.material), (Maps::default(), gold));
    }

    #[test]
    fn what_any_part_has_is_found_with_its_share() {
        let lamp = Material { emissive: [4.0; 3], ..clay() };
        let carried = of(&[clay(), lamp]);
        assert_eq!(carried.found, [found(Property::Emission, false, 0.75)]);
        assert_eq!(carried.maps(), Maps::default().with(MapKind::Emission));
        assert_eq!(carried.material.emissive, [0.0; 3], "no factor makes everything glow");
        let carried = of(&[coated(1.0), clay()]);
        assert_eq!(carried.found, [found(coat(), false, 0.25)]);
        assert_eq!((carried.maps(), carried.material.clearcoat), (Maps::default(), None));
    }

    #[test]
    fn defaults_of_different_formats_are_no_difference() {
        let of_gltf = Material::default_of_gltf();
        for parts in [[of_gltf.clone(), clay()], [clay(), of_gltf.clone()]] {
            let carried = of(&parts);
            assert_eq!((carried.maps(), &carried.material), (Maps::default(), &parts[0]));
            assert_eq!(carried.varying().count(), 0);
        }
        // Relief is not a default, and a specified material makes every part's count.
        let bumpy = Material { height: Some(HeightMap { texture: texture(0), scale: 1.0 }), ..clay() };
        assert_eq!(of(&[of_gltf.clone(), bumpy]).maps(), Maps::default().with(MapKind::Normal));
        let rough = Material { roughness: 0.3, ..clay() };
        assert!(of(&[of_gltf, clay(), rough]).varies(Property::MetallicRoughness));
    }

    #[test]
    fn a_share_is_of_the_surface_in_the_world() {
        let mut data = scene(vec![coated(1.0), clay()]).into_data();
        data.instances[0].world_from_object = Mat4::scale(Vec3::new(3.0, 3.0, 1.0));
        let carried = Carried::of(&Scene::new(data).unwrap());
        assert_eq!(carried.found, [found(coat(), false, 0.75)]);
    }

    #[test]
    fn textures_and_colours_vary() {
        let textured = Material {
            base_color_texture: Some(texture(0)),
            metallic_roughness_texture: Some(texture(0)),
            occlusion_texture: Some(texture(0)),
            ..clay()
        };
        let maps = [MapKind::Albedo, MapKind::MetallicRoughness, MapKind::OcclusionMap];
        assert_eq!(of(&[textured]).maps(), maps.into_iter().collect());
        let colors = vec![[1.0, 0.0, 0.0, 1.0]; 4];
        let mesh = Mesh::new(MeshData { colors, ..rectangle(1.0) }).unwrap();
        let carried = Carried::of(&Scene::of_mesh(mesh, clay()).unwrap());
        assert_eq!(carried.found, [found(Property::BaseColor, false, 1.0)]);
    }

    #[test]
    fn a_texture_that_multiplies_nothing_is_none() {
        let dark = Material { emissive_texture: Some(texture(0)), ..coated(0.0) };
        assert!(of(&[dark]).found.is_empty());
    }

    #[test]
    fn alpha_varies_by_texture_and_by_material() {
        let leaf = |cutoff: f32| Material {
            alpha: AlphaMode::Mask(cutoff),
            base_color_texture: Some(texture(1)),
            ..clay()
        };
        let maps: Maps = [MapKind::Albedo, MapKind::Alpha].into_iter().collect();
        let carried = of(&[leaf(0.3), clay()]);
        assert_eq!((carried.maps(), carried.material.alpha), (maps, AlphaMode::Opaque));
        assert!(of(&[leaf(0.25), leaf(0.25)]).varies(Property::Alpha));
        let glass = Material { alpha: AlphaMode::Blend, base_color: [1.0, 1.0, 1.0, 0.2], ..clay() };
        assert!(of(&[glass.clone(), clay()]).varies(Property::Alpha));
        // Glass with uniform alpha needs no map, nor does a texture without alpha.
        let opaque = Material { alpha: AlphaMode::Blend, base_color_texture: Some(texture(0)), ..clay() };
        for (material, alpha) in [(glass, 0.2), (opaque, 1.0)] {
            let carried = of(&[material]);
            assert!(!carried.varies(Property::Alpha));
            assert_eq!((carried.material.alpha, carried.material.base_color[3]), (AlphaMode::Blend, alpha));
        }
    }

    #[test]
    fn the_direction_of_a_layer_is_of_its_uvs() {
        let layer = LAYERS.iter().position(Layer::has_direction).unwrap();
        let mut material = clay();
        (LAYERS[layer].add)(&mut material);
        (LAYERS[layer].factors[0].set)(&mut material, FactorValue::Number(0.5));
        let carried = of(&[material]);
        assert_eq!(carried.found, [found(Property::Layer(layer), false, 1.0)]);
        assert_eq!(carried.material, clay());
    }

    #[test]
    fn materials_that_nothing_shows_do_not_count() {
        let mut data = scene(vec![clay(), coated(1.0)]).into_data();
        data.instances.truncate(1);
        assert!(Carried::of(&Scene::new(data).unwrap()).found.is_empty());
    }

    fn ball(material: Material, colors: Vec<[f32; 4]>) -> Scene {
        let data = Mesh::sphere(1.0, 8, 4).into_data();
        Scene::of_mesh(Mesh::new(MeshData { colors, ..data }).unwrap(), material).unwrap()
    }

    #[test]
    fn colours_and_factors_are_not_plain() {
        assert!(is_plain(&ball(Material::default(), Vec::new())));
        let named = Material { name: "clay".into(), double_sided: true, ..Material::default() };
        assert!(is_plain(&ball(named, Vec::new())));
        let of_gltf = Material::default_of_gltf();
        assert!(is_plain(&ball(Material { double_sided: true, ..of_gltf.clone() }, Vec::new())));
        assert!(!is_plain(&ball(Material { metallic: 0.0, ..of_gltf }, Vec::new())));
        let count = Mesh::sphere(1.0, 8, 4).positions().len();
        assert!(!is_plain(&ball(Material::default(), vec![[1.0; 4]; count])));
        assert!(!is_plain(&ball(Material { metallic: 1.0, ..Material::default() }, Vec::new())));
    }
}
