//! Development from scene-referred light to a file's code values: exposure, tone curve, background, sRGB, rounding. The
//! settings, the formula for a pixel, and every step between an image's light and a file, pack by pack.

mod curves;

pub use curves::{ToneCurve, aces, agx, linear, neutral, reinhard, round_to_codes, srgb_from_linear};

use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::srgb::{Codes, in_low_bits};
use crate::math::{Lane, Mask, Pack, SimdLevel, Vec3, dispatch_pack, scalar};
use crate::parallel;
use curves::{SRGB_CODES, clamped};
use fearless_simd::Level;

/// The settings for developing an image.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Development {
    /// The exponent of two by which light is multiplied; [−60, 60].
    pub exposure_stops: f32,
    /// The curve that compresses light into the range of a display.
    pub tone: ToneCurve,
    /// The colour behind transparent parts of the image: linear, display-referred, in [0, 1]. It is composited after
    /// the tone curve. `None` keeps transparency in the file.
    pub background: Option<Vec3>,
    /// The SIMD level; it never changes a bit.
    pub simd: SimdLevel,
}

/// Develops one pixel, or a pack: from premultiplied linear RGBA to sRGB and straight alpha in [0, 1].
///
/// Colour is divided by alpha, multiplied by `exposure`, mapped through the curve, composited over the background in
/// linear light, and encoded. If alpha is zero, colour is black.
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
fn developed_light<L: Lane>(
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

/// Returns the image with 8 bits per channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// [`Error::Invalid`] for an exposure or a background out of range, [`Error::Unsupported`] for a SIMD level that this
/// machine lacks.
pub fn develop8(image: &Image, development: &Development) -> Result<Vec<[u8; 4]>> {
    let mut out = vec![[0; 4]; image.pixels().len()];
    develop8_into(image, development, &mut out)?;
    Ok(out)
}

/// Like [`develop8`], into existing memory: `out` has as many pixels as the image.
///
/// # Errors
/// As for [`develop8`], and [`Error::Invalid`] for an `out` of another size.
pub fn develop8_into(image: &Image, development: &Development, out: &mut [[u8; 4]]) -> Result<()> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    if out.len() != pixels.len() {
        let why = format!("it has {} pixels; the image has {}", out.len(), pixels.len());
        return Err(Error::invalid("output buffer", why));
    }
    parallel::pieces(out, BAND, &|i, band| developer.codes8(&pixels[i * BAND..][..band.len()], band));
    Ok(())
}

/// Returns the image with 16 bits per channel: sRGB, straight alpha, row by row from the top.
///
/// # Errors
/// As for [`develop8`].
pub fn develop16(image: &Image, development: &Development) -> Result<Vec<[u16; 4]>> {
    let developer = Developer::new(development)?;
    let pixels = image.pixels();
    let mut out = vec![[0; 4]; pixels.len()];
    parallel::pieces(&mut out, BAND, &|i, band| developer.codes16(&pixels[i * BAND..][..band.len()], band));
    Ok(out)
}

/// The number of pixels per task; whole packs.
const BAND: usize = 4096;

/// A [`Development`] prepared for any number of pixels, in pieces of any size.
#[derive(Debug, Clone, Copy)]
pub struct Developer {
    level: Level,
    recipe: Recipe,
}

impl Developer {
    /// Validates a development once.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an exposure or a background out of range, [`Error::Unsupported`] for a SIMD level that
    /// this machine lacks.
    pub fn new(development: &Development) -> Result<Self> {
        Ok(Self { level: development.simd.dispatch()?, recipe: Recipe::new(development)? })
    }

    /// Converts premultiplied linear RGBA to 8 bits per channel: sRGB and straight alpha. Pixels of `out` beyond
    /// those of `pixels` are unchanged.
    pub fn codes8(&self, pixels: &[[f32; 4]], out: &mut [[u8; 4]]) {
        dispatch_pack!(self.level, P, token => all_codes::<P, u8>(token, &self.recipe, pixels, out));
    }

    /// Like [`Self::codes8`], with 16 bits per channel.
    pub fn codes16(&self, pixels: &[[f32; 4]], out: &mut [[u16; 4]]) {
        dispatch_pack!(self.level, P, token => all_codes::<P, u16>(token, &self.recipe, pixels, out));
    }
}

/// The settings for a pack of pixels.
#[derive(Debug, Clone, Copy)]
struct Recipe {
    exposure: f32,
    tone: ToneCurve,
    background: Option<Vec3>,
}

impl Recipe {
    fn new(development: &Development) -> Result<Self> {
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
        Ok(Self { exposure, tone: development.tone, background: development.background })
    }

    /// The displayed light, in [0, 1], and alpha.
    #[inline(always)]
    fn light<L: Lane>(&self, rgba: [L; 4]) -> (Vec3<L>, L) {
        developed_light(rgba, self.exposure, self.tone, self.background)
    }

    /// [`Self::light`] if alpha is 1 or more: nothing to divide by, and no background visible.
    #[inline(always)]
    fn opaque_light<L: Lane>(&self, [r, g, b, _]: [L; 4]) -> Vec3<L> {
        self.tone.apply(Vec3::new(r, g, b) * r.lit(f64::from(self.exposure)))
    }
}

/// The number of pixels developed before their codes are looked up: whole packs at any level.
const RUN: usize = 64;

/// A run of pixels, channel by channel: prepared light, and the codes of alpha.
type Columns = [[f32; RUN]; 4];

