//! The pixels whose normals are listed.

use std::collections::HashSet;
use std::fmt;

/// The sample points of a comparison: pixels whose normals are listed.
///
/// ```
/// use taotie::comparison::SamplePoints;
///
/// let pixels = SamplePoints::Pixels(vec![[3, 3], [4, 0]]);
/// assert_eq!(pixels.to_string(), "3,3;4,0");
/// assert_eq!(pixels.outside([4, 4]), Some([4, 0]));
/// assert_eq!(SamplePoints::Spread(10).outside([4, 4]), None);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum SamplePoints {
    /// This many, spread over what is seen.
    Spread(usize),
    /// These pixels, from the top left.
    Pixels(Vec<[u32; 2]>),
}

/// The rule of [`SamplePoints::Spread`] in words, for reports.
pub(super) const SPREAD_RULE: &str = "points (i₂, i₃) of the Halton sequence, i = 1, 2, …, stretched over the \
    box around the pixels away from silhouettes; each takes the pixel it falls into if that is away from silhouettes \
    and not yet taken";

/// A count, or pixels as `X,Y;X,Y`.
impl fmt::Display for SamplePoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Spread(count) => write!(f, "{count}"),
            Self::Pixels(pixels) => {
                let pixels: Vec<String> = pixels.iter().map(|[x, y]| format!("{x},{y}")).collect();
                f.write_str(&pixels.join(";"))
            }
        }
    }
}

impl SamplePoints {
    /// Returns the first pixel outside an image of this width and height.
    pub fn outside(&self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        match self {
            Self::Spread(_) => None,
            Self::Pixels(pixels) => pixels.iter().copied().find(|[x, y]| *x >= width || *y >= height),
        }
    }

    /// Returns the pixels. `inner` marks, row by row in rows of `width`, those away from silhouettes.
    pub(super) fn choose(&self, inner: &[bool], width: usize) -> Vec<[u32; 2]> {
        match self {
            Self::Pixels(pixels) => pixels.clone(),
            Self::Spread(count) => spread(*count, inner, width),
        }
    }
}

/// Chooses pixels: see [`SPREAD_RULE`]. Fewer than `count` only if there are fewer such pixels.
fn spread(count: usize, inner: &[bool], width: usize) -> Vec<[u32; 2]> {
    let all: Vec<[usize; 2]> =
        inner.iter().enumerate().filter(|(_, inner)| **inner).map(|(i, _)| [i % width, i / width]).collect();
    let Some(first) = all.first() else { return Vec::new() };
    let (mut low, mut high) = (*first, *first);
    for pixel in &all {
        low = [low[0].min(pixel[0]), low[1].min(pixel[1])];
        high = [high[0].max(pixel[0]), high[1].max(pixel[1])];
    }
    let [across, down] = [high[0] - low[0] + 1, high[1] - low[1] + 1];
    let wanted = count.min(all.len());
    let mut chosen = Vec::new();
    let mut taken = HashSet::new();
    for i in 1.. {
        if chosen.len() == wanted {
            break;
        }
        let x = low[0] + (radical_inverse(i, 2) * across as f64) as usize;
        let y = low[1] + (radical_inverse(i, 3) * down as f64) as usize;
        if inner[y * width + x] && taken.insert([x, y]) {
            chosen.push([x as u32, y as u32]);
        }
    }
    chosen
}

/// Returns the digits of `i` mirrored at the radix point, in [0, 1).
///
/// Source: Halton 1964, "Algorithm 247: Radical-inverse quasi-random point sequence".
fn radical_inverse(mut i: u64, base: u64) -> f64 {
    let (mut numerator, mut denominator) = (0, 1);
    while i > 0 {
        numerator = numerator * base + i % base;
        denominator *= base;
        i /= base;
    }
    numerator as f64 / denominator as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pixels_lie_outside() {
        let pixels = SamplePoints::Pixels(vec![[3, 3], [4, 0]]);
        assert_eq!((pixels.outside([4, 4]), pixels.outside([5, 4])), (Some([4, 0]), None));
        assert_eq!(SamplePoints::Spread(100).outside([4, 4]), None);
        assert_eq!(pixels.to_string(), "3,3;4,0");
    }

    #[test]
    fn points_are_spread_over_what_is_seen_and_nowhere_else() {
        let inner: Vec<bool> = (0..64 * 64).map(|i| (i % 64) > 20 && (i / 64) < 50).collect();
        let points = SamplePoints::Spread(40).choose(&inner, 64);
        assert_eq!(points.len(), 40);
        assert!(points.iter().all(|[x, y]| inner[(y * 64 + x) as usize]));
        // Each quarter of the region has its share.
        let quarter = |right: bool, low: bool| {
            points.iter().filter(|[x, y]| (*x > 42) == right && (*y > 25) == low).count()
        };
        for (right, low) in [(false, false), (false, true), (true, false), (true, true)] {
            assert!((7..=13).contains(&quarter(right, low)), "{}", quarter(right, low));
        }
    }

    #[test]
    fn few_pixels_are_all_chosen() {
        let inner: Vec<bool> = (0..100).map(|i| i % 37 == 5).collect();
        let mut points = SamplePoints::Spread(10).choose(&inner, 10);
        points.sort_unstable();
        assert_eq!(points, [[2, 4], [5, 0], [9, 7]]);
        assert!(SamplePoints::Spread(10).choose(&[false; 100], 10).is_empty());
    }
}
