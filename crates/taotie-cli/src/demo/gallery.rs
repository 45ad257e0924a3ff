//! The jue by every surface method and every shading model, and once large.

use super::DemoArgs;
use super::stage::{self, Stage};
use crate::jue;
use crate::render::{PictureFormat, write_picture};
use crate::sheet::{Cell, Sheet};
use anyhow::Result;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use taotie::film;
use taotie::image::{Encoding, Image, Texture};
use taotie::io;
use taotie::names::Named;
use taotie::render::{RenderSettings, SurfaceSettings};
use taotie::scene::{NormalSpace, Scene};
use taotie::shade::Shading;
use taotie::surface::SurfaceMethod;

/// Pixels along a side of the large picture.
const LARGE: u32 = 1400;
/// Pictures in a row of the contact sheet.
const COLUMNS: usize = 4;

/// One picture of the contact sheet.
struct Picture {
    title: String,
    note: &'static str,
    surface: SurfaceMethod,
    bump_scale: Option<f32>,
    shading: Shading,
}

/// A picture that was made.
pub struct Made {
    picture: Picture,
    milliseconds: f64,
}

impl Made {
    /// As a line of the table.
    pub fn line(&self) -> String {
        let Picture { title, surface, shading, .. } = &self.picture;
        let (surface, shading) = (surface.name(), shading.name());
        format!("{title:<22} {surface:<15} {shading:<22} {:>8.0}", self.milliseconds)
    }

    /// As JSON.
    pub fn json(&self) -> serde_json::Value {
        json!({
            "title": self.picture.title,
            "surface": self.picture.surface.name(),
            "shading": self.picture.shading.name(),
            "bump_scale": self.picture.bump_scale,
            "milliseconds": self.milliseconds,
        })
    }
}

/// Makes every picture of the contact sheet and writes it; `object_scene` is `scene` with its object-space map.
///
/// # Errors
/// Those of rendering and writing.
pub fn write_sheet(
    args: &DemoArgs,
    [object_scene, scene]: [&Scene; 2],
    progress: &dyn Fn(f64),
) -> Result<(PathBuf, Vec<Made>)> {
    let cup = Stage::cup(scene);
    let pictures = pictures();
    let steps = pictures.len() as f64;
    let (mut cells, mut made) = (Vec::new(), Vec::new());
    for (i, picture) in pictures.into_iter().enumerate() {
        progress(i as f64 / steps);
        let scene = if picture.surface == SurfaceMethod::ObjectNormal { object_scene } else { scene };
        let start = Instant::now();
        let image = cup.take(scene, &settings(&picture, args.size, 4))?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        cells.push(cell(&picture, &image)?);
        made.push(Made { picture, milliseconds });
    }
    let path = args.out.join("sheet.png");
    let sheet = Sheet::new(&cells, [args.size as usize; 2], COLUMNS);
    io::write_png(&path, &sheet.png())?;
    Ok((path, made))
}

/// Makes the large picture of the whole vessel and writes it.
///
/// # Errors
/// Those of rendering and writing.
pub fn write_large(args: &DemoArgs, scene: &Scene) -> Result<PathBuf> {
    let path = args.out.join("jue.png");
    let image = Stage::whole(scene).take(scene, &Stage::settings(LARGE, 16))?;
    write_picture(&path, &image, &stage::development(), PictureFormat::Png8)?;
    Ok(path)
}

fn settings(picture: &Picture, side: u32, samples: u32) -> RenderSettings {
    let surface =
        SurfaceSettings { method: Some(picture.surface), tangents: None, bump_scale: picture.bump_scale };
    RenderSettings { shading: picture.shading, surface, ..Stage::settings(side, samples) }
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
        surface("facet", "one normal a triangle", SurfaceMethod::Facet, None),
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
        Shading::Lambert => "diffuse alone",
        Shading::Phong => "mirrored light, 1975",
        Shading::BlinnPhong => "half vector, normalised",
        Shading::BlinnPhongClassic => "half vector, not normalised",
        Shading::CookTorrance => "Beckmann microfacets, 1982",
        Shading::Ggx => "GGX microfacets, glTF 2.0",
        Shading::CookTorrancePrinted => "as the paper prints it",
        Shading::BlinnPhongPrinted => "as the article's shader",
        Shading::GgxPrinted => "as the article's shader",
    }
}

/// The same scene with the relief as an object-space map.
pub fn with_object_map(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let map = jue::object_normal_map(scene.textures()[0].width());
    let index = scene.add_texture(Texture::new(map, Encoding::Normal));
    let exchanged = scene.edit(|scene| {
        for map in scene.materials.iter_mut().filter_map(|material| material.normal.as_mut()) {
            map.texture.texture = index;
            map.space = NormalSpace::Object;
        }
    });
    exchanged.expect("the texture was just added");
    scene
}

fn cell(picture: &Picture, image: &Image) -> Result<Cell> {
    let pixels = film::develop8(image, &stage::development())?;
    let pixels = pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
    Ok(Cell { title: picture.title.clone(), note: picture.note.into(), pixels })
}
