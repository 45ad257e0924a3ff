//! Fields, one number per pixel: their summary statistics and their images as heat maps; and planes of numbers in
//! double precision, convolved by separable kernels.

use super::{DisplayImage, one_per_pixel};
use crate::error::{Error, Result};
use crate::math::{SimdLevel, dispatch_registers};
use crate::names::Named;
use crate::parallel;
use fearless_simd::Level;
use std::ops::Range;

/// One number for each pixel, row by row from the top; NaN where there is none.
#[derive(Debug, Clone)]
pub struct Field {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

/// The numbers of a [`Field`], in its unit.
///
/// Quantiles are interpolated linearly between the two nearest of the n sorted values, with the quantile q at (n − 1)
/// · q counted from 0: type 7 of Hyndman and Fan 1996, NumPy's default.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// The number of pixels that have a number, at least 1.
    pub count: usize,
    /// The arithmetic mean, summed in double precision in the order of pixels.
    pub mean: f64,
    /// The quantile 0.5.
    pub median: f64,
    /// The quantiles 0.25 and 0.75.
    pub quartiles: [f64; 2],
    /// The quantile 0.95.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

impl Field {
    /// Makes a field from its numbers, row by row from the top.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a side is zero or the count is not `width · height`.
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Result<Self> {
        one_per_pixel("a field", width, height, values.len())?;
        Ok(Self { width, height, values })
    }

    /// Returns the width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns all numbers, row by row from the top; NaN where there is none.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns the mean and quantiles; `None` if no pixel has a number.
    pub fn summary(&self) -> Option<Summary> {
        let mut numbers: Vec<f32> = self.numbers().collect();
        let mean = self.mean()?;
        numbers.sort_unstable_by(f32::total_cmp);
        let max = f64::from(*numbers.last()?);
        Some(Summary {
            count: numbers.len(),
            mean,
            median: quantile(&numbers, 0.5),
            quartiles: [quantile(&numbers, 0.25), quantile(&numbers, 0.75)],
            p95: quantile(&numbers, 0.95),
            max,
        })
    }

    /// Returns the mean of [`Field::summary`], without its quantiles, which take longer; `None` if no pixel has a number.
    pub fn mean(&self) -> Option<f64> {
        let (sum, count) =
            self.numbers().fold((0.0, 0usize), |(sum, count), v| (sum + f64::from(v), count + 1));
        (count > 0).then(|| sum / count as f64)
    }

    /// Counts the numbers in each of `bins` equal parts of [0, `top`); those at or above `top` fall into the last
    /// part, those below 0 into the first.
    pub fn histogram(&self, bins: usize, top: f32) -> Vec<u64> {
        let mut counts = vec![0; bins];
        let Some(last) = bins.checked_sub(1) else { return counts };
        for value in self.numbers() {
            let bin = f64::from(value) / f64::from(top) * bins as f64;
            counts[(bin as usize).min(last)] += 1;
        }
        counts
    }

    /// Returns the field with only the numbers for which `keep`, one flag per pixel, is `true`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `keep` has a different length.
    pub fn within(&self, keep: &[bool]) -> Result<Field> {
        if keep.len() != self.values.len() {
            return Err(Error::invalid(
                format!("a mask of {} pixels", keep.len()),
                format!(
                    "the field is {}x{}; a mask must have one element for each pixel",
                    self.width, self.height
                ),
            ));
        }
        let kept = |(value, keep): (&f32, &bool)| if *keep { *value } else { f32::NAN };
        Ok(Self { values: self.values.iter().zip(keep).map(kept).collect(), ..*self })
    }

    fn numbers(&self) -> impl Iterator<Item = f32> {
        self.values.iter().copied().filter(|v| !v.is_nan())
    }
}

/// Returns the quantile `q` of `sorted`, which is not empty.
fn quantile(sorted: &[f32], q: f64) -> f64 {
    let at = (sorted.len() - 1) as f64 * q;
    let below = at.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    let (low, high) = (f64::from(sorted[below]), f64::from(sorted[above]));
    if low == high { low } else { low + (high - low) * (at - below as f64) }
}

/// The map from numbers to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColorMap {
    /// Dark blue over green to yellow; van der Walt and Smith 2015.
    #[default]
    Viridis,
    /// Black over purple to a light yellow; by the same authors, and used in FLIP's own images.
    Magma,
    /// Black to white.
    Gray,
}

