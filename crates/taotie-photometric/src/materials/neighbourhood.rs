//! The expected values of a texel from those around it: means and spreads in a square window of the map.

use super::fit::Expected;

/// Texels on each side of a texel that the window holds.
const RADIUS: usize = 6;
/// The precision with which the whole material counts, like that of one neighbour of this deviation.
const WHOLE: f64 = 0.1;
/// A deviation that is added to those of all neighbours: materials vary at least as much.
const LEAST: f64 = 0.05;
/// The least spread that is expected.
const LEAST_SPREAD: f64 = 0.02;

/// A measured number at a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The texel, row by row.
    pub texel: u32,
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// Sums of precisions, and of values and squares times them, over all texels above and to the left.
pub struct Neighbourhood {
    side: usize,
    sums: Vec<[f64; 3]>,
    whole: Expected,
}

impl Measured {
    fn terms(&self) -> [f64; 3] {
        let precision = 1.0 / (self.deviation * self.deviation + LEAST * LEAST);
        [precision, precision * self.value, precision * self.value * self.value]
    }
}

impl Neighbourhood {
    /// Sums up measurements on a square map, at most one for each texel.
    pub fn new(side: usize, measured: &[Measured]) -> Self {
        let stride = side + 1;
        let mut sums = vec![[0.0; 3]; stride * stride];
        for of in measured {
            let (x, y) = (of.texel as usize % side, of.texel as usize / side);
            sums[(y + 1) * stride + x + 1] = of.terms();
        }
        let all = measured.iter().fold([0.0; 3], |sum, of| plus(sum, of.terms(), 1.0));
        for y in 1..stride {
            let mut row = [0.0; 3];
            for x in 1..stride {
                row = plus(row, sums[y * stride + x], 1.0);
                sums[y * stride + x] = plus(row, sums[(y - 1) * stride + x], 1.0);
            }
        }
        let whole = spread(all, Expected { mean: 0.5, deviation: 0.5 });
        Self { side, sums, whole }
    }

    /// Returns the number that the texels around let expect, without the texel's own measurement.
    pub fn expected(&self, texel: u32, own: Option<&Measured>) -> Expected {
        let stride = self.side + 1;
        let (x, y) = (texel as usize % self.side, texel as usize / self.side);
        let [left, top] = [x, y].map(|v| v.saturating_sub(RADIUS));
        let [right, bottom] = [x, y].map(|v| (v + RADIUS + 1).min(self.side));
        let at = |x: usize, y: usize| self.sums[y * stride + x];
        let above = plus(at(right, top), at(left, top), -1.0);
        let window = plus(plus(at(right, bottom), at(left, bottom), -1.0), above, -1.0);
        let others = own.map_or(window, |own| plus(window, own.terms(), -1.0)).map(|v| v.max(0.0));
        spread(others, self.whole)
    }
}

/// Returns the mean and spread of sums, to which a general expectation is added.
fn spread(sums: [f64; 3], general: Expected) -> Expected {
    let weight = 1.0 / (WHOLE * WHOLE);
    let square = general.mean * general.mean + general.deviation * general.deviation;
    let [precision, values, squares] = plus(sums, [1.0, general.mean, square], weight);
    let mean = values / precision;
    let variance = squares / precision - mean * mean;
    Expected { mean, deviation: variance.max(LEAST_SPREAD * LEAST_SPREAD).sqrt() }
}

fn plus(a: [f64; 3], b: [f64; 3], factor: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + factor * b[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_count_by_their_precision_and_the_texel_itself_does_not() {
        let side = 64;
        let value = |i: u32| match i % 64 < 32 {
            true => Measured { texel: i, value: 0.3, deviation: 0.02 },
            false => {
                Measured { texel: i, value: 0.7, deviation: if i.is_multiple_of(2) { 0.02 } else { 10.0 } }
            }
        };
        let mut measured: Vec<Measured> = (0..side * side).map(value).collect();
        measured.iter_mut().filter(|of| of.deviation > 1.0).for_each(|of| of.value = 0.0);
        measured[(10 * side + 10) as usize].value = 0.9;
        let found = Neighbourhood::new(side as usize, &measured);
        let at = |x: u32, y: u32| {
            let texel = y * side + x;
            found.expected(texel, Some(&measured[texel as usize]))
        };
        let left = at(10, 10);
        assert!((left.mean - 0.3).abs() < 0.01 && left.deviation < 0.05, "{left:?}");
        let right = at(50, 40);
        assert!((right.mean - 0.7).abs() < 0.01 && right.deviation < 0.05, "{right:?}");
        let border = at(32, 30);
        assert!(border.deviation > 0.15, "{border:?}");
        let empty = Neighbourhood::new(4, &[]).expected(5, None);
        assert!((empty.mean - 0.5).abs() < 1e-9 && (empty.deviation - 0.5).abs() < 0.01);
    }
}
