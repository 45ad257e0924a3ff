//! A photograph: its file and light, and its pixels as linear grey values.

use crate::grey::GreyImage;
use crate::light::Light;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::math::srgb::linear_from_srgb;
use taotie_engine::names::Named;
use taotie_io::{Limits, read_photograph_within};

/// The meaning of the numbers in photographs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum Transfer {
    /// Linear for 16 bits and floats, sRGB for 8 bits.
    #[default]
    Auto,
    /// Proportional to radiance.
    Linear,
    /// Encoded by the sRGB curve.
    Srgb,
}

impl Named for Transfer {
    const WHAT: &'static str = "encoding of photographs";
    const NAMES: &'static [(&'static str, Self)] =
        &[("auto", Self::Auto), ("linear", Self::Linear), ("srgb", Self::Srgb)];
}

impl TryFrom<String> for Transfer {
    type Error = Error;

    fn try_from(name: String) -> Result<Self> {
        Self::from_name(&name)
    }
}

impl From<Transfer> for &'static str {
    fn from(transfer: Transfer) -> Self {
        transfer.name()
    }
}

impl Transfer {
    /// Returns the encoding of photographs with this number of bits.
    pub fn of_bits(self, bits: u8) -> Self {
        match (self, bits) {
            (Self::Auto, 8) => Self::Srgb,
            (Self::Auto, _) => Self::Linear,
            (chosen, _) => chosen,
        }
    }
}

/// A pixel of a photograph: linear grey, the mean of the channels, divided by the light's intensity. The sign bit is
/// set if a channel is saturated; NaN if it is missing, as where the photograph is transparent.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sample(f32);

impl Sample {
    fn new(grey: f64, saturated: bool) -> Self {
        let grey = if grey.is_finite() { (grey.clamp(0.0, 1e12) + 0.0) as f32 } else { f32::NAN };
        Self(if saturated { -grey } else { grey })
    }

    /// Returns the sample of a relit image's colour, in [0, 1] if it can be displayed.
    pub fn displayed(color: [f32; 3], transfer: Transfer) -> Self {
        Self::new(color.map(|v| linear_of_displayed(v, transfer)).iter().sum::<f64>() / 3.0, false)
    }

    /// Returns the sample of a light brighter by a factor.
    pub fn times(self, factor: f64) -> Self {
        Self::new(f64::from(self.0.abs()) * factor, self.is_saturated())
    }

    /// Returns the sample without the unevenness of the light that a white board shows, for lights in a direction with the
    /// cosine `cosine`, l_z; saturated if either is.
    pub fn flattened(self, board: Self, cosine: f64) -> Self {
        let grey = f64::from(self.0.abs()) * flattening(board, cosine);
        Self::new(grey, self.is_saturated() || board.is_saturated())
    }

    /// The linear grey, at least 0; 0 if it is missing.
    #[inline]
    pub fn grey(self) -> f32 {
        self.0.abs().max(0.0)
    }

    /// Returns true if the photograph is transparent there, or has no finite value.
    #[inline]
    pub fn is_missing(self) -> bool {
        self.0.is_nan()
    }

    /// Returns true if the grey is that of the surface: neither saturated nor missing.
    #[inline]
    pub fn is_usable(self) -> bool {
        !self.is_saturated() && !self.is_missing()
    }

    /// Returns true if a channel is saturated: the grey is then a lower bound.
    #[inline]
    pub fn is_saturated(self) -> bool {
        self.0.is_sign_negative() && !self.is_missing()
    }
}

/// Returns the linear light of a channel of a relit image, at least 0.
pub fn linear_of_displayed(v: f32, transfer: Transfer) -> f64 {
    let v = f64::from(v.max(0.0));
    if transfer == Transfer::Linear { v } else { linear_from_srgb(v) }
}

/// Returns the factor of a sample that removes all unevenness of the light, which a white board facing the camera
/// shows, times `cosine`, l_z.
pub fn flattening(board: Sample, cosine: f64) -> f64 {
    let white = f64::from(board.grey());
    if white > 0.0 { cosine.max(0.0) / white } else { 0.0 }
}

/// A photograph and its light.
#[derive(Debug, Clone, PartialEq)]
pub struct Photograph {
    /// The image file.
    pub path: PathBuf,
    /// Its light.
    pub light: Light,
}

