//! The law that N1, N2 and N3 follow, derived only from the printed numbers; and the misprints, which contradict it.
//!
//! N2 and N3 are n + s · (g/255) · (1, 1, 0) with s = 5 and 50: [`taotie_engine::surface::bump_printed`]. Each row
//! has one g, which is half the difference of two grey levels and so a multiple of one half. We take the g that
//! agrees with most of the row's nine numbers; numbers that do not agree are misprints.

use super::printed::{ANGLES, Angle, NORMALS, Normal, Printed, Range, SCALES, angle_of_raise, cut};
use serde::Serialize;

/// The largest difference of grey levels.
const GREYS: i64 = 255;

/// The direction along which the bump moves the normal.
const ALONG: [i64; 3] = [1, 1, 0];

/// The law of a row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fit {
    /// Half the central difference of grey levels.
    pub g: f64,
    /// 255/s · (N − N1) for x and y of N2, then of N3: the value of g if that number were correct.
    pub estimates: [f64; 4],
    /// How many of the nine numbers of N1, N2 and N3 agree.
    pub agreeing: usize,
    /// x, y and z of N1, N2 and N3.
    pub normals: [[Number; 3]; 3],
}

/// A printed number, and the range that the other numbers of its row allow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Number {
    /// As printed.
    pub printed: f64,
    /// The range that the law allows.
    pub range: [f64; 2],
    /// The middle of the range, truncated.
    pub recomputed: f64,
    /// True if some number in the range would be printed this way.
    pub agrees: bool,
}

impl Fit {
    /// Finds the law of a row.
    pub fn new(normals: [Normal; 3]) -> Self {
        let half_greys = (-GREYS..=GREYS).max_by_key(|half| agreeing(&numbers(normals, *half)));
        let half_greys = half_greys.expect("there are grey levels");
        let numbers = numbers(normals, half_greys);
        Self {
            g: half_greys as f64 / 2.0,
            estimates: estimates(normals),
            agreeing: agreeing(&numbers),
            normals: numbers,
        }
    }

    /// Returns the ranges that the law allows for θ1 and θ2, degrees.
    pub fn angles(&self) -> [[f64; 2]; 2] {
        let n1 = self.normals[0].map(|number| number.range);
        [1, 2].map(|which| angle_of_raise(n1, SCALES[which] as f64 * self.g / 255.0))
    }
}

fn estimates([n1, n2, n3]: [Normal; 3]) -> [f64; 4] {
    let by = |n: Normal, scale: i64, axis: usize| (n[axis] - n1[axis]) * 255.0 / scale as f64;
    [by(n2, SCALES[1], 0), by(n2, SCALES[1], 1), by(n3, SCALES[2], 0), by(n3, SCALES[2], 1)]
}

fn agreeing(numbers: &[[Number; 3]; 3]) -> usize {
    numbers.iter().flatten().filter(|number| number.agrees).count()
}

/// Returns all numbers of N1, N2 and N3 for a g of `half_greys`/2.
fn numbers(normals: [Normal; 3], half_greys: i64) -> [[Number; 3]; 3] {
    let axes: [[Number; 3]; 3] = std::array::from_fn(|axis| {
        let printed = normals.map(|normal| normal[axis]);
        let shifts = SCALES.map(|scale| scale * ALONG[axis]);
        along_axis(printed, shifts, half_greys)
    });
    std::array::from_fn(|normal| std::array::from_fn(|axis| axes[axis][normal]))
}

/// Returns one component of N1, N2 and N3. The majority determines the component of the unbumped normal.
fn along_axis(printed: [f64; 3], shifts: [i64; 3], half_greys: i64) -> [Number; 3] {
    let bases: [Range; 3] = std::array::from_fn(|i| Range::of(printed[i]).raised(-shifts[i], half_greys));
    let base = largest_agreement(bases);
    std::array::from_fn(|i| {
        let range = base.raised(shifts[i], half_greys);
        let agrees = range.and(Range::of(printed[i])).is_some();
        Number { printed: printed[i], range: range.ends(), recomputed: range.printed(), agrees }
    })
}

/// Returns the intersection of the most ranges; the first in case of a tie.
fn largest_agreement([a, b, c]: [Range; 3]) -> Range {
    let all = a.and(b).and_then(|ab| ab.and(c));
    all.or(a.and(b)).or(a.and(c)).or(b.and(c)).unwrap_or(a)
}

/// A misprint in the journal or in the transcribed copy.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Misprint {
    /// The table, 2 or 3.
    pub table: u32,
    /// The row, from 1.
    pub row: usize,
    /// The number, such as `N2.y`; a whole normal if more than one of its numbers is wrong.
    pub cell: String,
    /// The numbers as printed.
    pub printed: Vec<f64>,
    /// The correct numbers.
    pub corrected: Vec<f64>,
    /// The reason for the correction.
    pub reason: String,
    #[serde(skip)]
    correction: Correction,
}

/// The corrected value of a misprint, and its column.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Correction {
    Normal(usize, Normal),
    Angle(usize, f64),
}

impl Misprint {
    /// Corrects it in `rows`.
    pub(super) fn correct(&self, rows: &mut [Printed]) {
        let row = &mut rows[self.row - 1];
        match self.correction {
            Correction::Normal(which, normal) => row.normals[which] = normal,
            Correction::Angle(which, angle) => row.angles[which] = angle,
        }
    }

