//! The pixels of all photographs within the mask, in linear light.

use crate::light::{self, Light, near, place};
use crate::photograph::{Decoder, Photograph, Sample, Shape, Transfer, linear_of_displayed};
use crate::relight::Relightable;
use crate::set::PhotographSet;
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Bitmap;
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, parallel};
use taotie_io::{Bytes, Limits, read_photograph_within};

/// The samples of all photographs.
#[derive(Debug, Clone)]
pub struct Samples {
    /// Width of the photographs in pixels.
    pub width: u32,
    /// Height of the photographs in pixels.
    pub height: u32,
    /// The numbers of the pixels within the mask, row by row, in order.
    pub pixels: Vec<u32>,
    /// For each photograph the samples of these pixels.
    pub images: Vec<Vec<Sample>>,
    /// For each photograph the unit vector towards its light, from the picture's centre.
    pub lights: Vec<Vec3<f64>>,
    /// For each photograph the place of its lamp if it is near, as in [`crate::Light::position`].
    pub positions: Vec<Option<Vec3<f64>>>,
    /// Bits per channel of the photographs.
    pub bits: u8,
    /// The encoding of the photographs: linear or sRGB.
    pub transfer: Transfer,
    /// `true` if they are made from a relightable image, which smooths highlights: no reflection is fitted.
    pub is_relit: bool,
    /// For each photograph the intensity of its light.
    pub(crate) intensities: Vec<[f64; 3]>,
    /// The same photographs in colour.
    pub(crate) source: ColorSource,
}

/// Photographs in colour.
#[derive(Debug, Clone)]
pub enum ColorSource {
    /// Files, and the limits of reading them.
    Files(Vec<PathBuf>, Limits),
    /// Decoded photographs.
    Bitmaps(Vec<Bitmap>),
    /// An image that is relit by each light.
    Relightable(Relightable),
}

/// The most pixels of all photographs together, so that indices and sums stay exact.
const MOST_SAMPLES: u64 = 1 << 36;

/// How to read photographs.
#[derive(Debug, Clone, Copy)]
pub struct Reading<'a> {
    /// The mask, instead of the set's: white inside.
    pub mask: Option<&'a Path>,
    /// The encoding of the photographs.
    pub transfer: Transfer,
    /// A folder with a photograph of a flat white board under each light, of the same names: samples are divided by it.
    pub flat: Option<&'a Path>,
    /// Limits of memory and image sizes.
    pub limits: Limits,
}

impl Samples {
    /// Estimates the memory of reading and estimating a set: reads its first photograph and its mask. Returns it with the
    /// number of samples.
    ///
    /// # Errors
    /// Those of reading these images.
    pub fn need(set: &PhotographSet, reading: &Reading<'_>) -> Result<(Bytes, u64)> {
        let shape = Self::shape(set, reading)?;
        let pixels = match set.mask_or(reading.mask) {
            Some(path) => mask_pixels(path, shape, &reading.limits)?.len(),
            None => shape.width as usize * shape.height as usize,
        };
        let count = set.photographs.len();
        Ok((Bytes(estimated_bytes(count, pixels, shape)), pixels as u64 * count as u64))
    }

    fn shape(set: &PhotographSet, reading: &Reading<'_>) -> Result<Shape> {
        Ok(match &set.relightable {
            Some(image) => Shape { width: image.width, height: image.height, bits: 8 },
            None => Shape::of(&read_photograph_within(&set.photographs[0].path, &reading.limits)?),
        })
    }

