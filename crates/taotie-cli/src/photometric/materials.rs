//! `taotie photometric --model`: materials from photographs with known cameras and lights.

use super::PhotometricArgs;
use crate::bake::clock::Clock;
use crate::console::{self, name_of};
use crate::stop;
use anyhow::{Result, bail};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use taotie::Warning;
use taotie::asset::StageTime;
use taotie_engine::film::Development;
use taotie_engine::image::{Encoding, Image};
use taotie_engine::{Progress, Warnings};
use taotie_io::{FileSet, ImageFormat, PngColor, PngImage, PngSamples};
use taotie_photometric::{
    LampPlace, MaterialEstimate, MaterialMaps, MaterialsEstimate, MaterialsInput, Model, Transforms,
};

/// Version of the JSON.
const SCHEMA: u32 = 1;

/// The photographs that the text lists.
const WORST: usize = 3;

/// The files of each material.
const MAPS: [&str; 6] =
    ["base_color.png", "roughness.png", "metallic.png", "mask.png", "base_color_sigma.exr", "sigma.exr"];

/// The report on materials.
#[derive(Serialize)]
pub struct MaterialsReport {
    pub schema: u32,
    /// Version of the program.
    pub version: &'static str,
    /// The file of cameras and lights, as given.
    pub input: String,
    /// The model, as given.
    pub model: String,
    /// The folder of the written files.
    pub output: String,
    /// Texels along a side of the maps.
    pub side: u32,
    /// The materials, in the model's order.
    pub materials: Vec<MaterialReport>,
    /// The photographs, in order.
    pub photographs: Vec<PhotographReport>,
    /// The duration of each stage.
    pub stages: Vec<StageTime>,
    /// Problems and corrections.
    pub warnings: Vec<Warning>,
}

/// A material. Means are those over the texels that photographs show lit.
#[derive(Serialize)]
pub struct MaterialReport {
    /// Its name in the model; may be empty.
    pub name: String,
    /// The start of the names of its maps; empty if there is one material.
    pub prefix: String,
    /// Texels that triangles cover.
    pub texels: usize,
    /// Those that no photograph shows lit: filled from the texels around them.
    pub unseen: usize,
    /// Mean number of photographs that show a texel lit.
    pub samples: f64,
    /// True if metallic is the model's, false if it is estimated.
    pub keeps_metallic: bool,
    /// Mean roughness.
    pub roughness: f64,
    /// Mean of its standard deviations.
    pub roughness_sigma: f64,
    /// Mean of the standard deviations of the base colour, linear RGB.
    pub base_color_sigma: f64,
    /// Mean metallic.
    pub metallic: f64,
}

/// A photograph and how well the materials explain it.
#[derive(Serialize)]
pub struct PhotographReport {
    /// The name of its file.
    pub name: String,
    /// Unit vector towards a distant light, world space.
    pub direction: Option<[f64; 3]>,
    /// The place of a near light, world space.
    pub position: Option<[f64; 3]>,
    /// Texels that it shows lit.
    pub texels: usize,
    /// Root mean square of sample less model, relative to that of the samples.
    pub residual: f64,
}

