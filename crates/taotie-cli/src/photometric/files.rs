//! The files that `taotie photometric` writes.

use std::path::Path;
use taotie_engine::compare::ColorMap;
use taotie_engine::film::Development;
use taotie_engine::image::{Encoding, Image};
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::scene::Scene;
use taotie_engine::{Result, Warnings};
use taotie_io::{FileSet, ImageFormat, PngColor, PngImage, PngSamples};
use taotie_photometric::{Estimate, Estimator, PhotometricOptions, Relief};
use taotie_report::heat_map::HeatMap;

/// Writes the files of an estimate, without its reports.
pub struct Output<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// The side of a pixel and its unit, if they are known.
    pub options: &'a PhotometricOptions,
    /// The set that the files belong to.
    pub files: &'a FileSet,
    /// Normals, uncertainty and albedo.
    pub estimate: &'a Estimate,
    /// Heights.
    pub relief: &'a Relief,
}

impl Output<'_> {
    /// Writes all files, and returns warnings about the GLBs.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write(&self) -> Result<Warnings> {
        self.write_normals()?;
        let sigma = self.estimate.image(|_, best| {
            let [larger, smaller] =
                best.covariance.eigenvalues().map(|variance| variance.sqrt().to_degrees());
            [best.sigma_deg, larger, smaller]
        });
        self.write_floats("sigma.exr", &sigma)?;
        self.write_sigma()?;
        self.write_floats("residual.exr", &self.estimate.image(|_, best| [best.residual; 3]))?;
        self.write_color("albedo.png", &albedo_codes(self.estimate))?;
        self.write_color("base_color.png", &self.estimate.base_color_codes())?;
        self.write_grey("roughness.png", &self.estimate.roughness_codes(), Encoding::Linear)?;
        let mut warnings = Warnings::default();
        let plane = taotie_io::encode_scene(&self.plane()?, &["plane".to_owned()], &mut warnings)?;
        self.files.write_bytes(&self.folder.join("plane.glb"), &plane)?;
        self.write_floats("depth.exr", &self.relief.image(self.options.pixel_size.unwrap_or(1.0)))?;
        let surface = self.estimate.surface(self.relief, self.options.side_in_models())?;
        warnings.note(
            "no four neighbouring pixels have a normal: relief.glb holds the flat rectangle",
            usize::from(surface.is_none()),
        );
        let surface = surface.map_or_else(|| self.plane(), Ok)?;
        let relief = taotie_io::encode_scene(&surface, &["relief".to_owned()], &mut warnings)?;
        self.files.write_bytes(&self.folder.join("relief.glb"), &relief)?;
        Ok(warnings)
    }

    /// Returns the rectangle in its size, if that is known in metres; otherwise its longer side is 1.
    fn plane(&self) -> Result<Scene> {
        let pixels = f64::from(self.estimate.width().max(self.estimate.height()));
        self.estimate.plane(self.options.unit.map_or(1.0, |_| pixels * self.options.side_in_models()))
    }

    fn write_normals(&self) -> Result<()> {
        let normals = self.estimate.normals(Estimator::Best);
        self.write_floats("normals.exr", &normals)?;
        let codes = self.estimate.normal_codes();
        let image = PngImage {
            width: normals.width(),
            height: normals.height(),
            color: PngColor::Rgba,
            samples: PngSamples::U16(codes.as_flattened()),
            encoding: Encoding::Linear,
        };
        self.files.write_png(&self.folder.join("normals.png"), &image)?;
        let has_normal = |pixel: &[f32; 4]| if pixel[3] > 0.0 { 255 } else { 0 };
        let mask: Vec<u8> = normals.pixels().iter().map(has_normal).collect();
        self.write_grey("mask.png", &mask, Encoding::Linear)
    }

    fn write_floats(&self, name: &str, image: &Image) -> Result<()> {
        let path = self.folder.join(name);
        self.files.write_image(&path, image, &Development::default(), ImageFormat::Exr)
    }

    /// Writes colours in sRGB, as grey if the photographs are.
    fn write_color(&self, name: &str, codes: &[[u8; 3]]) -> Result<()> {
        if !self.estimate.has_color() {
            let codes: Vec<u8> = codes.iter().map(|[code, ..]| *code).collect();
            return self.write_grey(name, &codes, Encoding::Srgb);
        }
        self.write_codes(name, (PngColor::Rgb, codes.as_flattened()), Encoding::Srgb)
    }

    fn write_grey(&self, name: &str, codes: &[u8], encoding: Encoding) -> Result<()> {
        self.write_codes(name, (PngColor::Grey, codes), encoding)
    }

    fn write_codes(&self, name: &str, (color, codes): (PngColor, &[u8]), encoding: Encoding) -> Result<()> {
        let (width, height) = (self.estimate.width(), self.estimate.height());
        let image = PngImage { width, height, color, samples: PngSamples::U8(codes), encoding };
        self.files.write_png(&self.folder.join(name), &image)
    }

    /// Writes the uncertainty as colours; the last is for the 95th percentile.
    fn write_sigma(&self) -> Result<()> {
        let field = self.estimate.sigma()?;
        let top = field.summary().map_or(1.0, |summary| summary.p95 as f32).max(1e-3);
        // Narrow pictures have room for little.
        let title = "sigma";
        let map = HeatMap { field: &field, title, unit: "°", map: ColorMap::Viridis, top }.with_scale();
        self.files.write_png(&self.folder.join("sigma.png"), &map.png())
    }
}

/// Returns the 99th percentile of the albedo in its brightest channel, which is displayed as white.
pub fn white(estimate: &Estimate) -> f64 {
    let albedos = estimate.albedos();
    let brightest = |pixel: &[f32; 4]| f64::from(pixel[0].max(pixel[1]).max(pixel[2]));
    let with_normal = albedos.pixels().iter().filter(|pixel| pixel[3] > 0.0);
    let mut sorted: Vec<f64> = with_normal.map(brightest).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

/// Returns the albedo in sRGB, relative to white.
pub fn albedo_codes(estimate: &Estimate) -> Vec<[u8; 3]> {
    let white = white(estimate);
    let code = |v: f32| (srgb_from_linear((f64::from(v) / white).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
    estimate.albedos().pixels().iter().map(|pixel| [pixel[0], pixel[1], pixel[2]].map(code)).collect()
}
