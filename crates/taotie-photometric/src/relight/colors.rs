//! Photographs in colour, as they are displayed.

use crate::light::place;
use crate::photograph::{Decoder, Shape, flattening};
use crate::samples::{Reading, flats};
use crate::set::PhotographSet;
use std::path::PathBuf;
use taotie_engine::error::Result;
use taotie_engine::math::Vec3;
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::{Progress, parallel};
use taotie_io::{Limits, read_photograph_within};

/// Photographs that are decoded at the same time.
pub const BATCH: usize = 4;

/// Steps of linear light with an encoded value.
const STEPS: usize = 1 << 16;

/// Reads photographs in colour, encoded by the sRGB curve. Differences between the lights are removed: their
/// intensities, and the fall-off of near lamps.
pub struct ColorReader<'a> {
    set: &'a PhotographSet,
    reading: Reading<'a>,
    shape: Shape,
    /// The numbers of all pixels.
    pixels: Vec<u32>,
    /// Photographs of a white board under each light.
    flats: Option<Vec<PathBuf>>,
    lights: Vec<Vec3<f64>>,
    /// The encoded value of each step of linear light.
    encoded: Vec<f32>,
    /// The linear light that is white.
    white: f64,
}

impl<'a> ColorReader<'a> {
    /// Prepares to read the photographs of a set, with all their pixels. `white` is the linear light that is displayed as
    /// white; photographs of 8 bits keep their brightness.
    ///
    /// # Errors
    /// Those of reading the first photograph.
    pub fn new(set: &'a PhotographSet, reading: &Reading<'a>, white: f64) -> Result<Self> {
        let first = &set.photographs[0].path;
        let shape = Shape::of(&read_photograph_within(first, &reading.limits)?);
        let encode = |step: usize| srgb_from_linear(step as f64 / (STEPS - 1) as f64) as f32;
        Ok(Self {
            set,
            reading: *reading,
            shape,
            pixels: (0..shape.width * shape.height).collect(),
            flats: reading.flat.map(|folder| flats(folder, set)).transpose()?,
            lights: set.photographs.iter().map(|photograph| photograph.light.direction).collect(),
            encoded: parallel::collect(STEPS, encode),
            white: if shape.bits == 8 { 1.0 } else { white.max(f64::MIN_POSITIVE) },
        })
    }

    /// How much brighter the colours are than the photographs: 1 for photographs of 8 bits.
    pub fn exposure(&self) -> f64 {
        1.0 / self.white
    }

    /// Width and height of the photographs.
    pub fn size(&self) -> (u32, u32) {
        (self.shape.width, self.shape.height)
    }

    /// The unit vector towards each light, from the picture's centre.
    pub fn lights(&self) -> &[Vec3<f64>] {
        &self.lights
    }

    /// The limits of memory.
    pub fn limits(&self) -> &Limits {
        &self.reading.limits
    }

    /// Calls `work` with the number and the colours of each photograph, in order; colours are in [0, 1].
    ///
    /// # Errors
    /// Those of reading photographs, [`taotie_engine::Error::Cancelled`].
    pub fn each(&self, progress: Progress<'_>, work: &mut dyn FnMut(usize, &[[f32; 3]])) -> Result<()> {
        let count = self.lights.len();
        for first in (0..count).step_by(BATCH) {
            progress.at(first as f64 / count as f64)?;
            let read = parallel::try_tasks(BATCH.min(count - first), &|i| self.colors(first + i))?;
            read.iter().enumerate().for_each(|(i, colors)| work(first + i, colors));
        }
        Ok(())
    }

    /// Returns the colours of a photograph.
    fn colors(&self, k: usize) -> Result<Vec<[f32; 3]>> {
        let photograph = &self.set.photographs[k];
        let bitmap = read_photograph_within(&photograph.path, &self.reading.limits)?;
        let factors = self.factors(k)?;
        let mut colors = self.decoder().colors(&photograph.path, &bitmap, photograph.light.intensity)?;
        let last = (STEPS - 1) as f64;
        for (i, color) in colors.iter_mut().enumerate() {
            let factor = factors.get(i).copied().unwrap_or(1.0) / self.white * last;
            // Casting saturates at 0.
            *color = color.map(|v| self.encoded[((f64::from(v) * factor + 0.5) as usize).min(STEPS - 1)]);
        }
        Ok(colors)
    }

    fn decoder(&self) -> Decoder<'_> {
        let first = &self.set.photographs[0].path;
        Decoder::new((first, self.shape), &self.pixels, self.reading.transfer)
    }

    /// Returns the factor of each pixel that removes differences between the lights; empty if there are none.
    fn factors(&self, k: usize) -> Result<Vec<f64>> {
        let light = &self.set.photographs[k].light;
        let size = [self.shape.width, self.shape.height].map(|side| side as usize);
        let lit = |i: usize| light.at(place([i % size[0], i / size[0]], size));
        if let Some(path) = self.flats.as_ref().map(|flats| &flats[k]) {
            let bitmap = read_photograph_within(path, &self.reading.limits)?;
            let board = self.decoder().samples(path, &bitmap, light.intensity)?;
            return Ok(parallel::collect(board.len(), |i| flattening(board[i], lit(i).direction.z)));
        }
        let count = if light.position.is_some() { size[0] * size[1] } else { 0 };
        Ok(parallel::collect(count, |i| lit(i).falloff))
    }
}
