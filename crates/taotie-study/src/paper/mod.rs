//! Tables 2 and 3 of Guo and Wang 2025, recomputed.
//!
//! Only the printed numbers are known ([`ROWS`]). From them follow the law of N2 and N3 with the g of each row
//! ([`Fit`]), the angles ([`Angle`]), the misprints ([`Misprint`]) and the conclusions ([`Conclusion`]).
//!
//! ```
//! let study = taotie_study::paper::Study::new();
//! assert_eq!(study.misprints.len(), 5);
//! assert!(study.text().contains("Table 2, row 1, N2.y: printed -0.3608, should be -0.6080"));
//! ```

mod law;
mod page;
mod printed;
mod text;

pub use law::{Fit, Misprint, Number};
pub use printed::{Angle, Normal, Printed, ROWS};

use printed::angles;
use serde::Serialize;
use taotie_engine::compare::angle_deg;
use taotie_engine::math::Vec3;

/// The study of both tables.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// The rows.
    pub rows: Vec<Row>,
    /// The misprints.
    pub misprints: Vec<Misprint>,
    /// Counts of the numbers in Table 3 that follow from Table 2.
    pub agreeing: Agreeing,
    /// The conclusion that the tables support, which is not that of the paper.
    pub conclusion: Conclusion,
}

/// A row of both tables.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Its number, from 1.
    pub row: usize,
    /// The law of N1, N2 and N3.
    pub law: Fit,
    /// N4 as printed, which cannot be recomputed.
    pub n4: Normal,
    /// θ1, θ2 and θ3 against the normals as printed.
    pub angles_as_printed: [Angle; 3],
    /// The same after all corrections.
    pub angles_corrected: [Angle; 3],
    /// True if the law gives θ1 and θ2 as printed.
    pub explained: [bool; 2],
}

/// Counts of the numbers of Table 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Agreeing {
    /// All of them.
    pub of: usize,
    /// Those that follow from Table 2 as printed.
    pub as_printed: usize,
    /// Those that follow once the misprints are corrected.
    pub corrected: usize,
    /// Those of θ1 and θ2 that follow from just N1 and g.
    pub explained_by_the_law: usize,
}

/// The distances of N2 and N3 from N4, the paper's own method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Conclusion {
    /// With the corrected numbers.
    pub corrected: Distance,
    /// With the numbers as printed.
    pub as_printed: Distance,
    /// The minimum and maximum lengths of N1, of N3 (corrected) and of N4.
    pub lengths: [[f64; 2]; 3],
}

/// Angles to N4 over the ten points, degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distance {
    /// Mean from N2, bump 5.
    pub mean_bump_5: f64,
    /// Mean from N3, bump 50.
    pub mean_bump_50: f64,
    /// The number of points at which N2 is closer.
    pub bump_5_is_nearer: usize,
}

impl Default for Study {
    fn default() -> Self {
        Self::new()
    }
}

impl Study {
    /// Analyses the tables of the paper.
    pub fn new() -> Self {
        let fits: Vec<Fit> = ROWS.iter().map(fit).collect();
        let misprints = misprints(&fits);
        let corrected = corrected(&misprints);
        let rows: Vec<Row> = (0..ROWS.len()).map(|i| Row::new(i, &fits[i], &corrected[i])).collect();
        let agreeing = Agreeing {
            of: 3 * ROWS.len(),
            as_printed: agreeing(&ROWS),
            corrected: agreeing(&corrected),
            explained_by_the_law: rows.iter().flat_map(|row| row.explained).filter(|e| *e).count(),
        };
        let conclusion = Conclusion::new(&corrected);
        Self { rows, misprints, agreeing, conclusion }
    }
}

fn fit(row: &Printed) -> Fit {
    let [n1, n2, n3, _] = row.normals;
    Fit::new([n1, n2, n3])
}

impl Row {
    /// Analyses row `i`, counted from 0.
    fn new(i: usize, law: &Fit, corrected: &Printed) -> Self {
        let (printed, ranges) = (&ROWS[i], law.angles());
        Self {
            row: i + 1,
            law: *law,
            n4: printed.normals[3],
            angles_as_printed: angles(printed),
            angles_corrected: angles(corrected),
            explained: [0, 1].map(|which| Angle::new(printed.angles[which], ranges[which]).agrees),
        }
    }
}