impl Named for ColorMap {
    const WHAT: &'static str = "color map";
    const NAMES: &'static [(&'static str, Self)] =
        &[("viridis", Self::Viridis), ("magma", Self::Magma), ("gray", Self::Gray)];
}

impl ColorMap {
    /// Returns the 8-bit sRGB colour of a number, clamped to [0, 1].
    pub fn color(self, value: f64) -> [u8; 3] {
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Magma => colorous::MAGMA,
            Self::Gray => return [(value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8; 3],
        };
        gradient.eval_continuous(value).as_array()
    }
}

/// Returns the field as 8-bit sRGB colours, row by row from the top: 0 and below get the map's first colour, `top`
/// and above its last, and pixels without a number the colour `nothing`.
pub fn heat(field: &Field, top: f32, map: ColorMap, nothing: [u8; 3]) -> Vec<[u8; 3]> {
    let color = |value: &f32| match value {
        v if v.is_nan() => nothing,
        v if *v <= 0.0 => map.color(0.0),
        v => map.color(f64::from(*v) / f64::from(top.max(0.0))),
    };
    field.values().iter().map(color).collect()
}

/// One number for each pixel in double precision, row by row from the top. Beyond its sides each row repeats its last
/// pixels, so that kernels may reach over them.
pub(super) struct Plane {
    height: usize,
    /// The number of repeated pixels on each side.
    border: usize,
    /// The distance between rows in `values`.
    stride: usize,
    values: Vec<f64>,
    level: Level,
}

impl Plane {
    /// Makes a plane from one number per pixel, for kernels that reach at most `border` pixels.
    pub fn new<P: Sync>(
        (width, border): (u32, usize),
        pixels: &[P],
        number: impl Fn(&P) -> f64 + Sync,
    ) -> Self {
        let width = width as usize;
        let (height, stride) =
            (pixels.len() / width, (width + 2 * border).next_multiple_of(BLOCK) + 2 * BLOCK);
        let mut values = vec![0.0; stride * height];
        parallel::pieces(&mut values, stride, &|y, row| {
            for (i, out) in row.iter_mut().enumerate() {
                *out = number(&pixels[y * width + i.saturating_sub(border).min(width - 1)]);
            }
        });
        Self { height, border, stride, values, level: SimdLevel::fastest() }
    }

    /// Returns pixels convolved with a kernel of odd length along their columns, applied unmirrored, as a strip for
    /// [`Plane::across`]. Beyond its first and last row the plane repeats them.
    pub fn down(&self, pixels: &RowPart, kernel: &[f64]) -> Vec<f64> {
        self.weighted(pixels, kernel, |at| *block(&self.values, at))
    }

    /// Returns, like [`Plane::down`], the product with a plane of the same size and border.
    pub fn product_down(&self, other: &Self, pixels: &RowPart, kernel: &[f64]) -> Vec<f64> {
        self.weighted(pixels, kernel, |at| {
            let (a, b) = (block(&self.values, at), block(&other.values, at));
            std::array::from_fn(|i| a[i] * b[i])
        })
    }

    /// Returns numbers of a strip convolved with a kernel of odd length along the row, applied unmirrored: at least one
    /// for each of its pixels.
    pub fn across(&self, strip: &[f64], kernel: &[f64]) -> Vec<f64> {
        let first = self.border - kernel.len() / 2;
        let count = strip.len() - (2 * self.border).next_multiple_of(BLOCK);
        weighted_sums(self.level, (count, kernel), |tap, at| *block(strip, first + tap + at))
    }

    /// Returns the sums down the columns of the numbers that `block` returns for an index of the plane and those after.
    fn weighted(&self, pixels: &RowPart, kernel: &[f64], block: impl Fn(usize) -> [f64; BLOCK]) -> Vec<f64> {
        let count = pixels.columns.len().next_multiple_of(BLOCK) + (2 * self.border).next_multiple_of(BLOCK);
        let row = |tap: usize| (pixels.y + tap).saturating_sub(kernel.len() / 2).min(self.height - 1);
        weighted_sums(self.level, (count, kernel), |tap, at| {
            block(row(tap) * self.stride + pixels.columns.start + at)
        })
    }
}

/// Pixels of one row.
pub(super) struct RowPart {
    pub y: usize,
    pub columns: Range<usize>,
}

/// Number of values that are summed together.
const BLOCK: usize = 16;

/// Returns the `BLOCK` numbers from an index on.
#[inline(always)]
fn block(values: &[f64], at: usize) -> &[f64; BLOCK] {
    values[at..at + BLOCK].try_into().expect("a block")
}