/// Code values of some depth.
trait Code: Copy + Default {
    /// The code of one.
    const TOP: Self;
    /// Prepares light in [0, 1], so that [`Self::of`] finds its code.
    fn prepared<L: Lane>(light: L) -> L;
    /// The code of prepared light.
    fn of(prepared: f32) -> Self;
    /// Prepares an alpha in [0, 1], so that [`Self::of_alpha`] finds its code.
    fn prepared_alpha<L: Lane>(alpha: L) -> L;
    /// The code of a prepared alpha.
    fn of_alpha(prepared: f32) -> Self;
}

impl Code for u8 {
    const TOP: Self = Self::MAX;
    #[inline(always)]
    fn prepared<L: Lane>(light: L) -> L {
        Codes::bounded(light)
    }
    #[inline(always)]
    fn of(prepared: f32) -> Self {
        SRGB_CODES.of(prepared)
    }
    #[inline(always)]
    fn prepared_alpha<L: Lane>(alpha: L) -> L {
        in_low_bits(round_to_codes(alpha, 255.0))
    }
    #[inline(always)]
    fn of_alpha(prepared: f32) -> Self {
        prepared.to_bits() as Self
    }
}

impl Code for u16 {
    const TOP: Self = Self::MAX;
    #[inline(always)]
    fn prepared<L: Lane>(light: L) -> L {
        in_low_bits(round_to_codes(srgb_from_linear(light), 65535.0))
    }
    #[inline(always)]
    fn of(prepared: f32) -> Self {
        prepared.to_bits() as Self
    }
    #[inline(always)]
    fn prepared_alpha<L: Lane>(alpha: L) -> L {
        in_low_bits(round_to_codes(alpha, 65535.0))
    }
    #[inline(always)]
    fn of_alpha(prepared: f32) -> Self {
        prepared.to_bits() as Self
    }
}

#[inline(always)]
fn all_codes<P: Pack, C: Code>(token: P::Token, recipe: &Recipe, pixels: &[[f32; 4]], out: &mut [[C; 4]]) {
    let count = pixels.len().min(out.len());
    let runs = count - count % RUN;
    let mut columns = [[0.0; RUN]; 4];
    let nothing = prepared::<P, C>(recipe.light([P::splat(token, 0.0); 4]));
    let runner = Runner { token, recipe, nothing };
    for (pixels, out) in pixels[..runs].chunks_exact(RUN).zip(out.chunks_exact_mut(RUN)) {
        let kind = runner.develop::<C>(pixels, &mut columns);
        store_codes(kind, &columns, out);
    }
    if runs < count {
        let mut last = [[0.0; 4]; RUN];
        last[..count - runs].copy_from_slice(&pixels[runs..count]);
        let kind = runner.develop::<C>(&last, &mut columns);
        store_codes(kind, &columns, &mut out[runs..count]);
    }
}

/// The kind of pixels in a run.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Transparent,
    Opaque,
    Mixed,
}

/// Develops runs of pixels.
struct Runner<'r, P: Pack> {
    token: P::Token,
    recipe: &'r Recipe,
    /// The values of fully transparent pixels.
    nothing: [P; 4],
}

impl<P: Pack> Runner<'_, P> {
    /// Fills `columns` for [`RUN`] pixels. Images are largely fully transparent or fully opaque, and both are
    /// cheaper.
    #[inline(always)]
    fn develop<C: Code>(&self, pixels: &[[f32; 4]], columns: &mut Columns) -> Kind {
        let (mut some_seen, mut all_opaque) = (false, true);
        for (i, pixels) in pixels.chunks_exact(P::LANES).enumerate() {
            let rgba = P::load_pixels(self.token, pixels);
            let alpha = rgba[3];
            let is_seen = alpha.lit(0.0).lt(alpha).any();
            let is_opaque = !alpha.lit(1.0).le(alpha).not().any();
            let prepared = if is_opaque {
                let light = self.recipe.opaque_light(rgba);
                prepared::<P, C>((light, alpha.lit(1.0)))
            } else if is_seen {
                prepared::<P, C>(self.recipe.light(rgba))
            } else {
                self.nothing
            };
            let [r, g, b, a] = prepared;
            let [reds, greens, blues, alphas] = &mut *columns;
            let at = i * P::LANES;
            r.store(&mut reds[at..]);
            g.store(&mut greens[at..]);
            b.store(&mut blues[at..]);
            a.store(&mut alphas[at..]);
            some_seen |= is_seen;
            all_opaque &= is_opaque;
        }
        if all_opaque {
            Kind::Opaque
        } else if some_seen {
            Kind::Mixed
        } else {
            Kind::Transparent
        }
    }
}

#[inline(always)]
fn prepared<L: Lane, C: Code>((light, alpha): (Vec3<L>, L)) -> [L; 4] {
    [C::prepared(light.x), C::prepared(light.y), C::prepared(light.z), C::prepared_alpha(alpha)]
}

#[inline(always)]
fn store_codes<C: Code>(kind: Kind, columns: &Columns, out: &mut [[C; 4]]) {
    let [r, g, b, a] = columns;
    match kind {
        Kind::Transparent => {
            out.fill([C::of(r[0]), C::of(g[0]), C::of(b[0]), C::of_alpha(a[0])]);
        }
        Kind::Opaque => {
            for (i, out) in out.iter_mut().enumerate().take(RUN) {
                *out = [C::of(r[i]), C::of(g[i]), C::of(b[i]), C::TOP];
            }
        }
        Kind::Mixed => {
            for (i, out) in out.iter_mut().enumerate().take(RUN) {
                *out = [C::of(r[i]), C::of(g[i]), C::of(b[i]), C::of_alpha(a[i])];
            }
        }
    }
}
