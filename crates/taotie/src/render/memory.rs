//! The memory that images take, foreseen from their settings and the scene.

use super::settings::RenderSettings;
use crate::scene::Scene;

/// Returns the bytes that a prepared scene and one image of it take beside the scene itself: placed triangles, the tree
/// of shadow rays, light, output variables, and the codes that are written.
pub fn image_bytes(scene: &Scene, settings: &RenderSettings) -> u64 {
    /// The program itself, and what its threads draw tiles in.
    const REST: u64 = 64 << 20;
    REST + prepared_bytes(scene, settings) + pixel_bytes(settings)
}

/// Returns the bytes of the pixels of an image until it is written.
pub fn pixel_bytes(settings: &RenderSettings) -> u64 {
    /// Light in four floats, and codes of up to as many bytes.
    const PIXEL: u64 = 32;
    /// Five output variables, and one of them as it is written.
    const AOVS: u64 = 5 * 16 + 16;
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    pixels * if settings.aovs { PIXEL + AOVS } else { PIXEL }
}

fn prepared_bytes(scene: &Scene, settings: &RenderSettings) -> u64 {
    /// A placed vertex with normal and tangent, and where it falls on the image.
    const VERTEX: u64 = 40 + 32;
    /// A triangle as it is made ready for tiles, and its places in them.
    const TRIANGLE: u64 = 12 + 48;
    /// Corners, order, boxes and sort keys of the tree.
    const TREE: u64 = 49;
    let triangle = if settings.shadows || settings.ground { TRIANGLE + TREE } else { TRIANGLE };
    let placed = scene.instances().iter().map(|instance| {
        let mesh = &scene.meshes()[instance.mesh];
        mesh.positions().len() as u64 * VERTEX + mesh.triangles().len() as u64 * triangle
    });
    placed.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::scene::Material;

    #[test]
    fn sizes_variables_and_instances_count() {
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 64, 32), Material::default()).unwrap();
        let small = RenderSettings::default();
        let large = RenderSettings { width: 16_384, height: 16_384, aovs: true, ..small.clone() };
        assert!(image_bytes(&scene, &small) < 1 << 28);
        assert!(image_bytes(&scene, &large) > 32 << 30);
        let mut many = scene.clone();
        many.edit(|scene| scene.instances = vec![scene.instances[0]; 1000]).unwrap();
        assert!(image_bytes(&many, &small) > image_bytes(&scene, &small) + 1000 * 100_000);
        let shadows = RenderSettings { shadows: true, ..small.clone() };
        assert!(image_bytes(&many, &shadows) > image_bytes(&many, &small));
    }
}
