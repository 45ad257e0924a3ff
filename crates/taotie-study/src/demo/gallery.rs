//! Pictures of the jue by every surface method and every shading model, and a large one.

use super::stage::{self, Stage};
use super::{Output, Vessel};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;
use taotie_engine::Result;
use taotie_engine::names::Named;
use taotie_engine::render::{RenderSettings, SurfaceSettings};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_report::sheet::{Cell, Sheet};

/// The side of the large picture, pixels.
const LARGE: u32 = 1400;
/// Pictures per row of the contact sheet.
const COLUMNS: usize = 4;

/// A picture to render for the contact sheet.
struct Picture {
    title: String,
    note: &'static str,
    surface: SurfaceMethod,
    bump_scale: Option<f32>,
    shading: Shading,
}

/// A rendered picture of the contact sheet.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Made {
    /// Its title on the sheet.
    pub title: String,
    /// The name of its [`SurfaceMethod`].
    pub surface: &'static str,
    /// The name of its [`Shading`].
    pub shading: &'static str,
    /// The factor of its bump, if different from that of the material.
    pub bump_scale: Option<f32>,
    /// The rendering time, milliseconds.
    pub milliseconds: f64,
}

impl Made {
    fn new(picture: Picture, start: Instant) -> Self {
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let Picture { title, surface, bump_scale, shading, .. } = picture;
        Self { title, surface: surface.name(), shading: shading.name(), bump_scale, milliseconds }
    }
}

/// Renders every picture of the contact sheet and writes `sheet.png`; `progress` is called with the fraction done.
///
/// # Errors
/// Those of rendering and writing.
pub fn write_sheet(
    vessel: &Vessel,
    output: &Output<'_>,
    progress: &dyn Fn(f64),
) -> Result<(PathBuf, Vec<Made>)> {
    let cup = Stage::cup(vessel.scene())?;
    let pictures = pictures();
    let steps = pictures.len() as f64;
    let (mut cells, mut made) = (Vec::new(), Vec::new());
    for (i, picture) in pictures.into_iter().enumerate() {
        progress(i as f64 / steps);
        let in_object_space = picture.surface == SurfaceMethod::ObjectNormal;
        let scene = if in_object_space { vessel.object_scene() } else { vessel.scene() };
        let start = Instant::now();
        let image = cup.take(scene, &settings(&picture, output.side, 4))?;
        let (title, note) = (picture.title.clone(), picture.note.into());
        made.push(Made::new(picture, start));
        cells.push(Cell { title, note, pixels: stage::pixels(&image)? });
    }
    let path = output.folder.join("sheet.png");
    let sheet = Sheet::new(&cells, [output.side as usize; 2], COLUMNS);
    output.files.write_png(&path, &sheet.png())?;
    Ok((path, made))
}

/// Renders the large picture of the whole vessel and writes `jue.png`.
///
/// # Errors
/// Those of rendering and writing.
pub fn write_large(vessel: &Vessel, output: &Output<'_>) -> Result<PathBuf> {
    let path = output.folder.join("jue.png");
    let image = Stage::whole(vessel.scene())?.take(vessel.scene(), &Stage::settings(LARGE, 16))?;
    stage::write_picture(output.files, &path, &image)?;
    Ok(path)
}

fn settings(picture: &Picture, side: u32, samples: u32) -> RenderSettings {
    let base = Stage::settings(side, samples);
    let (method, bump_scale) = (Some(picture.surface), picture.bump_scale);
    let surface = SurfaceSettings { method, bump_scale, ..base.surface };
    RenderSettings { shading: picture.shading, surface, ..base }
}

/// Surface methods under `ggx`, then shading models on the tangent-space map.
fn pictures() -> Vec<Picture> {
    let surface = |title: &str, note, surface, bump_scale| Picture {
        title: title.into(),
        note,
        surface,
        bump_scale,
        shading: Shading::Ggx,
    };
    let mut pictures = vec![
        surface("facet", "one normal per triangle", SurfaceMethod::Facet, None),
        surface("smooth", "interpolated vertex normals", SurfaceMethod::Smooth, None),
        surface("bump", "height map, surface gradient", SurfaceMethod::Bump, None),
        surface("bump-printed 5", "the paper's bump, factor 5", SurfaceMethod::BumpPrinted, Some(5.0)),
        surface("bump-printed 50", "the paper's bump, factor 50", SurfaceMethod::BumpPrinted, Some(50.0)),
        surface("object-normal", "object-space normal map", SurfaceMethod::ObjectNormal, None),
        surface("tangent-normal", "tangent-space normal map", SurfaceMethod::TangentNormal, None),
    ];
    pictures.extend(Shading::NAMES.iter().map(|(name, shading)| Picture {
        title: (*name).into(),
        note: describe(*shading),
        surface: SurfaceMethod::TangentNormal,
        bump_scale: None,
        shading: *shading,
    }));
    pictures
}

fn describe(shading: Shading) -> &'static str {
    match shading {
        Shading::Lambert => "diffuse only",
        Shading::Phong => "reflection vector, 1975",
        Shading::BlinnPhong => "half vector, normalised",
        Shading::BlinnPhongClassic => "half vector, not normalised",
        Shading::CookTorrance => "Beckmann microfacets, 1982",
        Shading::Ggx => "GGX microfacets, glTF 2.0",
        Shading::CookTorrancePrinted => "as printed in the paper",
        Shading::BlinnPhongPrinted => "as in the article's shader",
        Shading::GgxPrinted => "as in the article's shader",
    }
}
