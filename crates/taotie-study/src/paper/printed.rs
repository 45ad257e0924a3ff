//! Tables 2 and 3 of Guo and Wang 2025 as printed, misprints included.
//!
//! The paper truncates decimals, so a printed number represents a [`Range`] of numbers that are printed the same, and
//! the printed normals allow a range of angles ([`Angle`]).

use serde::Serialize;
use taotie_engine::compare::angle_deg;
use taotie_engine::math::Vec3;

/// The x, y and z of a normal, with four decimals.
pub type Normal = [f64; 3];

/// A row of both tables: a point of the jue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printed {
    /// Table 2: N1 (the mesh normal), N2 (bump 5), N3 (bump 50), N4 (the paper's method).
    pub normals: [Normal; 4],
    /// Table 3: θ1, θ2, θ3, the angles from N1 to N2, N3 and N4 in degrees, with two decimals.
    pub angles: [f64; 3],
}

/// The bump scale s of N1, N2 and N3.
pub const SCALES: [i64; 3] = [0, 5, 50];

/// The names of the normals.
pub const NORMALS: [&str; 4] = ["N1", "N2", "N3", "N4"];

/// The names of the angles.
pub const ANGLES: [&str; 3] = ["θ1", "θ2", "θ3"];

const fn row(normals: [Normal; 4], angles: [f64; 3]) -> Printed {
    Printed { normals, angles }
}

/// All rows.
#[rustfmt::skip]
pub const ROWS: [Printed; 10] = [
    row([[0.5334, -0.6374, 0.5556], [0.5628, -0.3608, 0.5556], [ 0.8275, -0.3433, 0.5556], [0.7425, -0.1102, 0.5192]], [ 2.38, 23.17, 34.19]),
    row([[0.5324, -0.6379, 0.5554], [0.4932, -0.6771, 0.5554], [ 0.1402, -1.0301, 0.5554], [0.6654, -0.2239, 0.5324]], [ 3.15, 27.93, 25.80]),
    row([[0.5297, -0.6388, 0.5562], [0.6571, -0.5113, 0.5562], [ 0.6356,  0.5562, 0.5562], [0.7503, -0.1474, 0.4980]], [10.33, 64.42, 32.52]),
    row([[0.5270, -0.6396, 0.5570], [0.5079, -0.6592, 0.5570], [ 0.3309, -0.8357, 0.5570], [0.6133, -0.3605, 0.5298]], [ 1.58, 15.15, 16.58]),
    row([[0.5242, -0.6405, 0.5578], [0.4654, -0.6993, 0.5578], [-0.0639, -1.2288, 0.5578], [0.6957, -0.0848, 0.5388]], [ 4.71, 37.85, 35.35]),
    row([[0.5215, -0.6414, 0.5586], [0.5411, -0.6218, 0.5586], [ 0.7176, -0.4453, 0.5586], [0.7272, -0.0756, 0.5308]], [ 1.58, 15.83, 36.53]),
    row([[0.5341, -0.6375, 0.5543], [0.9459, -0.2257, 0.5543], [ 4.6518,  3.4800, 0.5543], [0.8798,  0.1842, 0.4347]], [31.25, 84.35, 53.51]),
    row([[0.5614, -0.6384, 0.5551], [0.7863, -0.3835, 0.5551], [ 3.0804,  1.9105, 0.5551], [0.7279, -0.2330, 0.4493]], [20.29, 78.57, 27.58]),
    row([[0.5287, -0.6393, 0.5559], [0.4405, -0.7275, 0.5559], [-0.3536, -1.5216, 0.5559], [0.5080, -0.5685, 0.4988]], [ 7.03, 48.60,  1.93]),
    row([[0.5260, -0.6401, 0.5567], [0.5750, -0.5911, 0.5567], [ 1.0162, -0.1499, 0.5567], [0.6676, -0.0944, 0.5423]], [ 3.98, 36.25, 34.30]),
];

/// Units of a [`Range`] per 1: fine enough for four decimals and for half a grey level in 255.
const UNITS: i64 = 10_000 * 2 * 255;

/// Numbers between two ends, in exact arithmetic. A range without an interior is empty; it is unspecified whether the
/// ends are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Range {
    low: i64,
    high: i64,
}

impl Range {
    /// Returns the numbers printed as `printed`, with four decimals: the paper truncates towards zero.
    pub fn of(printed: f64) -> Self {
        let cut = (printed * 1e4).round() as i64 * (UNITS / 10_000);
        let step = UNITS / 10_000;
        if cut < 0 { Self { low: cut - step, high: cut } } else { Self { low: cut, high: cut + step } }
    }

