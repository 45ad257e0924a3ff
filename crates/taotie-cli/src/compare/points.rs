//! The places whose normals are told.

use anyhow::{Result, bail};
use std::collections::HashSet;
use std::fmt;

/// Which places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointChoice {
    /// This many, spread over what is seen.
    Spread(usize),
    /// These pixels, from the top left.
    Pixels(Vec<[u32; 2]>),
}

/// The rule of [`PointChoice::Spread`] in words, for reports.
pub const SPREAD_RULE: &str = "points (i₂, i₃) of the Halton sequence, i = 1, 2, …, stretched over the box around the \
    pixels away from silhouettes; each takes the pixel it falls into if that is such a pixel and not yet taken";

/// The most points: more are a picture, not a table.
const MOST: usize = 1000;

/// `N`, or `X,Y;X,Y`.
pub fn parse(value: &str) -> Result<PointChoice, String> {
    if let Ok(count) = value.trim().parse::<usize>() {
        return match count {
            0..=MOST => Ok(PointChoice::Spread(count)),
            _ => Err(format!("at most {MOST} places are told")),
        };
    }
    let pixels: Result<Vec<_>, _> = value.split(';').map(pixel).collect();
    pixels.map(PointChoice::Pixels)
}

fn pixel(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is no pixel; write how many places, or pixels such as 320,200;100,50");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    Ok([number(x)?, number(y)?])
}

/// As it is written on the command line.
impl fmt::Display for PointChoice {
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

impl PointChoice {
    /// Refuses pixels outside the picture.
    pub fn check(&self, [width, height]: [u32; 2]) -> Result<()> {
        let Self::Pixels(pixels) = self else { return Ok(()) };
        match pixels.iter().find(|[x, y]| *x >= width || *y >= height) {
            Some([x, y]) => bail!("--points: pixel {x},{y} lies outside the picture of {width}×{height}"),
            None => Ok(()),
        }
    }

    /// The pixels chosen. `inner` says, row by row in rows of `width`, which are away from silhouettes.
    pub fn choose(&self, inner: &[bool], width: usize) -> Vec<[u32; 2]> {
        match self {
            Self::Pixels(pixels) => pixels.clone(),
            Self::Spread(count) => spread(*count, inner, width),
        }
    }
}

/// See [`SPREAD_RULE`]. Fewer than `count` only where there are fewer such pixels.
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

/// The digits of `i` mirrored at the point, in [0, 1).
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
    fn reads_counts_and_pixels() {
        assert_eq!(parse("10"), Ok(PointChoice::Spread(10)));
        assert_eq!(parse("1,2; 3,4"), Ok(PointChoice::Pixels(vec![[1, 2], [3, 4]])));
        for written in ["10", "1,2;3,4"] {
            assert_eq!(parse(written).unwrap().to_string(), written);
        }
        assert!(parse("1,2;x").is_err() && parse("1001").is_err() && parse("-1").is_err());
        assert!(PointChoice::Pixels(vec![[4, 0]]).check([4, 4]).is_err());
    }

    #[test]
    fn points_are_spread_over_what_is_seen_and_nowhere_else() {
        let inner: Vec<bool> = (0..64 * 64).map(|i| (i % 64) > 20 && (i / 64) < 50).collect();
        let points = PointChoice::Spread(40).choose(&inner, 64);
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
        let mut points = PointChoice::Spread(10).choose(&inner, 10);
        points.sort_unstable();
        assert_eq!(points, [[2, 4], [5, 0], [9, 7]]);
        assert!(PointChoice::Spread(10).choose(&[false; 100], 10).is_empty());
    }
}