/// Returns `count` sums, a multiple of [`BLOCK`]: the weights of a kernel times the numbers that `block` returns for
/// each tap and the index of the first sum.
fn weighted_sums(
    level: Level,
    (count, kernel): (usize, &[f64]),
    block: impl Fn(usize, usize) -> [f64; BLOCK],
) -> Vec<f64> {
    let mut all = vec![0.0; count];
    dispatch_registers!(level, _simd => add_weighted(&mut all, kernel, &block));
    all
}

#[inline(always)]
fn add_weighted(all: &mut [f64], kernel: &[f64], block: &impl Fn(usize, usize) -> [f64; BLOCK]) {
    for (i, out) in all.chunks_exact_mut(BLOCK).enumerate() {
        let mut sums = [0.0; BLOCK];
        for (tap, weight) in kernel.iter().enumerate() {
            let values = block(tap, i * BLOCK);
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value * weight;
            }
        }
        out.copy_from_slice(&sums);
    }
}

/// Returns, for each row of two images of the same size, the pixels that may differ once both are convolved with kernels
/// that reach `reach` pixels.
pub(super) fn blurred_differences([a, b]: [&DisplayImage; 2], reach: usize) -> Vec<RowPart> {
    let (width, height) = (a.width() as usize, a.height() as usize);
    let own: Vec<Range<usize>> = parallel::collect(height, |y| {
        let [a, b] = [a, b].map(|image| &image.pixels()[y * width..][..width]);
        let differs = |x: &usize| a[*x] != b[*x];
        let first = (0..width).find(differs).unwrap_or(width);
        first..(first..width).rfind(differs).map_or(first, |last| last + 1)
    });
    let part = |y: usize| {
        let around = own[y.saturating_sub(reach)..(y + reach + 1).min(height)].iter();
        let [start, end] = around
            .filter(|columns| !columns.is_empty())
            .fold([width, 0], |[start, end], columns| [start.min(columns.start), end.max(columns.end)]);
        let columns = start.saturating_sub(reach)..(end + reach).min(width);
        RowPart { y, columns: if end == 0 { 0..0 } else { columns } }
    };
    (0..height).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0 to 100 in mixed order, with a hole.
    fn ladder() -> Field {
        let rung = |i: u32| if i == 50 { f32::NAN } else { ((i * 37) % 101) as f32 };
        let mut values: Vec<f32> = (0..101).map(rung).collect();
        values.push((50 * 37 % 101) as f32);
        Field::new(51, 2, values).unwrap()
    }

    #[test]
    fn the_ladder_has_its_quantiles() {
        let summary = ladder().summary().unwrap();
        let expected =
            Summary { count: 101, mean: 50.0, median: 50.0, quartiles: [25.0, 75.0], p95: 95.0, max: 100.0 };
        assert_eq!(summary, expected);
    }

    #[test]
    fn quantiles_are_interpolated() {
        let summary = Field::new(2, 1, vec![3.0, 1.0]).unwrap().summary().unwrap();
        assert_eq!((summary.mean, summary.median, summary.quartiles), (2.0, 2.0, [1.5, 2.5]));
        assert!((summary.p95 - 2.9).abs() < 1e-12);
    }

    #[test]
    fn a_field_without_numbers_has_no_summary() {
        let nothing = Field::new(2, 2, vec![f32::NAN; 4]).unwrap();
        assert_eq!((nothing.summary(), nothing.mean()), (None, None));
        assert_eq!(nothing.histogram(3, 1.0), [0, 0, 0]);
    }

    #[test]
    fn every_number_falls_into_one_bin() {
        let field = Field::new(4, 2, vec![0.0, 0.5, 1.0, 1.9, 2.0, 1e9, -1.0, f32::NAN]).unwrap();
        assert_eq!(field.histogram(4, 2.0), [2, 1, 1, 3]);
        assert_eq!(ladder().histogram(10, 100.0), [10, 10, 10, 10, 10, 10, 10, 10, 10, 11]);
        assert_eq!(field.histogram(0, 2.0), Vec::<u64>::new());
    }

    #[test]
    fn a_mask_leaves_its_pixels() {
        let field = Field::new(3, 1, vec![1.0, 2.0, 4.0]).unwrap();
        assert_eq!(field.within(&[true, false, true]).unwrap().summary().unwrap().mean, 2.5);
        assert!(field.within(&[true]).unwrap_err().to_string().contains("3x1"));
    }

    #[test]
    fn a_wrong_count_is_refused() {
        assert!(Field::new(3, 2, vec![0.0; 5]).is_err());
        assert!(Field::new(0, 2, vec![]).is_err());
    }

    #[test]
    fn the_ends_of_the_maps_are_theirs() {
        let near = |a: [u8; 3], b: [u8; 3]| (0..3).all(|c| a[c].abs_diff(b[c]) <= 2);
        assert!(
            near(ColorMap::Viridis.color(0.0), [68, 1, 84])
                && near(ColorMap::Viridis.color(1.0), [253, 231, 37])
        );
        assert!(
            near(ColorMap::Magma.color(0.0), [0, 0, 4]) && near(ColorMap::Magma.color(1.0), [252, 253, 191])
        );
        assert!(near(ColorMap::Magma.color(0.5), [183, 55, 121]), "{:?}", ColorMap::Magma.color(0.5));
        assert_eq!((ColorMap::Gray.color(0.2), ColorMap::Gray.color(9.0)), ([51; 3], [255; 3]));
    }

    #[test]
    fn numbers_beyond_the_scale_take_its_ends() {
        let field = Field::new(6, 1, vec![-1.0, 0.0, 1.0, 2.0, f32::INFINITY, f32::NAN]).unwrap();
        let colors = heat(&field, 2.0, ColorMap::Gray, [9, 8, 7]);
        assert_eq!(colors, [[0; 3], [0; 3], [128; 3], [255; 3], [255; 3], [9, 8, 7]]);
        assert_eq!(heat(&field, 0.0, ColorMap::Gray, [9; 3])[1..3], [[0; 3], [255; 3]]);
    }

    #[test]
    fn kernels_reach_over_the_border_and_keep_their_direction() {
        let plane = Plane::new((3, 2), &[1.0, 2.0, 4.0, 10.0, 20.0, 40.0], |v| *v);
        let filtered = |across: &[f64], down: &[f64]| {
            let row =
                |y| plane.across(&plane.down(&RowPart { y, columns: 0..3 }, down), across)[..3].to_vec();
            [row(0), row(1)].concat()
        };
        assert_eq!(filtered(&[0.0, 0.0, 1.0], &[1.0]), [2.0, 4.0, 4.0, 20.0, 40.0, 40.0]);
        assert_eq!(filtered(&[1.0], &[0.0, 0.0, 1.0]), [10.0, 20.0, 40.0, 10.0, 20.0, 40.0]);
        assert_eq!(filtered(&[0.25, 0.5, 0.25], &[0.0, 1.0, 0.0]), [1.25, 2.25, 3.5, 12.5, 22.5, 35.0]);
        assert_eq!(filtered(&[1.0, 0.0, 0.0, 0.0, 0.0], &[1.0]), [1.0, 1.0, 1.0, 10.0, 10.0, 10.0]);
    }

    #[test]
    fn any_part_of_a_row_has_the_numbers_of_the_whole() {
        let value = |i: usize| ((i * 37) % 101) as f64;
        let plane = Plane::new((70, 4), &(0..70 * 9).map(value).collect::<Vec<_>>(), |v| *v);
        let kernel = [0.1, -0.4, 0.3, 0.7, 0.2];
        let row = |columns: Range<usize>| {
            let part = RowPart { y: 1, columns };
            let [own, squared] = [plane.down(&part, &kernel), plane.product_down(&plane, &part, &kernel)];
            [own, squared].map(|strip| plane.across(&strip, &kernel)[..part.columns.len()].to_vec())
        };
        let whole = row(0..70);
        for columns in [0..1, 3..20, 60..70, 17..49, 0..70] {
            assert_eq!(row(columns.clone()), [0, 1].map(|i| whole[i][columns.clone()].to_vec()));
        }
    }

    #[test]
    fn differences_spread_as_far_as_kernels_reach() {
        let image = |bright: &[usize]| {
            let pixels = (0..80).map(|i| if bright.contains(&i) { [1.0; 3] } else { [0.5; 3] });
            DisplayImage::new(10, 8, pixels.collect()).unwrap()
        };
        let parts = blurred_differences([&image(&[]), &image(&[24, 35])], 2);
        let columns: Vec<_> = parts.into_iter().map(|part| part.columns).collect();
        assert_eq!(columns, [2..7, 2..8, 2..8, 2..8, 2..8, 3..8, 0..0, 0..0]);
    }
}
