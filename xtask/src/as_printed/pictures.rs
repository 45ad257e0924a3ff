//! The demo's jue by each printed model and by the intended one, in the same light.

use crate::generated::Picture;
use anyhow::Result;
use taotie_engine::film::{Development, develop8};
use taotie_engine::math::Vec3;
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Camera, Orbit, Scene, fitting_distance, three_point_rig};
use taotie_engine::shade::Shading;

/// The pictures by name.
pub const PICTURES: [(&str, Shading); 6] = [
    ("cook-torrance-printed", Shading::CookTorrancePrinted),
    ("cook-torrance", Shading::CookTorrance),
    ("blinn-phong-printed", Shading::BlinnPhongPrinted),
    ("blinn-phong", Shading::BlinnPhong),
    ("ggx-printed", Shading::GgxPrinted),
    ("ggx", Shading::Ggx),
];

/// The side of the pictures, pixels.
const SIDE: u32 = 400;
/// The side of the jue's maps, texels.
const MAPS: u32 = 1024;
/// The background.
const GROUND: f32 = 0.055;

/// Renders all pictures, by name.
///
/// # Errors
/// None are expected, since the scene is generated.
pub fn all() -> Result<Vec<(&'static str, Picture)>> {
    let scene = taotie_study::jue::scene(MAPS);
    let camera = camera(&scene);
    let lighting = Lighting { lights: three_point_rig(&camera), ..Lighting::default() };
    let take = |(name, shading)| Ok((name, picture(&scene, &camera, &lighting, shading)?));
    PICTURES.into_iter().map(take).collect()
}

/// Returns a camera that looks at the cup, above the legs.
fn camera(scene: &Scene) -> Camera {
    let bounds = scene.bounds().expect("the jue has triangles");
    let (low, high) = (bounds.min.y + 0.38 * (bounds.max.y - bounds.min.y), bounds.max.y);
    let [azimuth, elevation, fov_y] = [24.0, 15.0, 26.0].map(f64::to_radians);
    let target = Vec3::new(bounds.center().x, (low + high) / 2.0, bounds.center().z);
    let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target, fov_y };
    orbit.distance = fitting_distance(&orbit, 1.0, 0.96, scene.corners().filter(|p| p.y > low));
    orbit.camera(bounds.diagonal() / 2.0)
}

fn picture(scene: &Scene, camera: &Camera, lighting: &Lighting, shading: Shading) -> Result<Picture> {
    let settings = RenderSettings {
        width: SIDE,
        height: SIDE,
        samples: 4,
        shading,
        shadows: true,
        ..RenderSettings::default()
    };
    let image = render(scene, &Shot { camera, lighting, settings: &settings })?.color;
    let development = Development { background: Some(Vec3::splat(GROUND)), ..Development::default() };
    let pixels = develop8(&image, &development)?.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
    Ok(Picture { width: SIDE, height: SIDE, pixels })
}
