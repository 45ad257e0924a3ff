//! Developing a picture: every step between scene-referred light and a file.

use super::ToneCurve;
use super::developer::Developer;
use super::encode::srgb_from_linear;
use super::tone::clamped;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::{Lane, SimdLevel, Vec3};
use rayon::prelude::*;

/// How a picture is developed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Development {
    /// Light is multiplied by two to this power; [−60, 60].
    pub exposure_stops: f32,
    /// How light is fitted into what a screen shows.
    pub tone: ToneCurve,
    /// The colour that is seen where the picture is transparent: linear, display-referred, in [0, 1]. It is laid
    /// under after the tone curve. `None` leaves transparency in the file.
    pub background: Option<Vec3>,
    /// Which SIMD level runs; no level changes a bit.
    pub simd: SimdLevel,
}

/// The picture in 8 bits a channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// [`Error::Invalid`] for an exposure or a background out of range, [`Error::Unsupported`] for a SIMD level that
/// this machine lacks.
pub fn develop8(image: &Image, development: &Development) -> Result<Vec<[u8; 4]>> {
    let mut out = vec![[0; 4]; image.pixels().len()];
    develop8_into(image, development, &mut out)?;
    Ok(out)
}

/// [`develop8`] into memory that is there: `out` has as many pixels as the picture.
///
/// # Errors
/// As [`develop8`], and [`Error::Invalid`] for an `out` of another size.
pub fn develop8_into(image: &Image, development: &Development, out: &mut [[u8; 4]]) -> Result<()> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    if out.len() != pixels.len() {
        let why = format!("it has {} pixels, the picture {}", out.len(), pixels.len());
        return Err(Error::invalid("memory for a developed picture", why));
    }
    let bands = out.par_chunks_mut(BAND).zip(pixels.par_chunks(BAND));
    bands.for_each(|(out, pixels)| developer.codes8(pixels, out));
    Ok(())
}

/// The picture in 16 bits a channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// As [`develop8`].
pub fn develop16(image: &Image, development: &Development) -> Result<Vec<[u16; 4]>> {
    let developer = Developer::new(development)?;
    let mut out = vec![[0; 4]; image.pixels().len()];
    let bands = out.par_chunks_mut(BAND).zip(image.pixels().par_chunks(BAND));
    bands.for_each(|(out, pixels)| developer.codes16(pixels, out));
    Ok(out)
}

/// How many pixels one task takes at a time; whole packs.
const BAND: usize = 4096;

/// One pixel, or a pack: premultiplied linear RGBA in, sRGB and straight alpha in [0, 1] out.
///
/// Colour is divided by alpha, multiplied by `exposure`, taken through the curve, laid over the background in
/// linear light, and encoded. Where alpha is zero, colour is black.
#[inline(always)]
pub fn develop_pixel<L: Lane>(
    rgba: [L; 4],
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
) -> [L; 4] {
    let (light, alpha) = developed_light(rgba, exposure, tone, background);
    [srgb_from_linear(light.x), srgb_from_linear(light.y), srgb_from_linear(light.z), alpha]
}

/// [`develop_pixel`] before it is encoded: display-referred linear light in [0, 1], and alpha.
#[inline(always)]
pub(super) fn developed_light<L: Lane>(
    [r, g, b, a]: [L; 4],
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
) -> (Vec3<L>, L) {
    let alpha = a.clamp(0.0, 1.0);
    let zero = a.lit(0.0);
    let straight = Vec3::select(zero.lt(alpha), Vec3::new(r, g, b) / alpha, Vec3::splat(zero));
    let shown = tone.apply(straight * a.lit(f64::from(exposure)));
    let Some(under) = background else { return (shown, alpha) };
    let under = Vec3::new(a.lit(under.x.into()), a.lit(under.y.into()), a.lit(under.z.into()));
    (clamped(shown * alpha + under * (a.lit(1.0) - alpha), 1.0), a.lit(1.0))
}
