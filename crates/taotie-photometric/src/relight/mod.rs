//! Relightable images: each pixel's brightness as a function of the light's direction, fitted to photographs.
//!
//! Files of three kinds are written and read: polynomial texture maps (`.ptm`), hemispherical harmonics (`.rti`), and
//! the folders of images that web viewers load (`info.json`). Their values are for display, thus encoded by the sRGB
//! curve like photographs of 8 bits.

mod basis;
mod colors;
mod fit;
mod header;
mod plane;
mod ptm;
mod quality;
mod rti;
#[cfg(test)]
mod tests;
mod web;

pub use basis::Basis;
pub use colors::ColorReader;
pub use plane::Plane;
pub use quality::Quality;

use fit::Projection;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::{Progress, parallel};
use taotie_io::{Bytes, FileBytes, Limits, file_size, read_bytes};

/// How colours follow from coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorModel {
    /// Each channel has its own coefficients.
    Rgb,
    /// One brightness for all channels, times a colour that does not depend on the light.
    Lrgb,
}

impl Named for ColorModel {
    const WHAT: &'static str = "colour model";
    const NAMES: &'static [(&'static str, Self)] = &[("rgb", Self::Rgb), ("lrgb", Self::Lrgb)];
}

/// A relightable image. Values for display are in [0, 1] and beyond, with 1 as white.
#[derive(Debug, Clone, PartialEq)]
pub struct Relightable {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The functions of the light.
    pub basis: Basis,
    /// How colours follow from them.
    pub colors: ColorModel,
    /// The coefficients, rows from top to bottom. RGB: red, green and blue of each term. LRGB: the three channels of the
    /// colour, then each term.
    pub planes: Vec<Plane>,
}

/// A kind of file for relightable images.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RelightFormat {
    /// A polynomial texture map of a colour and a brightness.
    Ptm,
    /// A polynomial texture map of three channels: twice the size, for objects with coloured highlights.
    PtmRgb,
    /// Hemispherical harmonics of three channels.
    Rti,
    /// A folder of JPEG images with `info.json`, for web viewers.
    Web,
}

impl Named for RelightFormat {
    const WHAT: &'static str = "relightable format";
    const NAMES: &'static [(&'static str, Self)] =
        &[("ptm", Self::Ptm), ("ptm-rgb", Self::PtmRgb), ("rti", Self::Rti), ("openlime", Self::Web)];
}

/// Pixels of a task.
const PIECE: usize = 4096;

/// Bytes of a pixel and photograph while coefficients are fitted: three floats.
const COLOR: u64 = 12;

/// Returns unit vectors towards the lights by which a relightable image becomes photographs: a spiral around the view.
pub fn lights_of_relit() -> Vec<Vec3<f64>> {
    /// Lights.
    const COUNT: usize = 40;
    /// z of the highest and the lowest light. Of 0.2 to 0.75, 0.3 gave the smallest errors of normals.
    const Z: [f64; 2] = [0.95, 0.3];
    /// The golden angle (Vogel 1979).
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let light = |k: usize| {
        let z = Z[0] + (Z[1] - Z[0]) * (k as f64 + 0.5) / COUNT as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), GOLDEN * k as f64);
        Vec3::new(r * scalar::cos(angle), r * scalar::sin(angle), z)
    };
    (0..COUNT).map(light).collect()
}

impl RelightFormat {
    /// The functions of the light for a number of photographs. Numbers of terms are those with which each photograph is
    /// predicted best from the others (docs/photometric.md); web viewers know at most 9.
    pub fn basis(self, photographs: usize) -> Basis {
        match (self, photographs) {
            (Self::Ptm | Self::PtmRgb, _) => Basis::Ptm,
            (_, ..26) => Basis::Hsh(1),
            (Self::Rti, 60..) => Basis::Hsh(3),
            _ => Basis::Hsh(2),
        }
    }

    /// How colours are stored.
    pub fn colors(self) -> ColorModel {
        match self {
            Self::Ptm => ColorModel::Lrgb,
            Self::PtmRgb | Self::Rti | Self::Web => ColorModel::Rgb,
        }
    }

