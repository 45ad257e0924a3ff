//! Filters an environment's light by the lobes of rough mirrors.
//!
//! The lobe of GGX has a sharp peak and a long tail, so a direct sum would be long for every texel. But it is a sum
//! of Gaussians a factor of √2 apart in width ([`lobe::Ggx::share`]). So the image is blurred once by each narrow
//! Gaussian, one after the other and on coarser and coarser rings ([`blur`]), and the remainder of a lobe is so
//! smooth that spherical harmonics of a low degree represent it exactly ([`harmonics`]). A level is the weighted sum
//! of these. The weights are those of the lobe's Legendre coefficients, so all light is conserved.

mod blur;
mod harmonics;
mod lobe;
mod rings;

use super::equirect::{Equirect, uv_of_lanes};
use super::levels::{Levels, Octahedron, RoughnessLevel, alphas, direction_of, middle};
use crate::math::{MOST_LANES, Pack, SimdLevel, dispatch_pack, dispatch_registers, integration};
use crate::parallel;
use blur::Blurring;
use fearless_simd::{Level, Simd};
use harmonics::{Grid, Harmonics};
use lobe::{Coefficients, Fisher, Ggx};
use rings::{Pixel, Rings, accumulate, on_rings};
use std::f64::consts::{SQRT_2, TAU};

/// The degree up to which light is kept as spherical harmonics.
const DEGREE: usize = 64;

/// The widest Gaussian of the blurred images, in radians: the next has nothing left above [`DEGREE`].
const WIDEST: f64 = 0.075;

/// The narrowest Gaussian, in rings.
const NARROWEST: f64 = 0.5;

/// The minimum width, in rings, of a Gaussian that they can represent, and for the coarsest rings, from which rough
/// levels are computed.
const SHOWN: [f64; 2] = [1.4, 1.9];

/// From this α upwards, the smooth remainder is computed on half as many rings.
const WIDE: f64 = 0.15;

/// Smaller weights of a lobe are skipped.
const LEAST: f32 = 1e-6;

/// Levels are `TEXELS`/α texels wide, at least `FEWEST_TEXELS`, and at most `MOST_TEXELS` times a ring's pixels; the
/// first of each for α below `SHARP`, with large levels, the second above. Between texels light is linear: an
/// isolated bright point is reproduced within 0.8 % of its lobe's peak below, 0.3 % above.
const SHARP: f64 = 0.039;
const TEXELS: [f64; 2] = [14.0, 24.0];
const MOST_TEXELS: [f64; 2] = [0.625, 1.2];
const FEWEST_TEXELS: f64 = 64.0;

/// The light of an image at each roughness.
pub(super) fn levels(picture: &Equirect) -> Levels {
    levels_at(SimdLevel::fastest(), picture)
}

fn levels_at(simd: Level, picture: &Equirect) -> Levels {
    let scales = Scales::new(simd, picture);
    let (mut places, mut spare) = (Places::default(), Vec::new());
    let level = |alpha: f64| {
        let smooth = usize::from(alpha >= SHARP);
        let most = scales.widths[0] as f64 * MOST_TEXELS[smooth];
        let side = (TEXELS[smooth] / alpha).min(most).max(FEWEST_TEXELS) as usize;
        if places.side != side {
            places = Places::new(simd, side);
        }
        let sum = scales.sum(Ggx::new(alpha), std::mem::take(&mut spare));
        let map = Octahedron::new(side, |y, row| {
            dispatch_registers!(simd, simd => sum.row(simd, places.row(y), row));
        });
        spare = sum.rings.pixels;
        RoughnessLevel { alpha: alpha as f32, map }
    };
    Levels(alphas().into_iter().map(level).collect())
}

/// The image at all scales.
struct Scales<'a> {
    picture: &'a Equirect,
    /// The number of pixels per ring, for each size of image, finest first.
    widths: Vec<usize>,
    blurred: Vec<Scale>,
    /// The harmonics of the image blurred like `reference`.
    harmonics: Harmonics,
    reference: usize,
    /// The grids for evaluating harmonics: as fine as `reference`, and half as fine.
    grids: [Grid; 2],
    /// The nodes and weights for integrating lobes.
    rule: Vec<(f64, f64)>,
}

/// A blurred image.
struct Scale {
    lobe: Fisher,
    rings: Rings,
    /// The product of the coefficients of all blurs so far.
    coefficients: Coefficients,
}

impl<'a> Scales<'a> {
    fn new(simd: Level, picture: &'a Equirect) -> Self {
        let base = on_rings(simd, picture);
        let coarser = |width: &usize| (width.is_multiple_of(2) && width / 2 >= 256).then_some(width / 2);
        let widths: Vec<usize> = std::iter::successors(Some(base.width), coarser).collect();
        let coarsest = widths[widths.len() - 1];
        let shown =
            |width: usize, sigma: f64| sigma > TAU / width as f64 * SHOWN[usize::from(width == coarsest)];
        let mut blurring = Blurring::new(&widths);
        let mut blurred: Vec<Scale> = Vec::new();
        let mut sigma = NARROWEST * base.step();
        while sigma < WIDEST {
            let width = widths.iter().rfind(|width| shown(**width, sigma)).unwrap_or(&base.width);
            let next = match blurred.last() {
                Some(last) if sigma > base.step() * 1.1 => {
                    Scale::after(last, Fisher::of_width(sigma), *width, &mut blurring)
                }
                _ => Scale::first(&base, Fisher::of_width(sigma), &mut blurring),
            };
            blurred.push(next);
            sigma *= SQRT_2;
        }
        let reference = blurred.iter().position(|scale| shown(coarsest, scale.lobe.width()));
        let reference = reference.unwrap_or(blurred.len() - 1);
        let rings = &blurred[reference].rings;
        let grids = [rings.width, rings.width / 2].map(|width| Grid::new(width, DEGREE));
        let harmonics = Harmonics::new(rings, blurring.areas(rings), &grids[0]);
        let rule = integration::gauss_legendre(64);
        Self { picture, widths, blurred, harmonics, reference, grids, rule }
    }

