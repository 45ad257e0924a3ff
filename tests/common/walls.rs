//! A large wall on which all pixels are alike, so that pixels are independent samples of one number.
use super::scenes;
use super::views::{View, environment_of};
use taotie_engine::image::Image;
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{EnvironmentLight, EnvironmentSampling, ReferenceSettings};
use taotie_engine::scene::{Camera, Material, Orbit, Projection, Scene, SceneData};

/// Returns an environment of radiance one.
pub fn white_sky() -> EnvironmentLight {
    environment_of(Image::new(8, 4, [1.0; 4]).unwrap())
}

pub fn scene_of(parts: Vec<(Mesh, Material)>) -> Scene {
    let mut scene = SceneData::default();
    for (i, (mesh, material)) in parts.into_iter().enumerate() {
        scene.meshes.push(mesh);
        scene.materials.push(material);
        scene.instances.push(scenes::instance(i, i, Mat4::IDENTITY));
    }
    Scene::new(scene).unwrap()
}

/// Returns a large rectangle in the plane z = 0 that faces +z.
pub fn wall() -> Mesh {
    let corner = Vec3::new(-100.0, -100.0, 0.0);
    scenes::rectangle(corner, Vec3::new(200.0, 0.0, 0.0), Vec3::new(0.0, 200.0, 0.0), 1.0)
}

/// Returns a camera with a parallel view of a small part about the origin, `azimuth` radians to the right of +z.
pub fn close_up(azimuth: f64) -> Camera {
    let orbit = Orbit { azimuth, elevation: 0.0, distance: 5.0, target: Vec3::splat(0.0), fov_y: 0.5 };
    let projection = Projection::Orthographic { half_width: 0.01, half_height: 0.01, near: 0.1, far: 20.0 };
    Camera { projection, ..orbit.camera(1.0) }
}

/// Returns a view of a wall under a sky, seen at a cosine; all pixels are alike.
pub fn wall_view(material: Material, n_dot_v: f64, sky: EnvironmentLight) -> View {
    let camera = close_up(scalar::acos(n_dot_v));
    let mut view = View::under(sky, scene_of(vec![(wall(), material)]), camera);
    (view.settings.width, view.settings.height) = (32, 32);
    view
}

pub fn metal(roughness: f32) -> Material {
    Material { base_color: [1.0; 4], metallic: 1.0, roughness, ..Material::default() }
}

/// Returns a diffuse reflector.
pub fn matt(albedo: f32) -> Material {
    Material { base_color: [albedo, albedo, albedo, 1.0], ..Material::default() }
}

/// Returns the mean and variance of the first channel over pixels.
pub fn statistics(image: &Image) -> [f64; 2] {
    let values = || image.pixels().iter().map(|p| f64::from(p[0]));
    let n = values().count() as f64;
    let mean = values().sum::<f64>() / n;
    [mean, values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)]
}

/// Asserts that the mean over pixels is `exact` within four standard errors and a relative `slack`.
pub fn assert_mean(what: &str, image: &Image, exact: f64, slack: f64) {
    let [mean, variance] = statistics(image);
    let error = (variance / image.pixels().len() as f64).sqrt();
    eprintln!("{what}: {mean:.5} ± {error:.5}, exactly {exact:.5}");
    assert!((mean - exact).abs() <= 4.0 * error + slack * exact, "{what}: {mean} ± {error}, exactly {exact}");
    assert!(error < 0.02 * exact, "{what}: {error} is too uncertain");
}

/// Returns mean and variance of one pixel's light by each way to sample the environment: both together, by light, by
/// surface.
pub fn by_each_way(view: &View, tracing: &ReferenceSettings) -> [[f64; 2]; 3] {
    use EnvironmentSampling::{ByLight, BySurface, Combined};
    [Combined, ByLight, BySurface]
        .map(|environment| statistics(&view.traced(&ReferenceSettings { environment, ..*tracing }).color))
}

/// Asserts that all ways converge to the same value; `what` describes the case.
pub fn assert_ways_agree(what: &str, view: &View, tracing: &ReferenceSettings) {
    let [both, light, surface] = by_each_way(view, tracing);
    let pixels = f64::from(view.settings.width * view.settings.height);
    eprintln!("{what}: {both:?} together, {light:?} by light, {surface:?} by surface");
    for other in [light, surface] {
        let error = ((both[1] + other[1]) / pixels).sqrt();
        assert!((both[0] - other[0]).abs() < 4.0 * error + 1e-3, "{what}: {both:?} {other:?}");
    }
    let error = (surface[1] / pixels).sqrt();
    assert!(error < 0.01 * surface[0], "{what}: {surface:?} is too uncertain");
}