    /// Returns the files of a relightable image, with `path` as the name of the file or folder.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a JPEG cannot be as wide or high.
    pub fn files(self, image: &Relightable, path: &Path) -> Result<Vec<FileBytes>> {
        let one = |bytes| vec![FileBytes { path: path.to_path_buf(), bytes }];
        match self {
            Self::Ptm | Self::PtmRgb => Ok(one(ptm::encode(image))),
            Self::Rti => Ok(one(rti::encode(image))),
            Self::Web => web::encode(image, path),
        }
    }

    /// Returns an image as its files hold it: JPEG changes it a little.
    ///
    /// # Errors
    /// None that can occur for files of [`RelightFormat::files`].
    pub fn held(self, image: Relightable, files: &[FileBytes]) -> Result<Relightable> {
        if self == Self::Web { web::written(files) } else { Ok(image) }
    }
}

impl Relightable {
    /// Returns true for the name of a file of a relightable image: `.ptm`, `.rti` or `info.json`.
    pub fn is_named(path: &Path) -> bool {
        let has = |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
        has("ptm") || has("rti") || path.file_name().is_some_and(|name| name == web::INFO)
    }

    /// Returns the description of a web viewer's images in a folder, if it has one.
    pub fn of_folder(folder: &Path) -> Option<std::path::PathBuf> {
        Some(folder.join(web::INFO)).filter(|path| path.is_file())
    }

    /// Reads a `.ptm` or `.rti` file, or the images described by an `info.json`.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Parse`] if a file is damaged; [`Error::Unsupported`] for other kinds of coefficients;
    /// [`Error::Limit`].
    pub fn open(path: &Path, limits: &Limits) -> Result<Self> {
        /// The file and its planes.
        const COPIES: u64 = 3;
        let what = || path.display().to_string();
        limits.check(what(), Bytes(file_size(path)?.saturating_mul(COPIES)))?;
        let bytes = read_bytes(path)?;
        match bytes.as_slice() {
            [b'P', b'T', b'M', ..] => ptm::decode(&bytes, path),
            [b'{', ..] => web::decode(&bytes, path, limits),
            _ if path.file_name().is_some_and(|name| name == web::INFO) => web::decode(&bytes, path, limits),
            _ => rti::decode(&bytes, path),
        }
    }

    /// The number of pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Returns true if there are no pixels, which no reader accepts.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the colours of all pixels under a light, given as a unit vector towards it.
    pub fn relit(&self, light: Vec3<f64>) -> Vec<[f32; 3]> {
        let weights = self.basis.weights(light);
        let first = if self.colors == ColorModel::Lrgb { 3 } else { 0 };
        let weight = |plane: usize| match self.colors {
            ColorModel::Rgb => weights[plane / 3],
            ColorModel::Lrgb => weights.get(plane.wrapping_sub(first)).copied().unwrap_or(1.0),
        };
        let tables: Vec<[f32; 256]> =
            self.planes.iter().enumerate().map(|(i, plane)| plane.table(weight(i))).collect();
        let value = |plane: usize, pixel: usize| tables[plane][usize::from(self.planes[plane].codes[pixel])];
        let mut pixels = vec![[0.0; 3]; self.len()];
        parallel::pieces(&mut pixels, PIECE, &|piece, pixels| {
            for (i, color) in pixels.iter_mut().enumerate() {
                let pixel = piece * PIECE + i;
                match self.colors {
                    ColorModel::Rgb => {
                        (0..self.planes.len()).for_each(|plane| color[plane % 3] += value(plane, pixel));
                    }
                    ColorModel::Lrgb => {
                        let grey: f32 = (3..self.planes.len()).map(|plane| value(plane, pixel)).sum();
                        *color = std::array::from_fn(|channel| grey * value(channel, pixel));
                    }
                }
            }
        });
        pixels
    }
}

/// Coefficients as numbers: those of red, green and blue of each term.
#[derive(Debug, Clone)]
pub struct Coefficients {
    width: u32,
    height: u32,
    basis: Basis,
    projection: Projection,
    planes: Vec<Vec<f32>>,
}

