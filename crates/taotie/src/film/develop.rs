//! Developing a picture: every step between scene-referred light and a file.

use super::ToneCurve;
use super::encode::{round_to_codes, srgb_from_linear};
use super::tone::clamped;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::{Lane, Pack, SimdLevel, Vec3, dispatch_pack, scalar};
use fearless_simd::Level;
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
    developed(image, development, 255.0, |code| code as u8)
}

/// The picture in 16 bits a channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// As [`develop8`].
pub fn develop16(image: &Image, development: &Development) -> Result<Vec<[u16; 4]>> {
    developed(image, development, 65535.0, |code| code as u16)
}

/// One pixel, or a pack: premultiplied linear RGBA in, sRGB and straight alpha in [0, 1] out.
///
/// Colour is divided by alpha, multiplied by `exposure`, taken through the curve, laid over the background in
/// linear light, and encoded. Where alpha is zero, colour is black.
#[inline(always)]
pub fn develop_pixel<L: Lane>(
    [r, g, b, a]: [L; 4],
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
) -> [L; 4] {
    let alpha = a.clamp(0.0, 1.0);
    let zero = a.lit(0.0);
    let straight = Vec3::select(zero.lt(alpha), Vec3::new(r, g, b) / alpha, Vec3::splat(zero));
    let shown = tone.apply(straight * a.lit(f64::from(exposure)));
    let (shown, alpha) = match background {
        Some(under) => {
            let under = Vec3::new(a.lit(under.x.into()), a.lit(under.y.into()), a.lit(under.z.into()));
            (clamped(shown * alpha + under * (a.lit(1.0) - alpha), 1.0), a.lit(1.0))
        }
        None => (shown, alpha),
    };
    [srgb_from_linear(shown.x), srgb_from_linear(shown.y), srgb_from_linear(shown.z), alpha]
}

/// What a band of pixels needs to know.
#[derive(Clone, Copy)]
struct Recipe {
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
    top: f64,
}

impl Recipe {
    fn new(development: &Development, top: f64) -> Result<Self> {
        const MOST_STOPS: f32 = 60.0;
        let stops = development.exposure_stops;
        if !(-MOST_STOPS..=MOST_STOPS).contains(&stops) {
            return Err(Error::invalid(format!("exposure {stops}"), "stops must be from -60 to 60"));
        }
        if let Some(c) = development.background
            && !c.to_array().iter().all(|v| (0.0..=1.0).contains(v))
        {
            let what = format!("background ({}, {}, {})", c.x, c.y, c.z);
            return Err(Error::invalid(what, "each channel must be from 0 to 1"));
        }
        let exposure = scalar::exp2(f64::from(stops)) as f32;
        Ok(Self { exposure, tone: development.tone, background: development.background, top })
    }
}

/// How many pixels one task takes at a time; whole packs.
const BAND: usize = 1024;

fn developed<T: Copy + Default + Send>(
    image: &Image,
    development: &Development,
    top: f64,
    code: impl Fn(f32) -> T + Sync,
) -> Result<Vec<[T; 4]>> {
    let recipe = Recipe::new(development, top)?;
    let level = development.simd.dispatch()?;
    let mut out = vec![[T::default(); 4]; image.pixels().len()];
    out.par_chunks_mut(BAND).zip(image.pixels().par_chunks(BAND)).for_each(|(out, pixels)| {
        let mut codes = [[0.0; 4]; BAND];
        codes[..pixels.len()].copy_from_slice(pixels);
        develop_band(level, &recipe, &mut codes);
        for (out, codes) in out.iter_mut().zip(codes) {
            *out = codes.map(&code);
        }
    });
    Ok(out)
}

/// Turns pixels into codes, still as floats.
fn develop_band(level: Level, recipe: &Recipe, band: &mut [[f32; 4]; BAND]) {
    dispatch_pack!(level, P, token => packs::<P>(token, recipe, band));
}

#[inline(always)]
fn packs<P: Pack>(token: P::Token, recipe: &Recipe, band: &mut [[f32; 4]; BAND]) {
    for pixels in band.chunks_exact_mut(P::LANES) {
        P::store_pixels(pixel_codes(recipe, P::load_pixels(token, pixels)), pixels);
    }
}

#[inline(always)]
fn pixel_codes<L: Lane>(recipe: &Recipe, rgba: [L; 4]) -> [L; 4] {
    let [r, g, b, a] = develop_pixel(rgba, recipe.exposure, recipe.tone, recipe.background);
    let (r, g) = (round_to_codes(r, recipe.top), round_to_codes(g, recipe.top));
    let (b, a) = (round_to_codes(b, recipe.top), round_to_codes(a, recipe.top));
    [r, g, b, a]
}
