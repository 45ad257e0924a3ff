//! Scan and asset seen from all sides in the same light.

use super::proof::ViewFigures;
use anyhow::Result;
use taotie::Progress;
use taotie::compare::{self, Field, PIXELS_PER_DEGREE, Picture};
use taotie::film::Development;
use taotie::math::{Mat4, Vec3};
use taotie::mesh::Mesh;
use taotie::render::{Lighting, RenderSettings, Renderer};
use taotie::scene::{Camera, Instance, Material, Orbit, Scene, SceneData, fitting_distance, three_point_rig};

/// Pixels along a side of the pictures.
const SIDE: u32 = 384;
/// From how many sides.
const COUNT: usize = 8;
/// Degrees above and below the horizon, by turns.
const ELEVATIONS: [f64; 2] = [20.0, -12.0];

/// The pictures and their differences, view by view.
#[derive(Default)]
pub struct Shots {
    /// Of the scan.
    pub scan: Vec<Picture>,
    /// Of the asset.
    pub asset: Vec<Picture>,
    /// What an observer sees of the difference.
    pub flip: Vec<Field>,
    /// The same in numbers.
    pub figures: Vec<ViewFigures>,
}

/// Takes the pictures, both of one neutral material, so that nothing but shape and normals differs.
///
/// # Errors
/// None but those of rendering, which a scene that was read does not cause.
pub fn take(scan: Mesh, asset: Scene, progress: Progress<'_>) -> Result<Shots> {
    let heavy = Scene::new(SceneData {
        meshes: vec![scan],
        materials: vec![neutral()],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    })?;
    let cameras = cameras(&heavy);
    let light = neutralised(asset)?;
    let scan = pictures(&heavy, &cameras, progress.part(0.0, 0.5))?;
    drop(heavy);
    let asset = pictures(&light, &cameras, progress.part(0.5, 0.9))?;
    let mut shots = Shots { scan, asset, ..Shots::default() };
    for (i, (a, b)) in shots.scan.iter().zip(&shots.asset).enumerate() {
        let flip = compare::flip(a, b, PIXELS_PER_DEGREE)?;
        shots.figures.push(ViewFigures {
            azimuth_deg: azimuth(i),
            elevation_deg: ELEVATIONS[i % 2],
            flip: flip.summary().map_or(0.0, |summary| summary.mean),
            ssim: compare::ssim(a, b)?,
        });
        shots.flip.push(flip);
    }
    Ok(shots)
}

fn neutral() -> Material {
    Material {
        base_color: [0.55, 0.55, 0.55, 1.0],
        roughness: 0.5,
        double_sided: true,
        ..Material::default()
    }
}

/// The finest level of the asset with the neutral material, its normal map kept.
fn neutralised(mut asset: Scene) -> Result<Scene> {
    asset.edit(|asset| {
        for material in &mut asset.materials {
            *material = Material { normal: material.normal, ..neutral() };
        }
        asset.lights.clear();
    })?;
    Ok(asset)
}

fn azimuth(view: usize) -> f64 {
    view as f64 * 360.0 / COUNT as f64
}

fn cameras(scene: &Scene) -> Vec<Camera> {
    let Some(bounds) = scene.bounds() else { return Vec::new() };
    let camera = |i: usize| {
        let [azimuth, elevation, fov_y] = [azimuth(i), ELEVATIONS[i % 2], 30.0].map(f64::to_radians);
        let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: bounds.center(), fov_y };
        orbit.distance = fitting_distance(&orbit, 1.0, 0.92, scene.corners());
        orbit.camera(bounds.diagonal() / 2.0)
    };
    (0..COUNT).map(camera).collect()
}

fn pictures(scene: &Scene, cameras: &[Camera], progress: Progress<'_>) -> Result<Vec<Picture>> {
    let settings = RenderSettings { width: SIDE, height: SIDE, samples: 4, ..RenderSettings::default() };
    let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
    let mut renderer = Renderer::new(scene, &settings.surface)?;
    let (mut pictures, mut codes) = (Vec::new(), Vec::new());
    for (i, camera) in cameras.iter().enumerate() {
        let [from, to] = [i, i + 1].map(|views| views as f64 / cameras.len() as f64);
        let lighting =
            Lighting { lights: three_point_rig(camera), ambient: Vec3::splat(0.15), environment: None };
        renderer.develop(
            (camera, &lighting),
            &settings,
            &development,
            &mut codes,
            progress.part(from, to),
        )?;
        pictures.push(Picture::from_developed(SIDE, SIDE, &codes)?);
    }
    Ok(pictures)
}
