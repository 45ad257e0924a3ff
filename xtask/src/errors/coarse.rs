//! Coarse smooth meshes against a fine one, both by the reference integrator.

use super::row;
use super::split_sum::Sky;
use anyhow::Result;
use taotie::Progress;
use taotie::image::Image;
use taotie::math::Vec3;
use taotie::mesh::Mesh;
use taotie::render::{
    EnvironmentLight, Lighting, Prepared, ReferenceSettings, RenderSettings, Shot, reference,
};
use taotie::scene::{Camera, Falloff, Light, LightKind, Material, Orbit, Scene, Specular, from_view};

/// Columns of the spheres; each has half as many rows.
const COLUMNS: [usize; 5] = [12, 16, 24, 48, 96];
/// Columns of the sphere that counts as smooth.
const SMOOTH: usize = 1024;

const SIDE: u32 = 128;
const SPP: u32 = 256;

/// A row per sphere: how much more light it reflects than a smooth one does, for each material and light.
pub fn table(studio: &Sky) -> Result<String> {
    let titles =
        ["triangles", "matt, white room", "matt, studio", "metal, studio", "matt, lamp", "metal, lamp"];
    let mut text = row(&titles.map(String::from));
    text += "| --: | --: | --: | --: | --: | --: |\n";
    let lights = Lights { room: Sky::white()?.light(), studio: studio.light() };
    let truths = lights.images(SMOOTH)?;
    for columns in COLUMNS {
        let mut cells = vec![sphere(columns).triangles().len().to_string()];
        let pairs = lights.images(columns)?.into_iter().zip(&truths);
        cells.extend(pairs.map(|(coarse, truth)| format!("{:+.2} %", excess(&coarse, truth) * 100.0)));
        text += &row(&cells);
    }
    Ok(text)
}

fn sphere(columns: usize) -> Mesh {
    Mesh::sphere(1.0, columns, columns / 2)
}

/// Light from all around.
struct Lights {
    room: EnvironmentLight,
    studio: EnvironmentLight,
}

impl Lights {
    /// Images of a sphere: matt in the room, matt and metal in the studio, both under a lamp that casts shadows.
    fn images(&self, columns: usize) -> Result<Vec<Image>> {
        let orbit =
            Orbit { azimuth: 0.1, elevation: 0.3, distance: 4.4, target: Vec3::default(), fov_y: 0.52 };
        let camera = orbit.camera(1.0);
        let around =
            |light: &EnvironmentLight| Lighting { environment: Some(light.clone()), ..Lighting::default() };
        let (studio, lamp) = (around(&self.studio), lamp(&camera));
        let all = [
            (matt(), around(&self.room)),
            (matt(), studio.clone()),
            (metal(), studio),
            (matt(), lamp.clone()),
            (metal(), lamp),
        ];
        all.into_iter().map(|(material, lighting)| image(columns, material, &camera, &lighting)).collect()
    }
}

fn matt() -> Material {
    let specular = Specular { factor: 0.0, ..Specular::default() };
    Material { base_color: [0.8, 0.8, 0.8, 1.0], roughness: 1.0, specular, ..Material::default() }
}

fn metal() -> Material {
    Material { base_color: [0.8, 0.8, 0.8, 1.0], roughness: 0.4, metallic: 1.0, ..Material::default() }
}

fn image(columns: usize, material: Material, camera: &Camera, lighting: &Lighting) -> Result<Image> {
    let settings = RenderSettings { width: SIDE, height: SIDE, shadows: true, ..RenderSettings::default() };
    let prepared = Prepared::new(Scene::of_mesh(sphere(columns), material)?, &settings.surface)?;
    let shot = Shot { camera, lighting, settings: &settings };
    let paths = ReferenceSettings { spp: SPP, bounces: 0, ..ReferenceSettings::default() };
    Ok(reference(&prepared, &shot, &paths, Progress::SILENT)?.color)
}

/// A lamp at the side, so that half of the visible sphere lies in its own shadow.
fn lamp(camera: &Camera) -> Lighting {
    let kind = LightKind::Directional { direction: -from_view(camera, -1.3, 0.26) };
    let light = Light { name: String::new(), kind, color: Vec3::splat(3.0), falloff: Falloff::None };
    Lighting { lights: vec![light], ..Lighting::default() }
}

/// The light of the pixels that both cover, relative to that of the truth, less 1.
fn excess(coarse: &Image, truth: &Image) -> f64 {
    let (mut ours, mut theirs) = (0.0, 0.0);
    for (a, b) in coarse.pixels().iter().zip(truth.pixels()).filter(|(a, b)| a[3] > 0.999 && b[3] > 0.999) {
        ours += a[..3].iter().map(|v| f64::from(*v)).sum::<f64>();
        theirs += b[..3].iter().map(|v| f64::from(*v)).sum::<f64>();
    }
    ours / theirs - 1.0
}
