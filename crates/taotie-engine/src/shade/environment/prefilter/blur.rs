//! Blurs an image of the sphere by a lobe, uniformly everywhere: also near the poles, where pixels are narrow.

use super::lobe::Fisher;
use super::rings::{Areas, Pixel, Rings, accumulate, areas, catmull_rom, polar};
use crate::math::{dispatch_registers, scalar};
use crate::parallel;
use fearless_simd::{Level, Simd, f32x4, f32x16, prelude::*};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Lobes are truncated where exp(−κq) falls below exp(−`REACH`).
const REACH: f64 = 10.0;

/// The minimum number of pixels per ring that are summed; the others are interpolated.
const FEWEST: usize = 8;

/// Blurs images, one after the other, reusing memory.
pub(super) struct Blurring {
    /// The smooth weights of pixels in each row, by the width of an image.
    areas: BTreeMap<usize, Vec<f64>>,
    /// The memory of [`InputRings::twice`], reused between blurs.
    twice: Vec<Pixel>,
}

impl Blurring {
    /// Creates a blur for images of these widths.
    pub(super) fn new(widths: &[usize]) -> Self {
        let smooth = |width: &usize| (*width, areas(*width / 2, &Areas::Smooth));
        Self { areas: widths.iter().map(smooth).collect(), twice: Vec::new() }
    }

    /// The weights of the pixels of an image in each row.
    pub(super) fn areas(&self, input: &Rings) -> &[f64] {
        &self.areas[&input.width]
    }

    /// An image of constant texels, blurred by `lobe`.
    pub(super) fn first(&mut self, input: &Rings, lobe: Fisher) -> Rings {
        let twice = std::mem::take(&mut self.twice);
        let sources = InputRings::new(input, &areas(input.height, &Areas::Solid), 1, twice);
        self.blurred(sources, lobe)
    }

    /// A smooth image blurred by `lobe`, on rings of `width` pixels: its width, or half of it.
    pub(super) fn next(&mut self, input: &Rings, lobe: Fisher, width: usize) -> Rings {
        let twice = std::mem::take(&mut self.twice);
        let sources = InputRings::new(input, self.areas(input), input.width / width, twice);
        self.blurred(sources, lobe)
    }

    fn blurred(&mut self, sources: InputRings, lobe: Fisher) -> Rings {
        let mut output = Rings::black(sources.level, sources.width / sources.ratio);
        let width = output.width;
        parallel::pieces(&mut output.pixels, width, &|y, row| {
            let polar = polar(width / 2, y);
            let stride = stride(width, polar);
            sources.sum(lobe, polar, stride, row);
            fill(row, stride);
        });
        self.twice = sources.twice;
        output
    }
}

/// The stride between the pixels of a ring that are summed: their spacing does not exceed that of the rings.
fn stride(width: usize, polar: f64) -> usize {
    let closeness = 1.0 / scalar::sin(polar);
    let mut stride = 1;
    while width.is_multiple_of(stride * 2) && width >= FEWEST * stride * 2 && (stride * 2) as f64 <= closeness
    {
        stride *= 2;
    }
    stride
}

/// Interpolates smoothly between every `stride`th pixel of a ring.
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
    /// The number of input pixels that an output pixel covers, along a ring.
    ratio: usize,
    /// The sine of half the angle from the centre of the output's first pixel to each pixel.
    turns: Vec<f64>,
    rings: Vec<InputRing>,
    /// The pixels of each ring twice in a row, and some more so that no sum reaches the end.
    twice: Vec<Pixel>,
}

/// A ring of the input.
struct InputRing {
    polar: f64,
    /// The sine of the polar angle.
    sine: f64,
    area: f64,
}

impl InputRings {
    /// Creates them for an output with `ratio` times fewer pixels along a ring; `twice` is overwritten.
    fn new(input: &Rings, areas: &[f64], ratio: usize, mut twice: Vec<Pixel>) -> Self {
        let ring = |y: usize| {
            let polar = input.polar(y);
            InputRing { polar, sine: scalar::sin(polar), area: areas[y] }
        };
        let step = TAU / input.width as f64;
        let turn = |x: usize| scalar::sin((x as f64 - middle(ratio)) * step / 2.0);
        let room = 2 * input.width + NEIGHBOURS;
        if twice.len() != room * input.height {
            twice = vec![[0.0; 4]; room * input.height];
        }
        parallel::pieces(&mut twice, room, &|y, twice| {
            for part in twice.chunks_mut(input.width) {
                part.copy_from_slice(&input.row(y)[..part.len()]);
            }
        });
        Self {
            level: input.level,
            width: input.width,
            ratio,
            turns: (0..input.width).map(turn).collect(),
            rings: (0..input.height).map(ring).collect(),
            twice,
        }
    }

    /// The means around every `stride`th pixel of the ring at `polar`.
    fn sum(&self, lobe: Fisher, polar: f64, stride: usize, row: &mut [Pixel]) {
        let here = [polar, scalar::sin(polar)];
        let near = self.near(lobe, polar);
        let mut parts: Vec<Part<'_>> = near.filter_map(|y| self.part(y, lobe, here)).collect();
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
            // The last block recomputes some instead of being shorter.
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

    /// The indices of all rings that the lobe may reach from the ring at `polar`.
    fn near(&self, lobe: Fisher, polar: f64) -> Range<usize> {
        let reach = 2.0 * scalar::asin((REACH / lobe.kappa / 2.0).sqrt().min(1.0));
        let place = |polar: f64| polar / PI * self.rings.len() as f64;
        // One more on each side; negative numbers become 0.
        let first = (place(polar - reach) - 2.0) as usize;
        let end = (place(polar + reach) + 2.0) as usize;
        first..end.min(self.rings.len())
    }

    /// The part of ring `y` that the lobe reaches from the ring at a polar angle, given with its sine.
    fn part(&self, y: usize, lobe: Fisher, [polar, sine]: [f64; 2]) -> Option<Part<'_>> {
        let ring = &self.rings[y];
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
        // Pixels to the left of the centre have the weight of those as far to the right.
        let mirrored = |x: isize| if x < 0 { self.ratio as isize - 1 - x } else { x };
        let share = |turn: &f64| ring.area * scalar::exp(-lobe.kappa * (nearest + round * turn * turn));
        let count = last.max(mirrored(first)) as usize + 1;
        let right: Vec<f64> = self.turns[..count].iter().map(share).collect();
        let shares = (first..=last).map(|x| right[mirrored(x) as usize]).collect();
        let room = 2 * self.width + NEIGHBOURS;
        let twice = &self.twice[y * room..][..room];
        Some(Part { first, shares, weights: Vec::new(), twice })
    }
}

/// The centre of an output pixel, in input pixels: between two if it covers two.
fn middle(ratio: usize) -> f64 {
    (ratio as f64 - 1.0) / 2.0
}

/// Neighbours in a ring and their weights.
struct Part<'a> {
    /// The first neighbour, relative to the pixel at the output's first pixel.
    first: isize,
    /// The weight of each, before division by the sum of all parts.
    shares: Vec<f64>,
    /// The weights after division.
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

/// The number of sums computed together, of neighbours and of pixels that are apart: each addition depends only on
/// the previous one in its sum.
const NEIGHBOURS: usize = 16;
const APART: usize = FEWEST;
