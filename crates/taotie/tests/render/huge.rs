//! Scenes whose squares overflow single precision: their looks mean little, but rays through them never lead to
//! missing nodes, and nothing panics.

use crate::scenes;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Material, Orbit, Scene};

/// Returns a ball of this radius, whose tree has missing children.
fn ball(radius: f32) -> Scene {
    let data = Mesh::sphere(1.0, 12, 7).into_data();
    let positions = data.positions.iter().map(|p| *p * radius).collect();
    Scene::of_mesh(Mesh::new(MeshData { positions, ..data }).unwrap(), Material::default()).unwrap()
}

/// Returns a camera far enough away to show all of it.
fn camera(radius: f64) -> Camera {
    let (azimuth, elevation) = (0.3, 0.2);
    Orbit { azimuth, elevation, distance: 4.0 * radius, target: Vec3::splat(0.0), fov_y: 0.7 }
        .camera(2.0 * radius)
}

#[test]
fn shadows_and_grounds_of_huge_and_tiny_scenes_end() {
    let lights = vec![scenes::directional(Vec3::new(0.5, -1.0, -0.4), 2.0)];
    let lighting = Lighting { lights, ..Lighting::default() };
    for size in [1e-37, 1e-30, 1e-19, 1.0, 1e15, 1e19, 1e20, 1e30, 1e37] {
        let scene = ball(size);
        for (shadows, ground) in [(false, false), (true, false), (true, true)] {
            let settings = RenderSettings {
                width: 24,
                height: 24,
                samples: 1,
                shadows,
                ground,
                ..RenderSettings::default()
            };
            let shot = Shot { camera: &camera(f64::from(size)), lighting: &lighting, settings: &settings };
            let seen = render(&scene, &shot);
            assert!(size != 1.0 || seen.is_ok(), "{size}");
        }
    }
}