    /// Reads all photographs of a set.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Parse`] and [`Error::Unsupported`] for images that cannot be read, [`Error::Invalid`]
    /// if sizes or depths differ or the mask is empty, [`Error::Limit`], [`Error::Cancelled`].
    pub fn read(set: &PhotographSet, reading: &Reading, progress: Progress<'_>) -> Result<Self> {
        let first = &set.photographs[0].path;
        let shape = Self::shape(set, reading)?;
        let mask = match set.mask_or(reading.mask) {
            Some(path) => mask_pixels(path, shape, &reading.limits)?,
            None => (0..shape.width * shape.height).collect(),
        };
        let size = [shape.width as usize, shape.height as usize];
        let pixel = |i: u32| [i % shape.width, i / shape.width].map(|v| v as usize);
        let is_ball = |i: &u32| set.balls.iter().any(|ball| ball.holds(pixel(*i), BORDER));
        let mask: Vec<u32> = mask.into_iter().filter(|i| !is_ball(i)).collect();
        if mask.is_empty() {
            return Err(Error::invalid("an empty mask", "the balls cover all of it"));
        }
        if let (Some(folder), Some(_)) = (reading.flat, &set.relightable) {
            let what = format!("{}: photographs of a white board", folder.display());
            return Err(Error::invalid(
                what,
                "a relightable image cannot be divided by them; leave them out",
            ));
        }
        let flats = reading.flat.map(|folder| flats(folder, set)).transpose()?;
        let count = set.photographs.len();
        let what = format!("{count} photographs of {}x{}", shape.width, shape.height);
        if mask.len() as u64 * count as u64 > MOST_SAMPLES {
            return Err(Error::limit(what, "use a mask, or scale the photographs down"));
        }
        let need = estimated_bytes(count, mask.len(), shape);
        reading.limits.check(what, Bytes(need))?;
        let transfer = reading.transfer.of_bits(shape.bits);
        let decoder = Decoder::new((first, shape), &mask, transfer);
        let done = std::sync::atomic::AtomicUsize::new(0);
        let images = parallel::try_tasks(count, &|i| {
            let photograph = &set.photographs[i];
            let light = &photograph.light;
            if let Some(image) = &set.relightable {
                let relit = image.relit(light.direction);
                progress.at(i as f64 / count as f64)?;
                return Ok(mask.iter().map(|i| Sample::displayed(relit[*i as usize], transfer)).collect());
            }
            let bitmap = read_photograph_within(&photograph.path, &reading.limits)?;
            let mut samples = decoder.samples(&photograph.path, &bitmap, light.intensity)?;
            let lit = |i: usize| light.at(place(pixel(mask[i]), size));
            if let Some(flats) = &flats {
                let board = read_photograph_within(&flats[i], &reading.limits)?;
                // Both contain the light's intensity.
                let board = decoder.samples(&flats[i], &board, light.intensity)?;
                check_flat(&flats[i], &board)?;
                for (i, (sample, board)) in samples.iter_mut().zip(board).enumerate() {
                    *sample = sample.flattened(board, lit(i).direction.z);
                }
            } else if light.position.is_some() {
                samples.iter_mut().enumerate().for_each(|(i, sample)| *sample = sample.times(lit(i).falloff));
            }
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            progress.at(done as f64 / count as f64)?;
            Ok(samples)
        })?;
        let lights = set.photographs.iter().map(|photograph| photograph.light.direction).collect();
        let positions = set.photographs.iter().map(|photograph| photograph.light.position).collect();
        let Shape { width, height, bits } = shape;
        let paths = set.photographs.iter().map(|photograph| photograph.path.clone());
        Ok(Self {
            width,
            height,
            pixels: mask,
            images,
            lights,
            positions,
            bits,
            transfer,
            is_relit: set.relightable.is_some(),
            intensities: set.photographs.iter().map(|photograph| photograph.light.intensity).collect(),
            source: match &set.relightable {
                Some(image) => ColorSource::Relightable(image.clone()),
                None => ColorSource::Files(paths.collect(), reading.limits),
            },
        })
    }

