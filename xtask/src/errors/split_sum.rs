//! The split sum compared with the reference integrator, on a metal sphere.

use crate::computed::row;
use anyhow::{Context, Result};
use std::path::Path;
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop16};
use taotie_engine::image::Image;
use taotie_engine::math::{Lane, Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{
    EnvironmentLight, Lighting, Pass, Prepared, ReferenceSettings, RenderSettings, Shot, reference,
};
use taotie_engine::scene::{Instance, Orbit, Scene, SceneData, preset};
use taotie_engine::shade::environment::{Environment, studio};
use taotie_io::{decode_environment, read_bytes};

const ROUGHNESS: [f32; 7] = [0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0];

/// The side of the pictures in pixels, and the paths per pixel of the reference.
const SIDE: u32 = 64;
const SPP: u32 = 1024;

/// A named environment.
pub struct Sky {
    name: String,
    light: EnvironmentLight,
}

impl Sky {
    fn new(name: impl Into<String>, picture: Image) -> Result<Self> {
        let environment = Environment::new(picture)?.into();
        let light = EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false };
        Ok(Self { name: name.into(), light })
    }

    /// Returns the built-in studio.
    pub fn studio() -> Result<Self> {
        Self::new("studio", studio())
    }

    /// Returns all `.hdr` and `.exr` files of a folder.
    pub fn all_in(folder: &Path) -> Result<Vec<Self>> {
        let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
        let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
        paths.retain(|path| path.extension().is_some_and(|e| e == "hdr" || e == "exr"));
        paths.sort();
        let name = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        paths
            .iter()
            .map(|path| Self::new(name(path), decode_environment(&read_bytes(path)?, path)?))
            .collect()
    }
}

/// Returns a row per roughness: for each environment, the error relative to the light, and in the developed picture.
pub fn table(skies: &[Sky]) -> Result<String> {
    let mut titles = vec!["roughness".to_owned()];
    titles.extend(skies.iter().map(|sky| sky.name.clone()));
    let mut text = row(&titles);
    text += &format!("| --: |{}\n", " --: |".repeat(skies.len()));
    for roughness in ROUGHNESS {
        let mut cells = vec![format!("{roughness}")];
        for sky in skies {
            let (relative, seen) = errors(sky, roughness)?;
            cells.push(format!("{:.1} % / {:.1} %", relative * 100.0, seen * 100.0));
        }
        text += &row(&cells);
    }
    Ok(text)
}

fn errors(sky: &Sky, roughness: f32) -> Result<(f64, f64)> {
    let scene = bronze_sphere(roughness);
    let orbit = Orbit { azimuth: 0.0, elevation: 0.3, distance: 4.4, target: Vec3::default(), fov_y: 0.52 };
    let camera = orbit.camera(1.0);
    let settings = RenderSettings {
        width: SIDE,
        height: SIDE,
        samples: 16,
        specular_aa: false,
        ..RenderSettings::default()
    };
    let prepared = Prepared::new(scene, &settings.surface)?;
    let lighting = Lighting { environment: Some(sky.light.clone()), ..Lighting::default() };
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let ours = Pass::new(&prepared, &shot)?.render(Progress::SILENT)?;
    let paths = ReferenceSettings { spp: SPP, bounces: 0, ..ReferenceSettings::default() };
    let truth = reference(&prepared, &shot, &paths, Progress::SILENT)?;
    compare(&ours.color, &truth.color)
}

fn bronze_sphere(roughness: f32) -> Scene {
    let bronze = preset("bronze").expect("bronze is a preset");
    let material = taotie_engine::scene::Material { roughness, ..bronze };
    let data = SceneData {
        meshes: vec![Mesh::sphere(1.0, 128, 64)],
        materials: vec![material],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    };
    Scene::new(data).expect("one mesh and one material")
}

/// Returns the root mean square errors over the fully covered pixels of the sphere: of radiance, relative to its root
/// mean square, and of the developed picture, relative to white.
fn compare(ours: &Image, truth: &Image) -> Result<(f64, f64)> {
    let covered: Vec<usize> = (0..ours.pixels().len())
        .filter(|i| ours.pixels()[*i][3] > 0.999 && truth.pixels()[*i][3] > 0.999)
        .collect();
    let (mut error, mut light) = (0.0, 0.0);
    for (a, b) in covered.iter().map(|i| (ours.pixels()[*i], truth.pixels()[*i])) {
        for c in 0..3 {
            error += f64::from(a[c] - b[c]).squared();
            light += f64::from(b[c]).squared();
        }
    }
    let development = Development { background: Some(Vec3::splat(0.0)), ..Development::default() };
    let [seen, wanted] = [develop16(ours, &development)?, develop16(truth, &development)?];
    let apart = covered
        .iter()
        .map(|i| (0..3).map(|c| (f64::from(seen[*i][c]) - f64::from(wanted[*i][c])).squared()).sum::<f64>());
    let seen = (apart.sum::<f64>() / (3 * covered.len()) as f64).sqrt() / 65535.0;
    Ok(((error / light).sqrt(), seen))
}