    /// Returns the misprint of a normal, if there is one. `fit` is that of its row.
    pub(super) fn of_normal(row: usize, which: usize, fit: &Fit) -> Option<Self> {
        let numbers = &fit.normals[which];
        let wrong: Vec<usize> = (0..3).filter(|axis| !numbers[*axis].agrees).collect();
        let corrected = numbers.map(|number| number.recomputed);
        let pick = |of: fn(&Number) -> f64| match wrong.as_slice() {
            [axis] => vec![of(&numbers[*axis])],
            _ => numbers.iter().map(of).collect(),
        };
        Some(Self {
            table: 2,
            row,
            cell: cell_name(which, &wrong)?,
            printed: pick(|number| number.printed),
            corrected: pick(|number| number.recomputed),
            reason: reason_of_normal(fit, which, &wrong),
            correction: Correction::Normal(which, corrected),
        })
    }

    /// Returns the misprint of θ1 or θ2 (`which` is 0 or 1), which the row's corrected normals contradict. `fit` is
    /// that of its row.
    pub(super) fn of_angle(row: usize, which: usize, angle: &Angle, fit: &Fit) -> Self {
        let ([low, high], g) = (fit.angles()[which], fit.g);
        let corrected = cut((low + high) / 2.0);
        let (name, other) = (ANGLES[which], NORMALS[which + 1]);
        let reason = format!(
            "all numbers of N1 and {other} follow the law with g = {g}, and the angle is {low:.3}° to {high:.3}°"
        );
        Self {
            table: 3,
            row,
            cell: name.into(),
            printed: vec![angle.printed],
            corrected: vec![corrected],
            reason,
            correction: Correction::Angle(which, corrected),
        }
    }
}

/// Returns `N2.y`, or `N2` if more than one number is wrong; `None` if none is.
fn cell_name(which: usize, wrong: &[usize]) -> Option<String> {
    match wrong {
        [] => None,
        [axis] => Some(format!("{}.{}", NORMALS[which], AXES[*axis])),
        _ => Some(NORMALS[which].into()),
    }
}

/// The names of the components.
pub const AXES: [&str; 3] = ["x", "y", "z"];

fn reason_of_normal(fit: &Fit, which: usize, wrong: &[usize]) -> String {
    let numbers = &fit.normals[which];
    let leaves: Vec<String> = wrong
        .iter()
        .map(|axis| {
            let [low, high] = numbers[*axis].range;
            format!("{} between {low:.5} and {high:.5}", AXES[*axis])
        })
        .collect();
    let law = format!("g = {} explains {} of the row's 9 numbers and puts", fit.g, fit.agreeing);
    let slip =
        if moved_left(numbers) { "; y and z are printed one column too far left, and x is lost" } else { "" };
    format!("{law} {}{slip}", leaves.join(" and "))
}

/// Returns true if y is in the place of x and z in that of y.
fn moved_left([x, y, z]: &[Number; 3]) -> bool {
    x.printed == y.recomputed && y.printed == z.recomputed
}

#[cfg(test)]
mod tests {
    use super::super::printed::ROWS;
    use super::*;
    use taotie_engine::math::Vec3;
    use taotie_engine::surface::bump_printed;

    fn row([n1, n2, n3, _]: [Normal; 4]) -> [Normal; 3] {
        [n1, n2, n3]
    }

    #[test]
    fn one_g_fits_both_columns_and_no_other_does_as_well() {
        for printed in ROWS {
            let normals = row(printed.normals);
            let fit = Fit::new(normals);
            let score = |half| agreeing(&numbers(normals, half));
            let rivals = (-GREYS..=GREYS).filter(|half| *half as f64 / 2.0 != fit.g).map(score).max();
            assert!(rivals < Some(fit.agreeing - 1), "{fit:?} against {rivals:?}");
            assert!(fit.agreeing >= 7, "{fit:?}");
        }
    }

    #[test]
    fn it_is_the_librarys_printed_bump() {
        for printed in ROWS {
            let fit = Fit::new(row(printed.normals));
            let n1 = fit.normals[0].map(|number| (number.range[0] + number.range[1]) / 2.0);
            for (scale, numbers) in [(5.0, fit.normals[1]), (50.0, fit.normals[2])] {
                let bumped = bump_printed(Vec3::from_array(n1), scale, fit.g).to_array();
                for (number, ours) in numbers.iter().zip(bumped) {
                    assert!((number.range[0]..=number.range[1]).contains(&ours), "{ours} {number:?}");
                }
            }
        }
    }

    #[test]
    fn rounding_would_not_explain_the_table() {
        // Row 5, N3.x: 0.5242 ± 0.00005 − 50 · 3/255 is −0.0640 ± 0.0001 at most, and −0.0639 is printed.
        let [n1, _, n3, _] = ROWS[4].normals;
        let off = n3[0] - (n1[0] - 50.0 * 3.0 / 255.0);
        assert!(off > 1e-4 + 1e-5, "{off}");
        assert!(Fit::new(row(ROWS[4].normals)).normals[2][0].agrees);
    }
}