    /// Takes the samples of photographs in memory. Lights are distant; the mask is white inside.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the lights do not determine normals, sizes or depths differ, or the mask is empty.
    pub fn of(
        photographs: Vec<Bitmap>,
        lights: &[Light],
        mask: Option<&Bitmap>,
        transfer: Transfer,
    ) -> Result<Self> {
        light::check(lights, "lights")?;
        if photographs.len() != lights.len() {
            let why = format!("there are {} lights; expected one for each", lights.len());
            return Err(Error::invalid(format!("{} images", photographs.len()), why));
        }
        let shape = Shape::of(&photographs[0]);
        let pixels = match mask {
            Some(mask) => not_empty(white_of(mask, shape, "mask")?, "mask")?,
            None => (0..shape.width * shape.height).collect(),
        };
        let transfer = transfer.of_bits(shape.bits);
        let first = Path::new("images[0]");
        let decoder = Decoder::new((first, shape), &pixels, transfer);
        let images = parallel::try_tasks(photographs.len(), &|i| {
            decoder.samples(format!("images[{i}]").as_ref(), &photographs[i], lights[i].intensity)
        })?;
        let Shape { width, height, bits } = shape;
        Ok(Self {
            width,
            height,
            pixels,
            images,
            positions: vec![None; lights.len()],
            bits,
            transfer,
            is_relit: false,
            intensities: lights.iter().map(|light| light.intensity).collect(),
            lights: lights.iter().map(|light| light.direction).collect(),
            source: ColorSource::Bitmaps(photographs),
        })
    }

    /// Returns the unit vector from a pixel of the mask towards a light.
    #[inline]
    pub fn direction(&self, light: usize, pixel: usize) -> Vec3<f64> {
        match self.positions[light] {
            None => self.lights[light],
            Some(position) => {
                let i = self.pixels[pixel];
                let pixel = [i % self.width, i / self.width].map(|v| v as usize);
                near(position, place(pixel, [self.width as usize, self.height as usize])).direction
            }
        }
    }

    /// Returns the name of a photograph's file, or of the array that it is.
    pub fn name(&self, k: usize) -> String {
        match &self.source {
            ColorSource::Files(paths, _) => {
                paths[k].file_name().unwrap_or_default().to_string_lossy().into_owned()
            }
            _ => format!("images[{k}]"),
        }
    }

    /// Returns true if a lamp is near, so that its direction depends on the pixel.
    pub fn is_near(&self) -> bool {
        self.positions.iter().any(Option::is_some)
    }

    /// Notes samples that are left out, and lamps where none can be.
    pub fn note(&self, warnings: &mut Warnings) {
        warnings.note("a saturated sample is left out", self.saturated());
        let corner = 0.5 * f64::from(self.width).hypot(f64::from(self.height));
        let within = self.positions.iter().flatten().filter(|lamp| lamp.length() < corner);
        warnings.note(
            "a lamp is closer to the picture's centre than a corner is: with the size of a pixel, the lights in the .lp file must \
             be positions in its unit",
            within.count(),
        );
    }

    /// Returns the linear colours of a photograph's pixels, relative to its light; `None` if it has no colour.
    pub(crate) fn colors(&self, k: usize) -> Result<Option<Vec<[f32; 3]>>> {
        let decoded = |path: &Path, bitmap: &Bitmap| {
            let shape = Shape { width: self.width, height: self.height, bits: self.bits };
            let decoder = Decoder::new((path, shape), &self.pixels, self.transfer);
            let colors = || decoder.colors(path, bitmap, self.intensities[k]);
            (bitmap.channels() > 2).then(colors).transpose()
        };
        match &self.source {
            ColorSource::Files(paths, limits) => {
                decoded(&paths[k], &read_photograph_within(&paths[k], limits)?)
            }
            ColorSource::Bitmaps(bitmaps) => decoded(Path::new("images"), &bitmaps[k]),
            ColorSource::Relightable(image) => {
                let relit = image.relit(self.lights[k]);
                let color =
                    |i: &u32| relit[*i as usize].map(|v| linear_of_displayed(v, self.transfer) as f32);
                Ok(Some(self.pixels.iter().map(color).collect()))
            }
        }
    }

