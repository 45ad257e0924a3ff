//! Converts maps between stored codes and the numbers they represent, as OpenEXR stores them.

use super::textures::Range;
use crate::error::Result;
use crate::image::{Bitmap, Texels};
use crate::math::srgb::linear_from_srgb;

/// The meaning of a map's codes, [0, 1].
#[derive(Debug, Clone, Copy)]
pub(super) enum Meaning {
    /// Unit vectors n as (n + 1) / 2.
    Direction,
    /// Colour as sRGB; alpha unchanged.
    Color,
    /// Numbers between the values of black and white.
    Number(Range),
    /// The numbers themselves.
    Plain,
}

impl Meaning {
    fn number(self, code: f32) -> f32 {
        match self {
            Self::Direction => code * 2.0 - 1.0,
            Self::Color => linear_from_srgb(f64::from(code)) as f32,
            Self::Number(Range { black, white, .. }) => (black + f64::from(code) * (white - black)) as f32,
            Self::Plain => code,
        }
    }
}

/// Returns the bytes of an OpenEXR file with the numbers of a map.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported) without the feature `exr`.
pub(super) fn encoded(bitmap: &Bitmap, meaning: Meaning) -> Result<Vec<u8>> {
    let channels = if matches!(bitmap.channels(), 2 | 4) { 4 } else { 3 };
    let texels = (bitmap.width() * bitmap.height()) as usize;
    let mut samples = Vec::with_capacity(texels * channels);
    for texel in (0..texels).map(|i| bitmap.stored(i)) {
        samples.extend(texel[..3].iter().map(|code| meaning.number(*code)));
        samples.extend(&texel[3..channels]);
    }
    exr([bitmap.width(), bitmap.height()], &["R", "G", "B", "A"][..channels], &samples)
}

#[cfg(feature = "exr")]
fn exr([width, height]: [u32; 2], channels: &[&str], samples: &[f32]) -> Result<Vec<u8>> {
    crate::io::encode_exr((width, height), &[crate::io::ExrLayer { name: "", channels, samples }])
}

#[cfg(not(feature = "exr"))]
fn exr(_: [u32; 2], _: &[&str], _: &[f32]) -> Result<Vec<u8>> {
    Err(crate::Error::needs_feature("maps as OpenEXR", "exr"))
}

/// Returns a map of unit vectors as codes: floats store the vectors themselves.
///
/// # Errors
/// None: the size does not change.
pub(super) fn codes_of_normals(bitmap: Bitmap) -> Result<Bitmap> {
    let Texels::F32(texels) = bitmap.texels() else { return Ok(bitmap) };
    let code = |[x, y, z, a]: &[f32; 4]| {
        let [x, y, z] = [*x, *y, *z].map(|v| v * 0.5 + 0.5);
        [x, y, z, *a]
    };
    let codes = Texels::F32(texels.iter().map(code).collect());
    Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), codes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_what_they_stand_for() {
        let range = Range { black: -1.0, white: 3.0, unit: "model units" };
        let numbers = [Meaning::Direction, Meaning::Color, Meaning::Number(range), Meaning::Plain];
        assert_eq!(numbers.map(|meaning| meaning.number(1.0)), [1.0, 1.0, 3.0, 1.0]);
        assert_eq!(numbers.map(|meaning| meaning.number(0.0)), [-1.0, 0.0, -1.0, 0.0]);
        assert!((Meaning::Color.number(0.5) - 0.214).abs() < 1e-3);
    }

    #[test]
    fn vectors_become_codes_again() {
        let vectors = Texels::F32(vec![[1.0, -1.0, 0.0, 1.0]]);
        let codes = codes_of_normals(Bitmap::new(1, 1, 3, vectors).unwrap()).unwrap();
        assert_eq!(codes.stored(0)[..3], [1.0, 0.0, 0.5]);
        let stored = Bitmap::new(1, 1, 3, Texels::U8(vec![[255, 0, 128, 255]])).unwrap();
        assert_eq!(codes_of_normals(stored.clone()).unwrap().stored(0), stored.stored(0));
    }
}