/// Returns the misprints of Table 2, then the remaining ones of Table 3.
fn misprints(fits: &[Fit]) -> Vec<Misprint> {
    let numbered = || fits.iter().enumerate().map(|(i, fit)| (i + 1, fit));
    let normal = |(row, fit)| (0..3).filter_map(move |which| Misprint::of_normal(row, which, fit));
    let mut found: Vec<Misprint> = numbered().flat_map(normal).collect();
    let rows = corrected(&found);
    for (number, fit) in numbered() {
        // θ3 belongs to N4, which the law does not cover.
        let off =
            angles(&rows[number - 1]).into_iter().take(2).enumerate().filter(|(_, angle)| !angle.agrees);
        found.extend(off.map(|(which, angle)| Misprint::of_angle(number, which, &angle, fit)));
    }
    found
}

/// Returns the tables with these corrections.
fn corrected(misprints: &[Misprint]) -> [Printed; 10] {
    let mut rows = ROWS;
    for misprint in misprints {
        misprint.correct(&mut rows);
    }
    rows
}

/// Counts the angles that follow from the normals.
fn agreeing(rows: &[Printed]) -> usize {
    rows.iter().flat_map(angles).filter(|angle| angle.agrees).count()
}

impl Conclusion {
    fn new(corrected: &[Printed]) -> Self {
        let lengths = [0, 2, 3].map(|which| {
            let lengths = corrected.iter().map(|row| Vec3::from_array(row.normals[which]).length());
            lengths.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], v| [low.min(v), high.max(v)])
        });
        Self { corrected: Distance::new(corrected), as_printed: Distance::new(&ROWS), lengths }
    }
}

impl Distance {
    fn new(rows: &[Printed]) -> Self {
        let to_n4 = |row: &Printed, which: usize| {
            angle_deg(Vec3::from_array(row.normals[which]), Vec3::from_array(row.normals[3]))
        };
        let pairs: Vec<[f64; 2]> = rows.iter().map(|row| [to_n4(row, 1), to_n4(row, 2)]).collect();
        let mean = |which: usize| pairs.iter().map(|pair| pair[which]).sum::<f64>() / pairs.len() as f64;
        Self {
            mean_bump_5: mean(0),
            mean_bump_50: mean(1),
            bump_5_is_nearer: pairs.iter().filter(|[n2, n3]| n2 < n3).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_three_angles_agree_as_printed_and_all_thirty_corrected() {
        let counts = Study::new().agreeing;
        assert_eq!((counts.as_printed, counts.corrected, counts.of), (23, 30, 30));
        assert_eq!(counts.explained_by_the_law, 19, "all of θ1 and θ2 except for the misprinted one");
    }

    #[test]
    fn the_misprints_are_these() {
        let found = Study::new().misprints;
        let listed: Vec<String> = found
            .iter()
            .map(|m| format!("{} {} {} {:?} {:?}", m.table, m.row, m.cell, m.printed, m.corrected))
            .collect();
        let known = [
            "2 1 N2.y [-0.3608] [-0.608]",
            "2 3 N3 [0.6356, 0.5562, 0.5562] [1.8042, 0.6356, 0.5562]",
            "2 4 N2.x [0.5079] [0.5074]",
            "2 8 N1.x [0.5614] [0.5314]",
            "3 2 θ2 [27.93] [27.98]",
        ];
        assert_eq!(listed, known);
    }

    #[test]
    fn every_correction_is_necessary() {
        let all = Study::new().misprints;
        for omitted in 0..all.len() {
            let mut others = all.clone();
            let without = others.remove(omitted);
            assert!(agreeing(&corrected(&others)) < 30, "{without:?}");
        }
    }

    #[test]
    fn corrected_tables_follow_the_law_in_every_number() {
        let rows = corrected(&Study::new().misprints);
        assert!(rows.iter().all(|row| fit(row).agreeing == 9));
    }

    #[test]
    fn bump_5_is_closer_to_the_papers_method() {
        let Conclusion { corrected, as_printed, lengths } = Study::new().conclusion;
        assert!(
            (corrected.mean_bump_5 - 24.54).abs() < 0.01 && (corrected.mean_bump_50 - 36.62).abs() < 0.01
        );
        assert_eq!((corrected.bump_5_is_nearer, as_printed.bump_5_is_nearer), (7, 7));
        assert!(lengths[0][0] > 0.997 && lengths[1][1] > 5.8 && lengths[2][0] < 0.87, "{lengths:?}");
    }
}