    /// Returns the range shifted up by s · g/255, where g is `half_greys`/2.
    pub fn raised(self, scale: i64, half_greys: i64) -> Self {
        let by = scale * half_greys * (UNITS / 2 / 255);
        Self { low: self.low + by, high: self.high + by }
    }

    /// Returns the intersection of two ranges; `None` if it is empty.
    pub fn and(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low < high).then_some(Self { low, high })
    }

    /// Returns the ends.
    pub fn ends(self) -> [f64; 2] {
        [self.low, self.high].map(|end| end as f64 / UNITS as f64)
    }

    /// Returns the middle as it would be printed.
    pub fn printed(self) -> f64 {
        let middle = (self.low + self.high) as f64 / 2.0;
        (middle / (UNITS / 10_000) as f64).trunc() / 1e4
    }
}

/// A printed angle, and the range of angles that the printed normals allow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Angle {
    /// As printed, degrees.
    pub printed: f64,
    /// The range of angles between normals that are printed this way, degrees.
    pub range: [f64; 2],
    /// True if some angle in the range would be printed this way.
    pub agrees: bool,
}

impl Angle {
    /// Creates a printed angle with the range that normals allow.
    pub(super) fn new(printed: f64, range: [f64; 2]) -> Self {
        let [low, high] = range.map(cut);
        Self { printed, range, agrees: (low..=high).contains(&printed) }
    }

    /// Returns the smallest and the largest angle that may be printed.
    pub fn prints(&self) -> [f64; 2] {
        self.range.map(cut)
    }
}

/// Truncates to two decimals, like the paper.
pub fn cut(degrees: f64) -> f64 {
    (degrees * 100.0).floor() / 100.0
}

/// Returns θ1, θ2 and θ3 of a row, from its normals.
pub fn angles(row: &Printed) -> [Angle; 3] {
    let [n1, others @ ..] = row.normals.map(box_of);
    std::array::from_fn(|i| {
        let pairs = corners(n1).flat_map(|a| corners(others[i]).map(move |b| angle_deg(a, b)));
        Angle::new(row.angles[i], extremes(pairs))
    })
}

/// Returns the range of the angle between N1, anywhere in a box, and the same normal raised along x and y by `raise`.
pub fn angle_of_raise(n1: [[f64; 2]; 3], raise: f64) -> [f64; 2] {
    let raised = |n: Vec3<f64>| n + Vec3::new(raise, raise, 0.0);
    extremes(corners(n1).map(|n| angle_deg(n, raised(n))))
}

fn box_of(normal: Normal) -> [[f64; 2]; 3] {
    normal.map(|component| Range::of(component).ends())
}

/// The corners of a box. Angles are almost linear within it, since it is only 0.0001 wide.
fn corners([x, y, z]: [[f64; 2]; 3]) -> impl Iterator<Item = Vec3<f64>> {
    (0..8).map(move |i| Vec3::new(x[i & 1], y[i >> 1 & 1], z[i >> 2]))
}

fn extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_truncated_towards_zero() {
        assert_eq!(Range::of(0.5334).ends(), [0.5334, 0.5335]);
        assert_eq!(Range::of(-0.6374).ends(), [-0.6375, -0.6374]);
        for printed in [0.5334, -0.6374, 4.6518, -1.5216, 3.48] {
            assert_eq!(Range::of(printed).printed(), printed);
        }
    }

    #[test]
    fn shifts_are_exact() {
        let raised = Range::of(0.5334).raised(50, 3);
        let units = |tens: f64| (tens * 510.0 + 50.0 * 3.0 * 1e4) / 5.1e6;
        assert_eq!(raised.ends(), [units(5334.0), units(5335.0)]);
        assert_eq!(raised.raised(50, -3), Range::of(0.5334));
        assert_eq!(Range::of(0.5).and(Range::of(0.5001)), None);
        assert_eq!(Range::of(0.5).and(Range::of(0.5)), Some(Range::of(0.5)));
    }

    #[test]
    fn an_angle_is_known_to_two_hundredths() {
        for row in &ROWS {
            for angle in angles(row) {
                let width = angle.range[1] - angle.range[0];
                assert!(width > 0.0 && width < 0.02, "{angle:?}");
            }
        }
    }

    #[test]
    fn decimals_are_truncated() {
        assert_eq!([cut(27.989), cut(27.98), cut(0.0)], [27.98, 27.98, 0.0]);
    }

    #[test]
    fn a_raise_of_zero_has_zero_angle() {
        let n = [[0.5, 0.5001], [-0.6, -0.5999], [0.6, 0.6001]];
        assert_eq!(angle_of_raise(n, 0.0), [0.0, 0.0]);
        assert!(angle_of_raise(n, 0.1)[0] > 5.0);
    }
}
