//! Blurring an image of the sphere by a lobe, exactly alike everywhere: near the poles too, where pixels are narrow.

use super::lobe::Fisher;
use super::rings::{Areas, Pixel, Rings, accumulate, catmull_rom};
use crate::math::scalar;
use crate::parallel;
use std::f64::consts::TAU;

/// Lobes are cut where exp(−κq) falls below exp(−`REACH`).
const REACH: f64 = 10.0;

/// The fewest pixels of a ring that are summed up; the others lie between them.
const FEWEST: usize = 8;

/// `input` blurred by `lobe`, on rings of `width` pixels, half as many rings. The width is that of `input` or half
/// of it.
pub(super) fn blur(input: &Rings, areas: &Areas, lobe: Fisher, width: usize) -> Rings {
    let mut output = Rings::black(width, width / 2);
    let polars: Vec<f64> = (0..output.height).map(|y| output.polar(y)).collect();
    let sources = InputRings::new(input, areas);
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
    for x in (0..row.len()).filter(|x| x % stride != 0) {
        let (before, between) = (x - x % stride, x % stride);
        let mut sum = [0.0; 4];
        for (k, weight) in catmull_rom(between as f32 / stride as f32).into_iter().enumerate() {
            let known = (before + row.len() + k * stride - stride) % row.len();
            accumulate(&mut sum, weight, &row[known]);
        }
        row[x] = sum;
    }
}

/// The rings of the input.
struct InputRings {
    width: usize,
    rings: Vec<InputRing>,
}

/// A ring of the input, twice in a row so that no sum meets its end.
struct InputRing {
    polar: f64,
    area: f64,
    twice: Vec<Pixel>,
}

impl InputRings {
    fn new(input: &Rings, areas: &Areas) -> Self {
        let ring = |(y, area)| InputRing { polar: input.polar(y), area, twice: input.row(y).repeat(2) };
        Self { width: input.width, rings: input.areas(areas).into_iter().enumerate().map(ring).collect() }
    }

    /// The means around every `stride`th pixel of the ring at `polar`.
    fn sum(&self, lobe: Fisher, polar: f64, stride: usize, row: &mut [Pixel]) {
        let ratio = self.width / row.len();
        let parts: Vec<Part<'_>> =
            self.rings.iter().filter_map(|ring| self.part(ring, lobe, polar, ratio)).collect();
        let total: f64 = parts.iter().flat_map(|part| &part.weights).sum();
        let scaled = |part: &Part<'_>| part.weights.iter().map(|weight| (weight / total) as f32).collect();
        let weights: Vec<Vec<f32>> = parts.iter().map(scaled).collect();
        let count = row.len() / stride;
        for block in (0..count).step_by(BLOCK) {
            // The last block takes some anew rather than being shorter.
            let columns: [usize; BLOCK] = std::array::from_fn(|i| (block.min(count - BLOCK) + i) * stride);
            let mut sums = [[0.0; 4]; BLOCK];
            for (part, weights) in parts.iter().zip(&weights) {
                let taken = columns.map(|x| part.from(x * ratio, self.width));
                add(&mut sums, weights, taken);
            }
            columns.iter().zip(sums).for_each(|(x, sum)| row[*x] = sum);
        }
    }

    /// The part of a ring that the lobe reaches from the ring at `polar`.
    fn part<'a>(&self, ring: &'a InputRing, lobe: Fisher, polar: f64, ratio: usize) -> Option<Part<'a>> {
        let apart = scalar::sin((polar - ring.polar) / 2.0);
        let round = 2.0 * scalar::sin(polar) * scalar::sin(ring.polar);
        // q = 2 sin²(Δθ/2) + 2 sin θ sin θ' sin²(Δφ/2)
        let nearest = 2.0 * apart * apart;
        let left = (REACH / lobe.kappa - nearest) / round;
        if left < 0.0 {
            return None;
        }
        let step = TAU / self.width as f64;
        // Of two input pixels that an output pixel covers, its middle lies between.
        let middle = (ratio as f64 - 1.0) / 2.0;
        let reach = if left < 1.0 { 2.0 * scalar::asin(left.sqrt()) / step } else { f64::INFINITY };
        let [first, last] = match reach * 2.0 < self.width as f64 - 2.0 {
            true => [(middle - reach).ceil() as isize, (middle + reach).floor() as isize],
            false => [0, self.width as isize - 1],
        };
        let weight = |x: isize| {
            let turn = scalar::sin((x as f64 - middle) * step / 2.0);
            ring.area * scalar::exp(-lobe.kappa * (nearest + round * turn * turn))
        };
        Some(Part { first, weights: (first..=last).map(weight).collect(), twice: &ring.twice })
    }
}

/// Neighbours in a ring and their weights.
struct Part<'a> {
    /// The first neighbour, counted from the pixel that the output's first lies on.
    first: isize,
    weights: Vec<f64>,
    twice: &'a [Pixel],
}

impl Part<'_> {
    /// The neighbours of input pixel `x` of `width`.
    #[inline(always)]
    fn from(&self, x: usize, width: usize) -> &[Pixel] {
        let start = x as isize + self.first;
        let start = if start < 0 { (start + width as isize) as usize } else { start as usize };
        let start = if start < width { start } else { start - width };
        &self.twice[start..start + self.weights.len()]
    }
}

/// The number of sums taken at once: additions wait for the last of their own sum only.
const BLOCK: usize = 4;

/// Adds weighted pixels to each of the sums.
#[inline(always)]
fn add(sums: &mut [Pixel; BLOCK], weights: &[f32], pixels: [&[Pixel]; BLOCK]) {
    let [a, b, c, d] = pixels.map(|pixels| &pixels[..weights.len()]);
    for (k, weight) in weights.iter().enumerate() {
        accumulate(&mut sums[0], *weight, &a[k]);
        accumulate(&mut sums[1], *weight, &b[k]);
        accumulate(&mut sums[2], *weight, &c[k]);
        accumulate(&mut sums[3], *weight, &d[k]);
    }
}
