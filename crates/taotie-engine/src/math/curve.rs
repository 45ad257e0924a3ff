//! A measured curve between positive numbers, such as the error over the number of triangles.

use super::scalar::{exp, ln};

/// Points of a curve, interpolated linearly in logarithms. Beyond the first and the last point it is extrapolated
/// from the nearest segment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Logarithms, in ascending order of the first number.
    points: Vec<[f64; 2]>,
}

/// The slope of a curve with one point: about that of the normal error over triangles.
const SLOPE_OF_ONE: f64 = -0.7;
/// The lower bound of values, which keeps logarithms finite.
const LEAST: f64 = 1e-6;
/// Between points whose logarithms differ by less, the chord is accurate enough.
const LEAST_GAP: f64 = 0.1;
/// The fraction of a wider gap, next to its ends, that is not sampled.
const MARGIN: f64 = 0.2;

impl Curve {
    /// Adds a point, replacing one with the same `x`.
    pub fn add(&mut self, x: f64, y: f64) {
        let point = [x, y].map(|v| ln(v.max(LEAST)));
        let at = self.points.partition_point(|known| known[0] < point[0]);
        match self.points.get_mut(at) {
            Some(known) if known[0] == point[0] => *known = point,
            _ => self.points.insert(at, point),
        }
    }

    /// Changes the value of each point.
    pub fn change(&mut self, change: impl Fn(f64) -> f64) {
        self.points.iter_mut().for_each(|[_, y]| *y = ln(change(exp(*y)).max(LEAST)));
    }

    /// Returns the value at `x`; infinite if the curve has no points.
    pub fn at(&self, x: f64) -> f64 {
        let x = ln(x.max(LEAST));
        let (start, slope) = match self.points.as_slice() {
            [] => return f64::INFINITY,
            [only] => (*only, SLOPE_OF_ONE),
            points => {
                let after = points.partition_point(|point| point[0] <= x).clamp(1, points.len() - 1);
                let [a, b] = [points[after - 1], points[after]];
                (a, (b[1] - a[1]) / (b[0] - a[0]))
            }
        };
        exp(start[1] + slope * (x - start[0]))
    }

    /// Returns the smallest number within a range whose value is at most `y`, to half a per cent; `None` if the value
    /// at its end is larger. The curve falls.
    pub fn first_within(&self, y: f64, [mut low, mut high]: [f64; 2]) -> Option<f64> {
        if self.at(high) > y {
            return None;
        }
        while high / low > 1.005 {
            let middle = (low * high).sqrt();
            if self.at(middle) <= y { high = middle } else { low = middle }
        }
        Some(self.toward_middle(high))
    }

    /// Returns a number between two points that are far apart, moved out of the fifth next to either: where a curve
    /// bends, its chord would converge to only one of them.
    fn toward_middle(&self, x: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] <= ln(x));
        match (after.checked_sub(1).map(|before| self.points[before]), self.points.get(after)) {
            (Some([low, _]), Some([high, _])) if high - low > LEAST_GAP => {
                let margin = MARGIN * (high - low);
                exp(ln(x).clamp(low + margin, high - margin))
            }
            _ => x,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power_law() -> Curve {
        let mut curve = Curve::default();
        [1e3, 1e5, 1e4].into_iter().for_each(|x: f64| curve.add(x, 50.0 / x.sqrt()));
        curve
    }

    #[test]
    fn a_power_law_is_followed_between_its_points_and_beyond() {
        let curve = power_law();
        for x in [10.0, 1e3, 2e3, 5e4, 1e6] {
            assert!((curve.at(x) * f64::sqrt(x) / 50.0 - 1.0).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn a_point_that_is_measured_again_counts_once() {
        let mut curve = power_law();
        curve.add(1e4, 0.75);
        assert!((curve.at(1e4) - 0.75).abs() < 1e-9);
        assert_eq!((curve.points.len(), Curve::default().at(3.0)), (3, f64::INFINITY));
    }

    #[test]
    fn the_first_number_within_a_limit_is_found() {
        let found = power_law().first_within(0.3, [100.0, 1e6]).unwrap();
        let wanted = (50.0 / 0.3) * (50.0 / 0.3);
        assert!((wanted..wanted * 1.006).contains(&found), "{found}");
        // Just beyond a point, it is moved toward the next one.
        let moved = power_law().first_within(0.499, [100.0, 1e6]).unwrap();
        assert!((1.5e4..1.6e4).contains(&moved), "{moved}");
        assert_eq!(power_law().first_within(0.01, [100.0, 1e6]), None);
    }
}
