//! A model with its initial view, and the data of its page: everything that the script reads apart from the model.

use super::document::Blob;
use super::light::{Light, light};
use super::model::{self, TextureData, textures};
use super::scan::{Errors, MeasuredErrors, ScanSubject, errors, known_errors};
use super::surfaces::{Drawing, FrameLayout, Shaders, SurfaceData, Texts, method_names};
use super::views::{Bookmark, Orbit, Outline};
use crate::Fact;
use serde::Serialize;
use taotie_engine::bake::RayPreview;
use taotie_engine::film::Development;
use taotie_engine::length::Unit;
use taotie_engine::names::Named;
use taotie_engine::raster::SamplePattern;
use taotie_engine::render::{Lighting, Prepared, RenderSettings};
use taotie_engine::scene::Camera;
use taotie_engine::shade::Shading;
use taotie_engine::shade::dfg::{COLUMNS, tables};
use taotie_engine::{Result, Warnings};

/// A model and its initial view.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The heading and window title.
    pub title: &'a str,
    /// Source and rights, as shown on the page.
    pub facts: &'a [Fact],
    /// The unit of the coordinates of the model, `scan` and `errors`: metres, or unknown. See
    /// [`taotie::asset::model_unit`].
    pub unit: Option<Unit>,
    /// Views that the page offers.
    pub bookmarks: &'a [Bookmark],
    /// The model.
    pub prepared: &'a Prepared,
    /// The initial reflectance model and surface method, and all settings that affect shaders. The size is ignored.
    pub settings: &'a RenderSettings,
    /// The camera.
    pub camera: &'a Camera,
    /// The light.
    pub lighting: &'a Lighting,
    /// Exposure, tone curve and background.
    pub development: &'a Development,
    /// The scan that the model is measured against.
    pub scan: Option<ScanSubject<'a>>,
    /// The model's errors, if already known; ignored if `scan` is present.
    pub errors: Option<MeasuredErrors<'a>>,
    /// Projection rays of the model's bake.
    pub rays: Option<&'a RayPreview>,
}

/// The data of a page, as declared in `viewer/src/data.ts`.
#[derive(Serialize)]
pub(super) struct Data<'a> {
    version: &'static str,
    title: &'a str,
    facts: &'a [Fact],
    in_metres: bool,
    bookmarks: &'a [Bookmark],
    camera: Option<Orbit>,
    light: Light,
    film: Film,
    /// The names of reflectance models and of surface methods, and the ones shown initially.
    shadings: Vec<&'static str>,
    methods: Vec<&'static str>,
    shading: &'static str,
    method: Option<&'static str>,
    /// The columns and rows of the albedo tables.
    tables: [usize; 2],
    frame: Option<FrameLayout>,
    texts: Texts,
    /// The asset, and the scan if it is published.
    models: Vec<Model>,
    errors: Option<Errors>,
    /// The number of projection rays that found the scan; those that did not follow in the blob `rays`.
    rays: Option<usize>,
}

/// A model on the page.
#[derive(Serialize)]
struct Model {
    /// The blob names of its GLB and of its numbers.
    glb: &'static str,
    codes: &'static str,
    surfaces: Vec<SurfaceData>,
    textures: Vec<TextureData>,
}

/// The development of the picture.
#[derive(Serialize)]
struct Film {
    exposure: f32,
    tone: &'static str,
    /// Linear RGB.
    background: Option<[f32; 3]>,
    /// The sample positions within a pixel while nothing moves, in 1/256 pixel.
    samples: Vec<[i32; 2]>,
}

impl Data<'_> {
    /// Returns the content of the page that manifests describe.
    pub fn outline(&self) -> Outline {
        Outline {
            title: self.title.into(),
            facts: self.facts.into(),
            bookmarks: self.bookmarks.into(),
            camera: self.camera,
            lights: self.light.lights.clone(),
            ambient: self.light.ambient,
        }
    }

    /// Returns the data as JSON.
    pub fn json(&self) -> Vec<u8> {
        serde_json::to_vec(self).expect("the data have only text keys")
    }
}

