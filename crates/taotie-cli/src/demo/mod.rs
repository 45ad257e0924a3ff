//! `taotie demo`: the built-in bronze by every surface method and every shading model.

mod export;

use crate::console::{self, Progress};
use crate::jue;
use crate::render::{PictureFormat, write_picture};
use crate::sheet::{Cell, Sheet};
use crate::studio::in_pool;
use anyhow::Result;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use taotie::film::{self, Development};
use taotie::image::{Encoding, Image, Texture};
use taotie::io::{self, PngColor, PngImage, PngSamples};
use taotie::math::Vec3;
use taotie::names::Named;
use taotie::render::{Lighting, RenderSettings, SurfaceSettings, render};
use taotie::scene::{
    Camera, Falloff, Light, LightKind, NormalSpace, Orbit, Scene, fitting_distance, from_view,
};
use taotie::shade::Shading;
use taotie::surface::SurfaceMethod;

const EXAMPLES: &str = "\
Examples:
  taotie demo
  taotie demo --out pictures --size 512";

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// Renders the built-in bronze jue by every surface method and shading model.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct DemoArgs {
    /// Folder to write to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "taotie-demo")]
    pub out: PathBuf,
    /// Side of each picture of the contact sheet, pixels
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = clap::value_parser!(u32).range(64..=2048))]
    pub size: u32,
    /// Threads; all of the machine's if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub threads: Option<u32>,
    /// Print a report as JSON
    #[arg(long)]
    pub json: bool,
}

/// Texels along a side of the jue's maps.
const MAPS: u32 = 2048;
/// Pixels along a side of the large picture.
const LARGE: u32 = 1400;
/// Pictures in a row of the contact sheet.
const COLUMNS: usize = 4;
/// Behind the vessel.
const GROUND: f32 = 0.055;

/// One picture of the contact sheet.
struct Picture {
    title: String,
    note: &'static str,
    surface: SurfaceMethod,
    bump_scale: Option<f32>,
    shading: Shading,
}

/// A picture that was made.
struct Made {
    picture: Picture,
    milliseconds: f64,
}

/// Runs the subcommand.
pub fn run(args: &DemoArgs) -> Result<()> {
    std::fs::create_dir_all(&args.out).map_err(|error| taotie::Error::io(&args.out, error))?;
    let threads = args.threads.map(|threads| threads as usize);
    let (files, made) = in_pool(threads, || demo(args))??;
    if args.json {
        return console::result(&serde_json::to_string_pretty(&report(&files, &made))?);
    }
    print_table(&made)?;
    for file in &files {
        console::result(&format!("wrote {}", file.display()))?;
    }
    Ok(())
}