/// Estimates the materials of `model`, and writes all files.
pub fn run(args: &PhotometricArgs, path: &Path) -> Result<MaterialsReport> {
    let mut warnings = Warnings::default();
    let files = stop::files();
    let clock = Clock::default();
    let listener = |stage: &'static str, fraction: f64| {
        clock.hear(stage, fraction);
        true
    };
    let progress = Progress::new(&listener);
    if args.input.is_dir() {
        bail!(
            "{}: with --model, expected a file of cameras and lights such as transforms.json",
            args.input.display()
        );
    }
    let transforms = Transforms::open(&args.input)?;
    let limits = args.memory.limits();
    let loaded = taotie_io::load_model_within(path, &limits)?;
    warnings.absorb(loaded.warnings);
    warnings
        .note("the model moves: it is measured and written at rest", usize::from(loaded.moving.is_some()));
    files.protect(
        transforms.frames.iter().flat_map(|frame| [Some(&frame.path), frame.mask.as_ref()]).flatten(),
    )?;
    files.protect([&args.input, &path.to_path_buf()].into_iter().chain(&loaded.files))?;
    let model = Model::new(loaded.scene).map_err(|error| error.within(path.display()))?;
    model.check_maps().map_err(|error| error.within(path.display()))?;
    let output = Output { args, files: &files, count: model.materials().len() };
    output.claim()?;
    let (side, transfer) = (args.size, args.encoding);
    let input = MaterialsInput { model: &model, transforms: &transforms, side, transfer, limits };
    let estimate = MaterialsEstimate::of(&input, &mut warnings, progress)?;
    progress.begin("write")?;
    let maps =
        estimate.materials.iter().map(MaterialEstimate::maps).collect::<taotie_engine::Result<Vec<_>>>()?;
    note(&estimate, &maps, &mut warnings);
    for (i, maps) in maps.iter().enumerate() {
        output.write_maps(i, maps)?;
    }
    let scene = estimate.scene(&model, &maps, &mut warnings)?;
    let glb = taotie_io::encode_scene(&scene, &loaded.mesh_names, &mut warnings)?;
    files.write_bytes(&args.path("model.glb"), &glb)?;
    let materials =
        (0..maps.len()).map(|i| output.report((&estimate.materials[i], &maps[i]), i, &model)).collect();
    let report = MaterialsReport {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        input: args.input.display().to_string(),
        model: path.display().to_string(),
        output: args.output.display().to_string(),
        side: maps.first().map_or(0, |maps| maps.side),
        materials,
        photographs: photographs(&transforms, &estimate),
        stages: clock.done(),
        warnings: warnings.list(),
    };
    files.write_text(&args.path("report.json"), &serde_json::to_string_pretty(&report)?)?;
    files.commit()?;
    console::say_warnings(&warnings);
    Ok(report)
}

fn note(estimate: &MaterialsEstimate, maps: &[MaterialMaps], warnings: &mut Warnings) {
    let saturated = estimate.materials.iter().map(|material| material.saturated).sum();
    warnings.note("a sample of a texel is left out: a pixel there is saturated", saturated);
    let unseen = maps.iter().map(|maps| maps.unseen).sum();
    warnings.note("a texel is in no photograph, lit: filled from those around it", unseen);
    let empty = estimate.photographs.iter().filter(|photograph| photograph.texels == 0).count();
    warnings.note("a photograph shows no lit part of the model", empty);
    let clipped = estimate.materials.iter().map(MaterialEstimate::clipped).sum();
    warnings.note("a base colour above 1 is clipped: the intensity of the lights may be too small", clipped);
}

fn photographs(transforms: &Transforms, estimate: &MaterialsEstimate) -> Vec<PhotographReport> {
    let frames = transforms.frames.iter().zip(&estimate.photographs);
    let of_frame =
        |(frame, residuals): (&taotie_photometric::Frame, &taotie_photometric::PhotographResiduals)| {
            let (direction, position) = match frame.lamp.place {
                LampPlace::Towards(direction) => (Some(direction.to_array()), None),
                LampPlace::At(position) => (None, Some(position.to_array())),
            };
            PhotographReport {
                name: name_of(&frame.path),
                direction,
                position,
                texels: residuals.texels,
                residual: residuals.relative,
            }
        };
    frames.map(of_frame).collect()
}

/// The written files.
struct Output<'a> {
    args: &'a PhotometricArgs,
    files: &'a FileSet,
    /// The number of materials.
    count: usize,
}