/// Reads a photograph as linear grey values.
///
/// # Errors
/// Those of reading an image.
pub fn grey_image(path: &Path, transfer: Transfer, limits: &Limits) -> Result<GreyImage> {
    let bitmap = read_photograph_within(path, limits)?;
    let shape = Shape::of(&bitmap);
    let pixels: Vec<u32> = (0..shape.width * shape.height).collect();
    let samples = Decoder::new((path, shape), &pixels, transfer).samples(path, &bitmap, [1.0; 3])?;
    let values = samples.into_iter().map(Sample::grey).collect();
    Ok(GreyImage { width: shape.width as usize, height: shape.height as usize, values })
}

/// Size and depth of a photograph.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Bits per channel.
    pub bits: u8,
}

impl Shape {
    /// Returns those of a decoded photograph.
    pub fn of(bitmap: &Bitmap) -> Self {
        Self { width: bitmap.width(), height: bitmap.height(), bits: bitmap.bits() }
    }
}

impl std::fmt::Display for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{} pixels of {} bits", self.width, self.height, self.bits)
    }
}

/// Returns the linear value of each code; empty for linear values and floats.
fn curve(transfer: Transfer, bits: u8) -> Vec<f32> {
    let codes = match (transfer, bits) {
        (Transfer::Srgb, 8) => 256,
        (Transfer::Srgb, 16) => 65_536,
        _ => 0,
    };
    (0..codes).map(|code| linear_from_srgb(f64::from(code) / f64::from(codes - 1)) as f32).collect()
}

/// Converts photographs to samples.
pub struct Decoder<'a> {
    /// The first photograph, which determines the shape.
    first: &'a Path,
    shape: Shape,
    /// The pixels to convert.
    pixels: &'a [u32],
    transfer: Transfer,
    /// The linear value of each code, as [`curve`].
    curve: Vec<f32>,
}

impl<'a> Decoder<'a> {
    /// Makes a decoder for photographs of the shape of the first.
    pub fn new((first, shape): (&'a Path, Shape), pixels: &'a [u32], transfer: Transfer) -> Self {
        let transfer = transfer.of_bits(shape.bits);
        Self { first, shape, pixels, transfer, curve: curve(transfer, shape.bits) }
    }

    /// Returns the samples of a photograph's pixels, divided by the light's intensity.
    ///
    /// # Errors
    /// [`Error::Invalid`] if its shape differs from that of the first.
    pub fn samples(&self, path: &Path, bitmap: &Bitmap, intensity: [f64; 3]) -> Result<Vec<Sample>> {
        self.check(path, bitmap)?;
        let factors = intensity.map(|v| 1.0 / (3.0 * v));
        let sample = |i: &u32| {
            let Some((values, saturated)) = self.linear_texel(bitmap, *i as usize) else {
                return Sample::new(f64::NAN, false);
            };
            let grey: f64 = (0..3).map(|c| f64::from(values[c]).max(0.0) * factors[c]).sum();
            Sample::new(grey, saturated)
        };
        Ok(self.pixels.iter().map(sample).collect())
    }

    /// Returns the linear colours of a photograph's pixels, divided by the light's intensity.
    ///
    /// # Errors
    /// As [`Decoder::samples`].
    pub fn colors(&self, path: &Path, bitmap: &Bitmap, intensity: [f64; 3]) -> Result<Vec<[f32; 3]>> {
        self.check(path, bitmap)?;
        let factors = intensity.map(|v| 1.0 / v);
        let color = |i: &u32| {
            let values = self.linear_texel(bitmap, *i as usize).map_or([0.0; 4], |(values, _)| values);
            std::array::from_fn(|c| (f64::from(values[c]).max(0.0) * factors[c]) as f32)
        };
        Ok(self.pixels.iter().map(color).collect())
    }

    /// Rejects a photograph of another shape.
    fn check(&self, path: &Path, bitmap: &Bitmap) -> Result<()> {
        let shape = Shape::of(bitmap);
        if shape != self.shape {
            let why = format!("{} has {}; all photographs must be alike", self.first.display(), self.shape);
            return Err(Error::invalid(format!("{}: {shape}", path.display()), why));
        }
        Ok(())
    }

    /// Returns the linear value of a pixel, and true if a channel is saturated; `None` where it is transparent.
    fn linear_texel(&self, bitmap: &Bitmap, i: usize) -> Option<([f32; 4], bool)> {
        (!is_transparent(bitmap, i)).then(|| match bitmap.texels() {
            Texels::U8(texels) => {
                (self.linear(bitmap, i, texels[i].map(usize::from)), is_full(texels[i], u8::MAX))
            }
            Texels::U16(texels) => {
                (self.linear(bitmap, i, texels[i].map(usize::from)), is_full(texels[i], u16::MAX))
            }
            Texels::F32(texels) if self.transfer == Transfer::Srgb => {
                (texels[i].map(linear_from_float), false)
            }
            Texels::F32(texels) => (texels[i], false),
        })
    }

    fn linear(&self, bitmap: &Bitmap, i: usize, codes: [usize; 4]) -> [f32; 4] {
        if self.curve.is_empty() { bitmap.stored(i) } else { codes.map(|code| self.curve[code]) }
    }
}

/// Returns true if alpha leaves a pixel out.
pub fn is_transparent(bitmap: &Bitmap, i: usize) -> bool {
    matches!(bitmap.channels(), 2 | 4) && bitmap.stored(i)[3] < 0.5
}

fn linear_from_float(encoded: f32) -> f32 {
    linear_from_srgb(encoded.into()) as f32
}

/// Returns a photograph whose texture, with this encoding, holds linear light.
pub fn decodable(bitmap: Bitmap, transfer: Transfer) -> Result<(Bitmap, Encoding)> {
    match (transfer.of_bits(bitmap.bits()), bitmap.texels()) {
        (Transfer::Srgb, Texels::F32(texels)) => {
            let texels = texels.iter().map(|[r, g, b, a]| {
                let [r, g, b] = [*r, *g, *b].map(linear_from_float);
                [r, g, b, *a]
            });
            let texels = Texels::F32(texels.collect());
            let linear = Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), texels)?;
            Ok((linear, Encoding::Linear))
        }
        (Transfer::Srgb, _) => Ok((bitmap, Encoding::Srgb)),
        _ => Ok((bitmap, Encoding::Linear)),
    }
}