    /// The image filtered by a lobe; `spare` pixels are overwritten.
    fn sum(&self, lobe: Ggx, mut spare: Vec<Pixel>) -> Sum<'a> {
        let finer = (1..).map(|n| lobe.share(self.blurred[0].lobe.kappa * f64::from(1u32 << n)));
        let sharp: f64 = finer.take(24).sum();
        let mut rest = lobe.coefficients(DEGREE, &self.rule);
        rest.iter_mut().for_each(|rest| *rest -= sharp);
        let shares: Vec<f64> = self.blurred.iter().map(|scale| lobe.share(scale.lobe.kappa)).collect();
        for (scale, share) in self.blurred.iter().zip(&shares) {
            rest.iter_mut().zip(&scale.coefficients).for_each(|(rest, c)| *rest -= share * c);
        }
        let reference = &self.blurred[self.reference];
        rest.iter_mut().zip(&reference.coefficients).for_each(|(rest, c)| *rest /= c);
        let mut rings = self.harmonics.rings(&rest, &self.grids[usize::from(lobe.alpha() >= WIDE)]);
        for width in self.widths.iter().rev() {
            let here = self.blurred.iter().zip(&shares).filter(|(scale, _)| scale.rings.width == *width);
            let here =
                here.map(|(scale, share)| (*share as f32, &scale.rings)).filter(|(share, _)| *share > LEAST);
            let here: Vec<_> = here.collect();
            if !here.is_empty() {
                rings = rings.added(&here, *width, &mut spare);
            }
        }
        Sum { picture: self.picture, sharp: sharp as f32, rings }
    }
}

impl Scale {
    fn first(base: &Rings, lobe: Fisher, blurring: &mut Blurring) -> Self {
        Self { lobe, rings: blurring.first(base, lobe), coefficients: lobe.coefficients(DEGREE) }
    }

    fn after(narrower: &Self, lobe: Fisher, width: usize, blurring: &mut Blurring) -> Self {
        let step = lobe.after(narrower.lobe);
        let rings = blurring.next(&narrower.rings, step, width);
        let both = narrower.coefficients.iter().zip(step.coefficients(DEGREE));
        Self { lobe, rings, coefficients: both.map(|(a, b)| a * b).collect() }
    }
}

/// A filtered image: a smooth one, and a fraction of the image itself.
struct Sum<'a> {
    picture: &'a Equirect,
    sharp: f32,
    rings: Rings,
}

impl Sum<'_> {
    /// Writes the light at each position.
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, [u, v]: [&[f32]; 2], row: &mut [[f32; 3]]) {
        let mut sums = [[0.0; 4]; MOST_LANES];
        for (i, colors) in row.chunks_mut(MOST_LANES).enumerate() {
            let (u, v) = (&u[i * MOST_LANES..], &v[i * MOST_LANES..]);
            self.rings.cubic(simd, [u, v], &mut sums);
            for (i, (color, sum)) in colors.iter_mut().zip(&mut sums).enumerate() {
                if self.sharp > LEAST {
                    let light = self.picture.radiance_at([u[i], v[i]]);
                    accumulate(sum, self.sharp, &[light.x, light.y, light.z, 0.0]);
                }
                *color = [sum[0].max(0.0), sum[1].max(0.0), sum[2].max(0.0)];
            }
        }
    }
}

/// The positions in the image of the texels of a map.
#[derive(Default)]
struct Places {
    side: usize,
    /// Row by row, their u, then their v, each padded to whole packs.
    rows: Vec<f32>,
}

impl Places {
    fn new(simd: Level, side: usize) -> Self {
        let room = side.next_multiple_of(MOST_LANES);
        let middles: Vec<f32> = (0..room).map(|i| middle(side, i)).collect();
        let mut rows = vec![0.0; 2 * room * side];
        parallel::pieces(&mut rows, 2 * room, &|y, row| {
            dispatch_pack!(simd, P, token => fill_row::<P>(token, &middles, y, row));
        });
        Self { side, rows }
    }

    fn row(&self, y: usize) -> [&[f32]; 2] {
        let room = self.side.next_multiple_of(MOST_LANES);
        let (u, v) = self.rows[2 * room * y..][..2 * room].split_at(room);
        [u, v]
    }
}

/// Writes the positions of the texels of row `y`, whose centres are at these coordinates.
#[inline(always)]
fn fill_row<P: Pack>(token: P::Token, middles: &[f32], y: usize, row: &mut [f32]) {
    let down = P::splat(token, middles[y]);
    let (u, v) = row.split_at_mut(middles.len());
    for i in (0..middles.len()).step_by(P::LANES) {
        let [left, top] = uv_of_lanes(direction_of([P::load(token, &middles[i..]), down]));
        left.store(&mut u[i..]);
        top.store(&mut v[i..]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn each_simd_level_gives_the_same_bits() {
        let mut image = Image::new(300, 150, [0.25, 0.5, 2.0, 1.0]).unwrap();
        for (i, pixel) in image.pixels_mut().iter_mut().enumerate().step_by(97) {
            *pixel = [i as f32 / 50.0, 1000.0 / (i + 1) as f32, (i % 300) as f32, 1.0];
        }
        let picture = Equirect::new(&image);
        let at = |level: &SimdLevel| levels_at(level.dispatch().unwrap(), &picture);
        let all: Vec<Levels> = SimdLevel::available().iter().map(at).collect();
        assert!(all.iter().all(|levels| *levels == all[0]));
    }
}