impl Output<'_> {
    fn claim(&self) -> Result<()> {
        self.files.claim_folder(&self.args.output)?;
        let maps = (0..self.count).flat_map(|i| MAPS.map(|name| self.path(i, name)));
        let others = ["model.glb", "report.json"].map(|name| self.args.path(name));
        maps.chain(others).try_for_each(|path| self.files.claim(&path))?;
        Ok(())
    }

    fn prefix(&self, material: usize) -> String {
        if self.count == 1 { String::new() } else { format!("material_{}_", material + 1) }
    }

    fn path(&self, material: usize, name: &str) -> PathBuf {
        self.args.path(&format!("{}{name}", self.prefix(material)))
    }

    fn write_maps(&self, i: usize, maps: &MaterialMaps) -> Result<()> {
        let opaque = maps.base_color.iter().all(|texel| texel[3] == 255);
        let (color, channels) = if opaque { (PngColor::Rgb, 3) } else { (PngColor::Rgba, 4) };
        let codes: Vec<u8> =
            maps.base_color.iter().flat_map(|texel| texel[..channels].iter().copied()).collect();
        let png = |name: &str, color: PngColor, codes: &[u8], encoding: Encoding| {
            let (side, samples) = (maps.side, PngSamples::U8(codes));
            let image = PngImage { width: side, height: side, color, samples, encoding };
            self.files.write_png(&self.path(i, name), &image)
        };
        let [base_color, roughness, metallic, mask, base_color_sigma, sigma] = MAPS;
        png(base_color, color, &codes, Encoding::Srgb)?;
        png(roughness, PngColor::Grey, &maps.roughness, Encoding::Linear)?;
        png(metallic, PngColor::Grey, &maps.metallic, Encoding::Linear)?;
        png(mask, PngColor::Grey, &maps.mask, Encoding::Linear)?;
        self.write_floats(&self.path(i, base_color_sigma), &maps.base_color_sigma)?;
        self.write_floats(&self.path(i, sigma), &maps.sigma)
    }

    fn write_floats(&self, path: &Path, image: &Image) -> Result<()> {
        Ok(self.files.write_image(path, image, &Development::default(), ImageFormat::Exr)?)
    }

    fn report(
        &self,
        (of, maps): (&MaterialEstimate, &MaterialMaps),
        i: usize,
        model: &Model,
    ) -> MaterialReport {
        MaterialReport {
            name: model.material(of.layout.material).name.clone(),
            prefix: self.prefix(i),
            texels: of.texels.len(),
            unseen: maps.unseen,
            samples: of.mean(|texel| texel.samples as f32),
            keeps_metallic: of.has_metallic,
            roughness: of.mean(MaterialEstimate::roughness),
            roughness_sigma: of.mean(MaterialEstimate::roughness_sigma),
            base_color_sigma: of.mean(MaterialEstimate::color_sigma),
            metallic: of.mean(MaterialEstimate::metallic),
        }
    }
}

impl MaterialsReport {
    /// Returns the report as text.
    pub fn text(&self) -> String {
        let count = self.photographs.len();
        let mut text = format!("read       {count} photographs; cameras and lights from {}\n", self.input);
        for material in &self.materials {
            let name = if material.name.is_empty() { "material" } else { &material.name };
            let MaterialReport { texels, unseen, samples, .. } = material;
            let _ = writeln!(
                text,
                "material   {}: {} of {texels} texels seen, by {samples:.1} photographs on average",
                console::plain(name),
                texels - unseen
            );
            let metallic = if material.keeps_metallic { "of the model" } else { "estimated" };
            let _ = writeln!(
                text,
                "           roughness {:.3}, sigma {:.3}; base colour's sigma {:.3}; metallic {:.2}, {metallic}",
                material.roughness, material.roughness_sigma, material.base_color_sigma, material.metallic
            );
        }
        let mut worst: Vec<&PhotographReport> = self.photographs.iter().filter(|of| of.texels > 0).collect();
        worst.sort_by(|a, b| b.residual.total_cmp(&a.residual));
        let worst = worst.iter().take(WORST).map(|of| format!("{} ({:.1} %)", of.name, 100.0 * of.residual));
        let worst: Vec<String> = worst.collect();
        let _ = writeln!(text, "worst      {}: residual relative to the samples", worst.join(", "));
        let prefixes = self.materials.iter().map(|material| material.prefix.as_str());
        let files: Vec<String> =
            prefixes.flat_map(|prefix| MAPS.map(|name| format!("{prefix}{name}"))).collect();
        let _ = write!(
            text,
            "\nwrote {} of {2}x{2}, model.glb and report.json to {}",
            files.join(", "),
            self.output,
            self.side
        );
        text
    }
}
