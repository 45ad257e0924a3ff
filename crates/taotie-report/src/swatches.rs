//! A sphere in each material preset, lit by the built-in studio.

use crate::sheet::{Cell, Sheet};
use std::sync::Arc;
use taotie_engine::Result;
use taotie_engine::film::{Development, develop8};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Material, Orbit, PRESETS, Scene, preset};
use taotie_engine::shade::environment::{Environment, studio};

/// Spheres per row.
const COLUMNS: usize = 4;

/// Draws a sheet of all presets; the picture of each sphere is `size` pixels wide.
///
/// # Errors
/// Those of [`render`].
pub fn sheet(size: u32) -> Result<Sheet> {
    let environment = Arc::new(Environment::new(studio())?);
    let light = EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false };
    let lighting = Lighting { environment: Some(light), ..Lighting::default() };
    let known = PRESETS.iter().filter_map(|listed| Some((listed, preset(listed.name)?)));
    let cells = known.map(|(listed, material)| {
        let pixels = sphere(material, &lighting, size)?;
        Ok(Cell { title: listed.name.into(), note: listed.source.into(), pixels })
    });
    let cells = cells.collect::<Result<Vec<_>>>()?;
    Ok(Sheet::new(&cells, [size as usize; 2], COLUMNS))
}

fn sphere(material: Material, lighting: &Lighting, size: u32) -> Result<Vec<[u8; 3]>> {
    let scene = Scene::of_mesh(Mesh::sphere(1.0, 96, 48), material)?;
    let orbit = Orbit { azimuth: 0.4, elevation: 0.25, distance: 4.4, target: Vec3::default(), fov_y: 0.52 };
    let settings = RenderSettings { width: size, height: size, samples: 16, ..RenderSettings::default() };
    let camera = orbit.camera(1.0);
    let frame = render(&scene, &Shot { camera: &camera, lighting, settings: &settings })?;
    let development = Development { background: Some(Vec3::splat(0.02)), ..Development::default() };
    Ok(develop8(&frame.color, &development)?.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
}
