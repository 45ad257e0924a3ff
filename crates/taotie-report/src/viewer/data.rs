//! The data of a page: all that its script reads beside the model.

use super::Subject;
use super::blob::Blob;
use super::camera::Orbit;
use super::light::{Light, light};
use super::shaders::{FrameLayout, Shaders, Texts};
use super::surfaces::{Drawing, SurfaceData, method_names};
use super::textures::{TextureData, textures};
use crate::Fact;
use serde::Serialize;
use taotie::Warnings;
use taotie::names::Named;
use taotie::raster::SamplePattern;
use taotie::shade::Shading;
use taotie::shade::dfg::{COLUMNS, tables};

/// The data of a page, as `viewer/src/data.ts` declares it.
#[derive(Serialize)]
pub(super) struct Data<'a> {
    version: &'static str,
    title: &'a str,
    facts: &'a [Fact],
    camera: Option<Orbit>,
    light: Light,
    film: Film,
    /// The names of reflectance models and of surface methods, and those shown first.
    shadings: Vec<&'static str>,
    methods: Vec<&'static str>,
    shading: &'static str,
    method: Option<&'static str>,
    /// Columns and rows of the tables of albedos.
    tables: [usize; 2],
    frame: Option<FrameLayout>,
    texts: Texts,
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
    /// The places of samples in a pixel that is drawn while nothing moves, 1/256 pixel.
    samples: Vec<[i32; 2]>,
}

impl Data<'_> {
    /// The data as JSON.
    pub fn json(&self) -> Vec<u8> {
        serde_json::to_vec(self).expect("the data have only text keys")
    }
}

/// The data of a page, and its bytes beside the model's.
pub(super) fn data<'a>(subject: &Subject<'a>, warnings: &mut Warnings) -> (Data<'a>, Vec<Blob>) {
    let scene = subject.prepared.scene();
    let mut shaders = Shaders::default();
    let (light, mut blobs) = light(subject.lighting, warnings);
    let environment = subject.lighting.environment.is_some();
    let (prepared, settings) = (subject.prepared, subject.settings);
    let surfaces = Drawing { prepared, settings, environment, shaders: &mut shaders }.surfaces();
    let (textures, codes) = textures(scene);
    let numbers = tables();
    let bytes = numbers.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
    blobs.push(Blob::new("albedo_tables", bytes));
    blobs.extend(codes);
    let data = Data {
        version: env!("CARGO_PKG_VERSION"),
        title: subject.title,
        facts: subject.facts,
        camera: scene.bounds().map(|bounds| Orbit::new(subject.camera, &bounds, warnings)),
        light,
        film: film(subject),
        shadings: Shading::NAMES.iter().map(|(name, _)| *name).collect(),
        methods: method_names(),
        shading: settings.shading.name(),
        method: settings.surface.method.map(Named::name),
        tables: [COLUMNS, numbers.len() / COLUMNS],
        frame: shaders.frame(),
        texts: shaders.texts(),
        surfaces,
        textures,
    };
    (data, blobs)
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
