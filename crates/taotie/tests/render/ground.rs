//! The shadow catcher compared with closed forms.

use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Material, Orbit, Scene};
use taotie_engine::shade::environment::Environment;

/// Returns a horizontal disc of radius 1 at this height, and a speck at height 0 that puts the ground below it.
fn disc(height: f32) -> Scene {
    const CORNERS: u32 = 96;
    let mut positions = vec![Vec3::new(0.0, height, 0.0)];
    for i in 0..CORNERS {
        let angle = f64::from(i) / f64::from(CORNERS) * std::f64::consts::TAU;
        positions.push(Vec3::new(scalar::cos(angle) as f32, height, -scalar::sin(angle) as f32));
    }
    let mut triangles: Vec<[u32; 3]> = (0..CORNERS).map(|i| [0, 1 + i, 1 + (i + 1) % CORNERS]).collect();
    let first = positions.len() as u32;
    positions.extend([[5e-4, 0.0], [0.0, 5e-4], [-5e-4, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z)));
    triangles.push([first, first + 1, first + 2]);
    let mesh = Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap();
    let material = Material { double_sided: true, ..Material::default() };
    Scene::of_mesh(mesh, material).unwrap()
}

/// Returns a camera that looks at the ground near the origin from low above it.
fn camera(elevation: f64) -> Camera {
    let orbit =
        Orbit { azimuth: 0.0, elevation, distance: 4.0, target: Vec3::new(0.0, 0.0, 0.0), fov_y: 0.4 };
    Camera { ..orbit.camera(3.9) }
}

fn picture(scene: &Scene, lighting: &Lighting, elevation: f64) -> Image {
    let settings =
        RenderSettings { width: 65, height: 65, samples: 1, ground: true, ..RenderSettings::default() };
    let camera = camera(elevation);
    render(scene, &Shot { camera: &camera, lighting, settings: &settings }).unwrap().color
}

fn uniform() -> Lighting {
    let environment = Environment::new(Image::new(64, 32, [0.7, 0.7, 0.7, 1.0]).unwrap()).unwrap();
    let light =
        EnvironmentLight { environment: environment.into(), rotation: 0.3, intensity: 2.0, visible: false };
    Lighting { environment: Some(light), ..Lighting::default() }
}

#[test]
fn a_disc_hides_its_configuration_factor_of_an_even_sky() {
    // A disc of radius r at height h straight above covers r² / (r² + h²) of a horizontal plane's view.
    let ambient = Lighting { ambient: Vec3::splat(0.4), ..Lighting::default() };
    for (height, hidden) in [(1.0, 0.5), (2.0, 0.2)] {
        for lighting in [&ambient, &uniform()] {
            // Next to the speck in the middle.
            let [r, g, b, alpha] = picture(&disc(height), lighting, 0.15).pixel(34, 32);
            assert_eq!([r, g, b], [0.0; 3], "a shadow emits no light");
            assert!((f64::from(alpha) - hidden).abs() < 0.03, "{alpha} for {hidden}");
        }
    }
}

#[test]
fn a_lamp_above_casts_the_whole_shadow_and_none_is_seen_from_below() {
    let kind = LightKind::Directional { direction: Vec3::new(0.0, -1.0, 0.0) };
    let lamp = Light { name: String::new(), kind, color: Vec3::splat(3.0), falloff: Falloff::None };
    let lighting = Lighting { lights: vec![lamp], ..Lighting::default() };
    let under = picture(&disc(2.0), &lighting, 0.15).pixel(34, 32);
    assert!((under[3] - 1.0).abs() < 1e-6, "{under:?}");
    let from_below = picture(&disc(2.0), &lighting, -0.15).pixel(20, 20);
    assert_eq!(from_below, [0.0; 4]);
}