fn demo(args: &DemoArgs) -> Result<(Vec<PathBuf>, Vec<Made>)> {
    let progress = Progress::new("demo");
    let scene = jue::scene(MAPS);
    let object_scene = with_object_map(&scene);
    let (whole, cup) = (Stage::whole(&scene), Stage::cup(&scene));
    let mut files = export::write(&args.out, &scene)?;
    let pictures = pictures();
    let steps = (pictures.len() + 1) as f64;
    let (mut cells, mut made) = (Vec::new(), Vec::new());
    for (i, picture) in pictures.into_iter().enumerate() {
        progress.set(i as f64 / steps);
        let scene = if picture.surface == SurfaceMethod::ObjectNormal { &object_scene } else { &scene };
        let start = Instant::now();
        let image = cup.take(scene, &picture, args.size, 4)?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        cells.push(cell(&picture, &image)?);
        made.push(Made { picture, milliseconds });
    }
    files.push(write_sheet(args, &cells)?);
    progress.set(1.0 - 1.0 / steps);
    files.push(write_large(args, &whole, &scene)?);
    Ok((files, made))
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
fn with_object_map(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.textures.push(Texture::new(jue::object_normal_map(MAPS), Encoding::Linear));
    let index = scene.textures.len() - 1;
    for map in scene.materials.iter_mut().filter_map(|material| material.normal.as_mut()) {
        map.texture.texture = index;
        map.space = NormalSpace::Object;
    }
    scene
}

/// Camera and lights of all pictures.
struct Stage {
    camera: Camera,
    lighting: Lighting,
}

impl Stage {
    /// The whole vessel.
    fn whole(scene: &Scene) -> Self {
        let bounds = scene.bounds().expect("the jue has triangles");
        let mut orbit = orbit([24.0, 15.0], bounds.center());
        orbit.distance = fitting_distance(&orbit, 1.0, 0.92, scene.corners());
        Self::new(orbit, bounds.diagonal())
    }

    /// The mask on the cup, near enough to tell one method from another.
    fn cup(scene: &Scene) -> Self {
        let bounds = scene.bounds().expect("the jue has triangles");
        let low = bounds.min + (bounds.max - bounds.min) * 0.36;
        let high = bounds.min + (bounds.max - bounds.min) * 0.72;
        let middle = Vec3::new(0.0, (low.y + high.y) / 2.0, 0.0);
        let mut orbit = orbit([14.0, 12.0], middle);
        let within = move |p: &Vec3<f64>| (low.y..high.y).contains(&p.y) && p.x.abs() < 0.05;
        orbit.distance = fitting_distance(&orbit, 1.0, 0.96, scene.corners().filter(within));
        Self::new(orbit, bounds.diagonal())
    }

    fn new(orbit: Orbit, size: f64) -> Self {
        let camera = orbit.camera(size / 2.0);
        let lighting = Lighting { lights: lights(&camera), ambient: Vec3::new(0.20, 0.205, 0.22) };
        Self { camera, lighting }
    }

    fn take(&self, scene: &Scene, picture: &Picture, side: u32, samples: u32) -> Result<Image> {
        let settings = RenderSettings {
            width: side,
            height: side,
            samples,
            shading: picture.shading,
            surface: SurfaceSettings {
                method: Some(picture.surface),
                tangents: None,
                bump_scale: picture.bump_scale,
            },
            shadows: true,
            ..RenderSettings::default()
        };
        Ok(render(scene, &self.camera, &self.lighting, &settings)?.color)
    }
}

/// Looks at `target` from azimuth and elevation in degrees.
fn orbit([azimuth, elevation]: [f64; 2], target: Vec3<f64>) -> Orbit {
    let [azimuth, elevation, fov_y] = [azimuth, elevation, 26.0].map(f64::to_radians);
    Orbit { azimuth, elevation, distance: 0.0, target, fov_y }
}

/// A raking key, a row of soft boxes for the metal to mirror, and a rim.
fn lights(camera: &Camera) -> Vec<Light> {
    let lamps: [([f64; 2], [f32; 3]); 6] = [
        ([-56.0, 36.0], [6.4, 6.0, 5.4]),
        ([-16.0, 64.0], [1.8, 1.8, 1.8]),
        ([30.0, 25.0], [1.1, 1.15, 1.25]),
        ([70.0, 8.0], [1.5, 1.6, 1.8]),
        ([150.0, 38.0], [4.2, 4.2, 4.4]),
        ([-140.0, 20.0], [2.2, 2.1, 1.9]),
    ];
    let light = |([azimuth, elevation], color): ([f64; 2], [f32; 3])| Light {
        name: String::new(),
        kind: LightKind::Directional {
            direction: -from_view(camera, azimuth.to_radians(), elevation.to_radians()),
        },
        color: Vec3::from_array(color),
        falloff: Falloff::None,
    };
    lamps.map(light).into()
}

fn development() -> Development {
    Development { background: Some(Vec3::splat(GROUND)), ..Development::default() }
}

fn cell(picture: &Picture, image: &Image) -> Result<Cell> {
    let pixels = film::develop8(image, &development())?.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
    Ok(Cell { title: picture.title.clone(), note: picture.note.into(), pixels })
}

fn write_sheet(args: &DemoArgs, cells: &[Cell]) -> Result<PathBuf> {
    let sheet = Sheet::new(cells, [args.size as usize; 2], COLUMNS);
    let path = args.out.join("sheet.png");
    let picture = PngImage {
        width: sheet.width as u32,
        height: sheet.height as u32,
        color: PngColor::Rgb,
        samples: PngSamples::U8(sheet.pixels.as_flattened()),
        encoding: Encoding::Srgb,
    };
    io::write_png(&path, &picture)?;
    Ok(path)
}

fn write_large(args: &DemoArgs, stage: &Stage, scene: &Scene) -> Result<PathBuf> {
    let picture = Picture {
        title: String::new(),
        note: "",
        surface: SurfaceMethod::TangentNormal,
        bump_scale: None,
        shading: Shading::Ggx,
    };
    let path = args.out.join("jue.png");
    write_picture(&path, &stage.take(scene, &picture, LARGE, 16)?, &development(), PictureFormat::Png8)?;
    Ok(path)
}

fn print_table(made: &[Made]) -> Result<()> {
    console::result(&format!("{:<22} {:<15} {:<22} {:>8}", "picture", "surface", "shading", "ms"))?;
    for Made { picture, milliseconds } in made {
        let (surface, shading) = (picture.surface.name(), picture.shading.name());
        console::result(&format!("{:<22} {surface:<15} {shading:<22} {milliseconds:>8.0}", picture.title))?;
    }
    console::result("")
}

fn report(files: &[PathBuf], made: &[Made]) -> serde_json::Value {
    let pictures: Vec<serde_json::Value> = made
        .iter()
        .map(|Made { picture, milliseconds }| {
            json!({
                "title": picture.title,
                "surface": picture.surface.name(),
                "shading": picture.shading.name(),
                "bump_scale": picture.bump_scale,
                "milliseconds": milliseconds,
            })
        })
        .collect();
    json!({ "schema": SCHEMA, "version": env!("CARGO_PKG_VERSION"), "files": files, "pictures": pictures })
}