/// The models of a page, during assembly.
struct Models<'a> {
    settings: &'a RenderSettings,
    environment: bool,
    shaders: Shaders,
    all: Vec<Model>,
    blobs: Vec<Blob>,
}

impl Models<'_> {
    fn add(
        &mut self,
        prepared: &Prepared,
        [glb, codes]: [&'static str; 2],
        warnings: &mut Warnings,
    ) -> Result<()> {
        let (settings, environment) = (self.settings, self.environment);
        let mut drawing = Drawing { prepared, settings, environment, shaders: &mut self.shaders };
        let (model, (surfaces, (textures, numbers))) = rayon::join(
            || model::glb(prepared, warnings),
            || (drawing.surfaces(), textures(prepared.scene(), codes)),
        );
        self.blobs.push(Blob::new(glb, model?));
        self.blobs.extend(numbers);
        self.all.push(Model { glb, codes, surfaces, textures });
        Ok(())
    }
}

/// Returns the data of a page and its other blobs.
pub(super) fn data<'a>(subject: &Subject<'a>, warnings: &mut Warnings) -> Result<(Data<'a>, Vec<Blob>)> {
    let (prepared, settings) = (subject.prepared, subject.settings);
    let (light, blobs) = light(subject.lighting, warnings);
    let environment = subject.lighting.environment.is_some();
    let mut models = Models { settings, environment, shaders: Shaders::default(), all: Vec::new(), blobs };
    models.add(prepared, ["asset", "codes"], warnings)?;
    let mut measured = None;
    if let Some(scan) = &subject.scan {
        if let Some(published) = scan.published {
            models.add(published, ["scan", "scan_codes"], warnings)?;
        }
        let (errors, blob) = errors(prepared, scan.measured, warnings)?;
        models.blobs.push(blob);
        measured = Some(errors);
    } else if let Some(known) = &subject.errors {
        let (errors, blob) = known_errors(known, &prepared.surfaces());
        models.blobs.push(blob);
        measured = Some(errors);
    }
    let Models { shaders, all, mut blobs, .. } = models;
    let numbers = tables();
    let bytes = numbers.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
    blobs.push(Blob::new("albedo_tables", bytes));
    blobs.extend(subject.rays.map(rays));
    let bounds = prepared.scene().bounds();
    let data = Data {
        version: env!("CARGO_PKG_VERSION"),
        title: subject.title,
        facts: subject.facts,
        in_metres: subject.unit == Some(Unit::Metre),
        bookmarks: subject.bookmarks,
        camera: bounds.map(|bounds| Orbit::new(subject.camera, &bounds, warnings)),
        light,
        film: film(subject),
        shadings: Shading::NAMES.iter().map(|(name, _)| *name).collect(),
        methods: method_names(),
        shading: settings.shading.name(),
        method: settings.surface.method.map(Named::name),
        tables: [COLUMNS, numbers.len() / COLUMNS],
        frame: shaders.frame(),
        texts: shaders.texts(),
        models: all,
        errors: measured,
        rays: subject.rays.map(|rays| rays.met.len()),
    };
    Ok((data, blobs))
}

/// Returns the ends of rays, six numbers each.
fn rays(rays: &RayPreview) -> Blob {
    let numbers = rays.met.iter().chain(&rays.missed).flatten().flat_map(|end| end.to_array());
    Blob::new("rays", numbers.flat_map(f32::to_le_bytes).collect())
}

fn film(subject: &Subject<'_>) -> Film {
    let development = subject.development;
    let pattern = SamplePattern::new(subject.settings.samples);
    Film {
        exposure: development.exposure_stops,
        tone: development.tone.name(),
        background: development.background.map(|color| color.to_array()),
        samples: pattern.map_or(vec![[128, 128]], |pattern| pattern.offsets().to_vec()),
    }
}
