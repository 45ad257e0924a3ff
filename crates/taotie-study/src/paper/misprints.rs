//! Misprinted numbers, the correct ones, and the reasons.

use super::angles::{Angle, cut};
use super::law::{Fit, Number};
use super::printed::{ANGLES, NORMALS, Normal, Printed};
use serde::Serialize;

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
