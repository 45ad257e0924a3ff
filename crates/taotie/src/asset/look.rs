//! The materials in which scan and asset are compared: grey, so that only shape and normals differ, and their own.

use crate::error::{Result, Warnings};
use crate::math::Vec3;
use crate::mesh::{Mesh, MeshData};
use crate::render::{EnvironmentLight, Lighting};
use crate::scene::{Camera, Instance, Material, Scene, three_point_rig};
use crate::studio::{EnvironmentOptions, EnvironmentSource};

/// Returns `true` if a scene specifies no colour and no material: no vertex colours, and materials that are the
/// default of their format, except for their relief.
pub(super) fn is_plain(scene: &Scene) -> bool {
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
pub(super) fn used(scene: &Scene) -> impl Iterator<Item = &Material> {
    scene.instances().iter().map(|instance| &scene.materials()[instance.material])
}

/// Returns the scene in one grey material, keeping its normal and height maps; vertex colours, textures, transparency
/// and lights are removed.
pub(super) fn grey(scene: Scene) -> Result<Scene> {
    let mut data = scene.into_data();
    for mesh in data.meshes.iter_mut().filter(|mesh| !mesh.colors().is_empty()) {
        *mesh = Mesh::new(MeshData { colors: Vec::new(), ..std::mem::take(mesh).into_data() })?;
    }
    for material in &mut data.materials {
        *material = Material { normal: material.normal, height: material.height, ..neutral() };
    }
    data.lights.clear();
    Scene::new(data)
}

/// Returns the scene in its own materials, without its lights.
pub(super) fn full(mut scene: Scene) -> Result<Scene> {
    scene.edit(|data| data.lights.clear())?;
    Ok(scene)
}

fn neutral() -> Material {
    Material {
        base_color: [0.55, 0.55, 0.55, 1.0],
        roughness: 0.5,
        double_sided: true,
        ..Material::default()
    }
}

/// Returns the environment light for scenes if one of them is metallic, which would be black without it: the built-in
/// studio.
pub(super) fn environment<'a>(
    mut scenes: impl Iterator<Item = &'a Scene>,
) -> Result<Option<EnvironmentLight>> {
    let is_metal = |scene: &Scene| used(scene).any(|material| material.metallic > 0.0);
    let source = scenes.any(is_metal).then_some(EnvironmentSource::Studio);
    EnvironmentOptions { source, ..EnvironmentOptions::default() }.load(&mut Warnings::default())
}

/// Returns the light on a scene: the environment if there is one, else three lights that follow the camera.
pub(super) fn lighting(camera: &Camera, environment: Option<&EnvironmentLight>) -> Lighting {
    match environment {
        Some(light) => Lighting { environment: Some(light.clone()), ..Lighting::default() },
        None => Lighting { lights: three_point_rig(camera), ambient: Vec3::splat(0.15), environment: None },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn grey_is_grey() {
        let count = Mesh::sphere(1.0, 8, 4).positions().len();
        let red = Material { base_color: [1.0, 0.0, 0.0, 0.5], emissive: [1.0; 3], ..Material::default() };
        let grey = grey(ball(red, vec![[0.0, 1.0, 0.0, 1.0]; count])).unwrap();
        assert!(grey.meshes()[0].colors().is_empty());
        assert_eq!(grey.materials(), [neutral()]);
    }
}
