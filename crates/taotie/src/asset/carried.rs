//! The material of a scan, over all its parts: what is one value everywhere, and what varies.

use super::property::Property;
use crate::bake::{MapKind, Maps};
use crate::math::Mat4;
use crate::mesh::Mesh;
use crate::scene::{AlphaMode, Instance, Material, Scene};

/// The material of a scan as an asset can carry it.
#[derive(Debug, Clone, Default)]
pub(super) struct Carried {
    /// The properties that are one value everywhere; the default for all others.
    pub material: Material,
    /// The treatment of alpha where it varies.
    pub alpha: AlphaMode,
    /// The properties that the scan has otherwise than a default material.
    pub found: Vec<Found>,
}

/// A property of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub property: Property,
    /// `true` where it is one value everywhere, which a factor holds.
    pub is_uniform: bool,
    /// The part of the surface that has it, [0, 1].
    pub part: f64,
}

impl Carried {
    /// Looks at the materials of all instances.
    pub fn of(scene: &Scene) -> Self {
        let parts: Vec<Part> = scene.instances().iter().map(|instance| Part::of(scene, instance)).collect();
        let has = |property: &Property| parts.iter().any(|part| part.has(*property));
        let properties: Vec<Property> = Property::ALL.into_iter().filter(has).collect();
        let areas = areas(scene, &parts, &properties);
        let found = properties.into_iter().map(|property| Found {
            property,
            is_uniform: is_uniform(&parts, property),
            part: share(&parts, &areas, property),
        });
        let found: Vec<Found> = found.collect();
        Self { material: material(&parts, &found), alpha: alpha(&parts), found }
    }

    /// Returns the properties that no factor holds.
    pub fn varying(&self) -> impl Iterator<Item = Property> {
        self.found.iter().filter(|found| !found.is_uniform).map(|found| found.property)
    }

    /// Returns the maps that hold what varies. Alpha stands in the texture of the base colour.
    pub fn maps(&self) -> Maps {
        let maps: Maps = self.varying().filter_map(Property::map).collect();
        if maps.has(MapKind::Alpha) { maps.with(MapKind::Albedo) } else { maps }
    }

    /// Says whether it has more than one value of a property.
    pub fn varies(&self, property: Property) -> bool {
        self.varying().any(|varying| varying == property)
    }
}

/// An instance of a scan, by its looks.
struct Part<'a> {
    material: &'a Material,
    /// `true` where its vertices have colours.
    has_colors: bool,
    /// `true` where alpha varies over its vertices or its texture.
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
    let first = parts.first().map(|part| property.alone(part.material));
    property.has_factor()
        && parts.iter().all(|part| !part.varies(property) && Some(property.alone(part.material)) == first)
}

fn share(parts: &[Part], areas: &[f64], property: Property) -> f64 {
    let with = parts.iter().zip(areas).filter(|(part, _)| part.has(property));
    let with: f64 = with.map(|(_, area)| area).sum();
    let all: f64 = areas.iter().sum();
    if all > 0.0 { with / all } else { 1.0 }
}

/// Returns the area of each instance, world space; where all have all properties nothing is measured, and each counts 1.
fn areas(scene: &Scene, parts: &[Part], properties: &[Property]) -> Vec<f64> {
    if properties.iter().all(|property| parts.iter().all(|part| part.has(*property))) {
        return vec![1.0; parts.len()];
    }
    let area = |instance: &Instance| area(&scene.meshes()[instance.mesh], &instance.world_from_object);
    scene.instances().iter().map(area).collect()
}

fn area(mesh: &Mesh, world: &Mat4) -> f64 {
    let area = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| world.transform_point(corner.to_f64()));
        (b - a).cross(c - a).length() * 0.5
    };
    (0..mesh.triangles().len()).map(area).sum()
}

/// Returns a material with all that is uniform. It has the name of the parts' material where they show one alone.
fn material(parts: &[Part], found: &[Found]) -> Material {
    let Some(first) = parts.first().map(|part| part.material) else { return Material::default() };
    let mut material =
        Material { double_sided: parts.iter().any(|part| part.material.double_sided), ..Material::default() };
    if parts.iter().all(|part| std::ptr::eq(part.material, first)) {
        material.name.clone_from(&first.name);
    }
    // One value everywhere means that the first part has it.
    found.iter().filter(|found| found.is_uniform).for_each(|f| f.property.copy(first, &mut material));
    material
}

/// Returns how alpha that varies is treated: blended where a part is, else cut at the parts' cutoff, which is a half
/// where they have several.
fn alpha(parts: &[Part]) -> AlphaMode {
    let modes = || parts.iter().map(|part| part.material.alpha).filter(|mode| *mode != AlphaMode::Opaque);
    let Some(first) = modes().next() else { return AlphaMode::Opaque };
    match modes().any(|mode| mode == AlphaMode::Blend) {
        true => AlphaMode::Blend,
        false if modes().all(|mode| mode == first) => first,
        false => AlphaMode::Mask(0.5),
    }
}