    /// The number of samples that are saturated.
    pub fn saturated(&self) -> usize {
        parallel::fold(self.images.len(), |sum: &mut usize, i| {
            *sum += self.images[i].iter().filter(|sample| sample.is_saturated()).count();
        })
        .into_iter()
        .sum()
    }
}

/// Pixels around a chrome ball that are not estimated.
const BORDER: f64 = 2.0;

/// Returns the photographs of a white board, in the order of the set.
pub fn flats(folder: &Path, set: &PhotographSet) -> Result<Vec<std::path::PathBuf>> {
    let names = crate::folder::Folder::read(folder)?;
    let of = |photograph: &Photograph| {
        let name = photograph.path.file_name().unwrap_or_default().to_string_lossy();
        names.photograph(&name).map_err(|why| Error::invalid("a flat field", why))
    };
    set.photographs.iter().map(of).collect()
}

/// The largest fraction of a white board's pixels that may be saturated.
const MOST_SATURATED: f64 = 0.05;

/// Rejects a photograph of a white board that is too bright.
fn check_flat(path: &Path, board: &[Sample]) -> Result<()> {
    let saturated = board.iter().filter(|sample| sample.is_saturated()).count();
    if saturated as f64 <= MOST_SATURATED * board.len() as f64 {
        return Ok(());
    }
    let what =
        format!("{}: {saturated} of {} pixels of the white board are saturated", path.display(), board.len());
    Err(Error::invalid(what, "expose it less, so that its brightness can be measured"))
}

/// Returns the memory for reading and estimating: samples, one decoded photograph for each thread, and results.
fn estimated_bytes(photographs: usize, pixels: usize, shape: Shape) -> u64 {
    /// The program itself, and the report page.
    const PROGRAM: u64 = 48 << 20;
    /// Surfaces, estimates, covariances, heights and files of a pixel.
    const RESULTS: u64 = 1000;
    /// A decoded pixel with the decoder's own copy.
    const DECODED: u64 = 24;
    let threads = taotie_io::most_threads().unwrap_or(16).min(photographs) as u64;
    let area = u64::from(shape.width) * u64::from(shape.height);
    PROGRAM
        + photographs as u64 * pixels as u64 * 4
        + pixels as u64 * RESULTS
        + area * (DECODED * threads + 32)
}

/// Returns the white pixels of a mask's file, possibly none.
pub(crate) fn white_pixels(path: &Path, shape: Shape, limits: &Limits) -> Result<Vec<u32>> {
    white_of(&read_photograph_within(path, limits)?, shape, &path.display().to_string())
}

fn mask_pixels(path: &Path, shape: Shape, limits: &Limits) -> Result<Vec<u32>> {
    not_empty(white_pixels(path, shape, limits)?, &path.display().to_string())
}

/// Returns the white pixels of a mask; `name` is that of the mask in errors.
fn white_of(mask: &Bitmap, shape: Shape, name: &str) -> Result<Vec<u32>> {
    if (mask.width(), mask.height()) != (shape.width, shape.height) {
        let what = format!("{name}: a mask of {}x{}", mask.width(), mask.height());
        let why = format!("the photographs have {}x{}; they must be the same", shape.width, shape.height);
        return Err(Error::invalid(what, why));
    }
    Ok((0..shape.width * shape.height).filter(|i| is_inside(mask.stored(*i as usize))).collect())
}

fn not_empty(pixels: Vec<u32>, name: &str) -> Result<Vec<u32>> {
    match pixels.is_empty() {
        true => Err(Error::invalid(format!("{name}: an empty mask"), "pixels to estimate must be white")),
        false => Ok(pixels),
    }
}

fn is_inside([red, green, blue, alpha]: [f32; 4]) -> bool {
    red.max(green).max(blue) > 0.5 && alpha > 0.5
}