impl Coefficients {
    /// Fits a basis to photographs.
    ///
    /// # Errors
    /// Those of reading them; [`Error::Limit`], [`Error::Cancelled`].
    pub fn fit(photographs: &ColorReader, basis: Basis, progress: Progress<'_>) -> Result<Self> {
        let (width, height) = photographs.size();
        let pixels = u64::from(width) * u64::from(height);
        let what = format!("coefficients of {width}x{height} pixels");
        let bytes = pixels * (basis.terms() as u64 * COLOR * 2 + colors::BATCH as u64 * (COLOR + 16));
        photographs.limits().check(what, Bytes(bytes))?;
        let projection = Projection::new(basis, photographs.lights());
        let mut planes = vec![vec![0.0_f32; pixels as usize]; 3 * basis.terms()];
        photographs.each(progress, &mut |k, colors| {
            let factors = &projection.factors[k];
            for (plane, sums) in planes.iter_mut().enumerate() {
                let (factor, channel) = (factors[plane / 3] as f32, plane % 3);
                parallel::pieces(sums, PIECE, &|piece, sums| {
                    let colors = &colors[piece * PIECE..];
                    sums.iter_mut().zip(colors).for_each(|(sum, color)| *sum += factor * color[channel]);
                });
            }
        })?;
        Ok(Self { width, height, basis, projection, planes })
    }

    /// Stores the coefficients in 8 bits.
    pub fn stored(&self, colors: ColorModel) -> Relightable {
        let planes = match colors {
            ColorModel::Rgb => {
                let terms = self.planes.chunks(3);
                terms.flat_map(|channels| Plane::quantised(&channels.iter().collect::<Vec<_>>())).collect()
            }
            ColorModel::Lrgb => self.factored(),
        };
        Relightable { width: self.width, height: self.height, basis: self.basis, colors, planes }
    }

    /// Returns each pixel's coefficients as a colour times a brightness: the product that is closest over the lights.
    fn factored(&self) -> Vec<Plane> {
        let (count, terms) = (self.planes[0].len(), self.basis.terms());
        let values = parallel::collect(count, |i| {
            let channels: [Vec<f64>; 3] = std::array::from_fn(|channel| {
                (0..terms).map(|term| f64::from(self.planes[3 * term + channel][i])).collect()
            });
            self.factored_pixel(&channels)
        });
        let plane = |k: usize| values.iter().map(|value| value[k]).collect::<Vec<f32>>();
        let color = (0..3).map(|channel| Plane::of_colors(&plane(channel)));
        color.chain((0..terms).flat_map(|term| Plane::quantised(&[&plane(3 + term)]))).collect()
    }

    /// Returns the colour and then the coefficients of the brightness, at most 16 of them, of one pixel. The colour is
    /// that under the brightest light, so that brightness is at most about 1.
    fn factored_pixel(&self, channels: &[Vec<f64>; 3]) -> [f32; 19] {
        /// Steps of alternating least squares; coefficients of a matt surface agree after one.
        const STEPS: usize = 3;
        let terms = channels[0].len();
        let mut color = [1.0_f64; 3];
        let mut grey = vec![0.0; terms];
        for _ in 0..STEPS {
            let square: f64 = color.iter().map(|v| v * v).sum::<f64>().max(1e-12);
            for (term, grey) in grey.iter_mut().enumerate() {
                *grey = (0..3).map(|c| channels[c][term] * color[c]).sum::<f64>() / square;
            }
            let square = self.projection.mean_product(&grey, &grey).max(1e-12);
            color = std::array::from_fn(|c| {
                (self.projection.mean_product(&channels[c], &grey) / square).max(0.0)
            });
        }
        let most = color.iter().fold(0.0_f64, |most, v| most.max(*v));
        let peak = self.projection.peak(&grey);
        let scale = (most * peak).clamp(0.0, 1.0) / most.max(1e-12);
        let mut values = [0.0; 19];
        for (value, color) in values.iter_mut().zip(color) {
            *value = (color * scale) as f32;
        }
        for (value, grey) in values[3..].iter_mut().zip(grey) {
            *value = if scale > 0.0 { (grey / scale) as f32 } else { 0.0 };
        }
        values
    }
}

/// Rejects sizes that no image of ours may have. `at` is the place in the file.
fn check_size(path: &Path, at: &str, [width, height]: [u64; 2]) -> Result<[u32; 2]> {
    /// The longest side, pixels.
    const SIDE: u64 = 1 << 16;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h))
            if (1..=SIDE).contains(&width) && (1..=SIDE).contains(&height) && w.checked_mul(h).is_some() =>
        {
            Ok([w, h])
        }
        _ => Err(Error::parse(
            path,
            at,
            format!("invalid size {width}x{height}: the sides are 1 to {SIDE} pixels"),
        )),
    }
}
