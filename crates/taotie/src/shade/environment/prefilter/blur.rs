//! Blurring an image of the sphere by a lobe, exactly alike everywhere: near the poles too, where pixels are narrow.

use super::lobe::Fisher;
use super::rings::{Pixel, Rings, accumulate, catmull_rom};
use crate::math::{dispatch_registers, scalar};
use crate::parallel;
use fearless_simd::{Level, Simd, f32x4, f32x16, prelude::*};
use std::f64::consts::{PI, TAU};

/// Lobes are cut where exp(−κq) falls below exp(−`REACH`).
const REACH: f64 = 10.0;

/// The fewest pixels of a ring that are summed up; the others lie between them.
const FEWEST: usize = 8;

/// `input` blurred by `lobe`, on rings of `width` pixels, half as many rings. The width is that of `input` or half
/// of it; `areas` are the weights of the input's pixels in each row.
pub(super) fn blur(input: &Rings, areas: &[f64], lobe: Fisher, width: usize) -> Rings {
    let mut output = Rings::black(input.level, width);
    let polars: Vec<f64> = (0..output.height).map(|y| output.polar(y)).collect();
    let sources = InputRings::new(input, areas, input.width / width);
    parallel::pieces(&mut output.pixels, width, &|y, row| {
        let stride = stride(width, polars[y]);
        sources.sum(lobe, polars[y], stride, row);
        fill(row, stride);
    });
    output
}

/// Every how many pixels of a ring one is needed, so that they lie no farther apart than rings do.
fn stride(width: usize, polar: f64) -> usize {
    let closeness = 1.0 / scalar::sin(polar);
    let mut stride = 1;
    while width.is_multiple_of(stride * 2) && width >= FEWEST * stride * 2 && (stride * 2) as f64 <= closeness
    {
        stride *= 2;
    }
    stride
}

/// Puts smooth values between every `stride`th of a ring's pixels.
fn fill(row: &mut [Pixel], stride: usize) {
    let weights: Vec<_> = (1..stride).map(|x| catmull_rom(x as f32 / stride as f32)).collect();
    let count = row.len() / stride;
    for i in (0..count).filter(|_| stride > 1) {
        let known = [i + count - 1, i, i + 1, i + 2].map(|k| row[k % count * stride]);
        for (pixel, weights) in row[i * stride + 1..].iter_mut().zip(&weights) {
            *pixel = [0.0; 4];
            weights.iter().zip(&known).for_each(|(weight, known)| accumulate(pixel, *weight, known));
        }
    }
}

/// The rings of the input.
struct InputRings {
    level: Level,
    width: usize,
    /// The number of its pixels that a pixel of the output covers, along a ring.
    ratio: usize,
    /// The sine of half the turn from the middle of the output's first pixel to each pixel.
    turns: Vec<f64>,
    rings: Vec<InputRing>,
}

/// A ring of the input, twice in a row and a little further so that no sum meets its end.
struct InputRing {
    polar: f64,
    /// The sine of it.
    sine: f64,
    area: f64,
    twice: Vec<Pixel>,
}

impl InputRings {
    fn new(input: &Rings, areas: &[f64], ratio: usize) -> Self {
        let ring = |y: usize| {
            let (row, polar) = (input.row(y), input.polar(y));
            let twice = [row, row, &row[..NEIGHBOURS]].concat();
            InputRing { polar, sine: scalar::sin(polar), area: areas[y], twice }
        };
        let step = TAU / input.width as f64;
        let turn = |x: usize| scalar::sin((x as f64 - middle(ratio)) * step / 2.0);
        Self {
            level: input.level,
            width: input.width,
            ratio,
            turns: (0..input.width).map(turn).collect(),
            rings: parallel::tasks(input.height, &ring),
        }
    }

    /// The means around every `stride`th pixel of the ring at `polar`.
    fn sum(&self, lobe: Fisher, polar: f64, stride: usize, row: &mut [Pixel]) {
        let here = [polar, scalar::sin(polar)];
        let near = self.near(lobe, polar);
        let mut parts: Vec<Part<'_>> = near.iter().filter_map(|ring| self.part(ring, lobe, here)).collect();
        let total: f64 = parts.iter().flat_map(|part| &part.shares).sum();
        for part in &mut parts {
            part.weights = part.shares.iter().map(|share| (share / total) as f32).collect();
        }
        if stride * self.ratio == 1 {
            dispatch_registers!(self.level, simd => self.neighbours(simd, &parts, row));
        } else {
            dispatch_registers!(self.level, simd => self.apart(simd, &parts, row, stride));
        }
    }