/// Returns true if red, green or blue is the largest code.
fn is_full<T: PartialEq + Copy>(texel: [T; 4], most: T) -> bool {
    texel[..3].contains(&most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_linear_light() {
        let decoder = |bits, transfer| {
            let shape = Shape { width: 2, height: 1, bits };
            Decoder::new((Path::new("a.png"), shape), &[0, 1], transfer)
        };
        let path = Path::new("b.png");
        let bytes = Bitmap::new(2, 1, 3, Texels::U8(vec![[128, 128, 128, 255], [255, 0, 0, 255]])).unwrap();
        let read = decoder(8, Transfer::Srgb).samples(path, &bytes, [1.0; 3]).unwrap();
        assert!((read[0].grey() - 0.2158).abs() < 1e-4 && !read[0].is_saturated());
        assert!((read[1].grey() - 1.0 / 3.0).abs() < 1e-6 && read[1].is_saturated());
        let words = Bitmap::new(2, 1, 3, Texels::U16(vec![[32768; 4], [0, 0, 0, 65535]])).unwrap();
        let read = decoder(16, Transfer::Linear).samples(path, &words, [2.0, 2.0, 2.0]).unwrap();
        assert!((read[0].grey() - 0.25).abs() < 1e-4 && read[1] == Sample::new(0.0, false));
        let floats = vec![[0.5, 0.5, 0.5, 1.0], [0.5, 0.5, 0.5, 0.2]];
        let floats = Bitmap::new(2, 1, 4, Texels::F32(floats)).unwrap();
        for (transfer, grey) in [(Transfer::Srgb, 0.2140), (Transfer::Auto, 0.5)] {
            let read = decoder(32, transfer).samples(path, &floats, [1.0; 3]).unwrap();
            assert!((read[0].grey() - grey).abs() < 1e-4, "{transfer:?}: {:?}", read[0]);
            assert!(read[1].is_missing() && !read[1].is_usable() && read[1].grey() == 0.0, "transparent");
            let (bitmap, _) = decodable(floats.clone(), transfer).unwrap();
            assert!((bitmap.stored(0)[0] - grey).abs() < 1e-4);
        }
        let error = decoder(8, Transfer::Srgb).samples(path, &words, [1.0; 3]).unwrap_err().to_string();
        assert!(
            error.contains("b.png: 2x1 pixels of 16 bits") && error.contains("a.png has 2x1 pixels of 8"),
            "{error}"
        );
    }
}