    /// The sums around each pixel of a row as wide as the input.
    #[inline(always)]
    fn neighbours<S: Simd>(&self, simd: S, parts: &[Part<'_>], row: &mut [Pixel]) {
        for block in (0..row.len()).step_by(NEIGHBOURS) {
            // The last block takes some anew rather than being shorter.
            let x = block.min(row.len() - NEIGHBOURS);
            let mut sums = [f32x16::splat(simd, 0.0); NEIGHBOURS / 4];
            for part in parts {
                let near = part.from(x, self.width, part.weights.len() + NEIGHBOURS - 1);
                for (weight, near) in part.weights.iter().zip(near.windows(NEIGHBOURS)) {
                    let weight = f32x16::splat(simd, *weight);
                    for (sum, four) in sums.iter_mut().zip(near.as_chunks::<4>().0) {
                        *sum += weight * f32x16::from_slice(simd, four.as_flattened());
                    }
                }
            }
            for (four, sum) in row[x..].as_chunks_mut::<4>().0.iter_mut().zip(sums) {
                sum.store_slice(four.as_flattened_mut());
            }
        }
    }

    /// The sums around every `stride`th pixel of a row.
    #[inline(always)]
    fn apart<S: Simd>(&self, simd: S, parts: &[Part<'_>], row: &mut [Pixel], stride: usize) {
        let count = row.len() / stride;
        for block in (0..count).step_by(APART) {
            let block = block.min(count - APART);
            let mut sums = [f32x4::splat(simd, 0.0); APART];
            for part in parts {
                let mut near = [&[] as &[Pixel]; APART];
                for (i, near) in near.iter_mut().enumerate() {
                    *near = part.from((block + i) * stride * self.ratio, self.width, part.weights.len());
                }
                for (k, weight) in part.weights.iter().enumerate() {
                    let weight = f32x4::splat(simd, *weight);
                    for (sum, near) in sums.iter_mut().zip(&near) {
                        *sum += weight * f32x4::simd_from(simd, near[k]);
                    }
                }
            }
            for (i, sum) in sums.into_iter().enumerate() {
                row[(block + i) * stride] = sum.into();
            }
        }
    }

    /// All rings that the lobe may reach from the ring at `polar`.
    fn near(&self, lobe: Fisher, polar: f64) -> &[InputRing] {
        let reach = 2.0 * scalar::asin((REACH / lobe.kappa / 2.0).sqrt().min(1.0));
        let place = |polar: f64| polar / PI * self.rings.len() as f64;
        // One more on each side, and negative numbers become 0.
        let first = (place(polar - reach) - 2.0) as usize;
        let end = (place(polar + reach) + 2.0) as usize;
        &self.rings[first..end.min(self.rings.len())]
    }

    /// The part of a ring that the lobe reaches from the ring at a polar angle, told with its sine.
    fn part<'a>(&self, ring: &'a InputRing, lobe: Fisher, [polar, sine]: [f64; 2]) -> Option<Part<'a>> {
        let apart = scalar::sin((polar - ring.polar) / 2.0);
        let round = 2.0 * sine * ring.sine;
        // q = 2 sin²(Δθ/2) + 2 sin θ sin θ' sin²(Δφ/2)
        let nearest = 2.0 * apart * apart;
        let left = (REACH / lobe.kappa - nearest) / round;
        if left < 0.0 {
            return None;
        }
        let middle = middle(self.ratio);
        let step = TAU / self.width as f64;
        let reach = if left < 1.0 { 2.0 * scalar::asin(left.sqrt()) / step } else { f64::INFINITY };
        let [first, last] = match reach * 2.0 < self.width as f64 - 2.0 {
            true => [(middle - reach).ceil() as isize, (middle + reach).floor() as isize],
            false => [0, self.width as isize - 1],
        };
        // What lies to the left of the middle has the share of what lies as far to the right.
        let mirrored = |x: isize| if x < 0 { self.ratio as isize - 1 - x } else { x };
        let share = |turn: &f64| ring.area * scalar::exp(-lobe.kappa * (nearest + round * turn * turn));
        let count = last.max(mirrored(first)) as usize + 1;
        let right: Vec<f64> = self.turns[..count].iter().map(share).collect();
        let shares = (first..=last).map(|x| right[mirrored(x) as usize]).collect();
        Some(Part { first, shares, weights: Vec::new(), twice: &ring.twice })
    }
}

/// The middle of an output pixel, in input pixels: of two that it covers it lies between.
fn middle(ratio: usize) -> f64 {
    (ratio as f64 - 1.0) / 2.0
}

/// Neighbours in a ring and their weights.
struct Part<'a> {
    /// The first neighbour, counted from the pixel that the output's first lies on.
    first: isize,
    /// How much each counts, and as part of all.
    shares: Vec<f64>,
    weights: Vec<f32>,
    twice: &'a [Pixel],
}

impl Part<'_> {
    /// `count` neighbours of input pixel `x` of `width`.
    #[inline(always)]
    fn from(&self, x: usize, width: usize, count: usize) -> &[Pixel] {
        let start = x as isize + self.first;
        let start = if start < 0 { (start + width as isize) as usize } else { start as usize };
        let start = if start < width { start } else { start - width };
        &self.twice[start..start + count]
    }
}

/// The numbers of sums taken at once, of neighbours and of pixels that lie apart: additions wait for the last of their
/// own sum only.
const NEIGHBOURS: usize = 16;
const APART: usize = FEWEST;
