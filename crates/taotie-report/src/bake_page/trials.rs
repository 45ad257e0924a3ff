//! The trials of a search: a plot of bytes against degrees, and all numbers as CSV.

use crate::table::{Csv, number};
use crate::{Axis, PlotPoint, PointSeries, Section};
use taotie::asset::{Report, Trial};
use taotie_io::VertexBits;

/// Smaller angles are drawn at this value, degrees, since a logarithmic axis has no zero.
const LEAST_ANGLE: f64 = 0.001;

/// Returns the plot of bytes against degrees; `None` if there was no search.
pub fn plot(report: &Report) -> Option<Section> {
    // There is no angle if there were no pixels to compare.
    let shown: Vec<Trial> =
        report.trials.iter().filter(|trial| trial.mean_angle.is_finite()).copied().collect();
    if shown.is_empty() {
        return None;
    }
    let of_kind = |kind: &'static str| PointSeries {
        label: kind.into(),
        points: shown.iter().filter(|trial| trial.kind() == kind).map(point).collect(),
    };
    Some(Section::Plot {
        title: "Bytes against degrees".into(),
        note: "Every file that the search wrote, read back and measured. Filled: within the limits for angles, \
               colours and the device. Ring: beyond at least one limit. The line joins the smallest files for \
               each mean angle; the cross marks the asset."
            .into(),
        x: Axis { name: "size".into(), unit: "kB".into() },
        y: Axis { name: "mean angle".into(), unit: "°".into() },
        series: Trial::KINDS.into_iter().map(of_kind).collect(),
        frontier: frontier(&shown),
    })
}

fn point(trial: &Trial) -> PlotPoint {
    let color = trial.mean_color.map_or_else(String::new, |color| format!(", ΔE {color:.2}"));
    let maps = match trial.size {
        0 => String::new(),
        size => format!(", {size} texels"),
    };
    let format = trial.normals.map_or_else(String::new, |codec| format!(", normals as {codec}"));
    let [kilobytes, angle] = place(trial);
    PlotPoint {
        at: [kilobytes, angle],
        text: format!(
            "{}: {} triangles{maps}{format}, {kilobytes:.0} kB, {:.2}°{color}",
            trial.kind(),
            trial.triangles,
            trial.mean_angle
        ),
        is_chosen: trial.is_chosen,
        is_filled: trial.is_near,
    }
}

fn place(trial: &Trial) -> [f64; 2] {
    [trial.bytes as f64 / 1000.0, trial.mean_angle.max(LEAST_ANGLE)]
}

/// Returns the trials that no other beats in both bytes and mean angle, by ascending bytes.
fn frontier(trials: &[Trial]) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> = trials.iter().map(place).collect();
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut least = f64::INFINITY;
    places.retain(|[_, angle]| {
        let is_better = *angle < least;
        least = least.min(*angle);
        is_better
    });
    places
}

/// Returns all trials as CSV, in the order in which they were made.
///
/// ```
/// use taotie::asset::Report;
///
/// /// Returns the number of trials.
/// fn trials(report: &Report) -> usize {
///     taotie_report::bake_page::trials_csv(&report.trials).lines().count() - 1
/// }
/// ```
pub fn trials_csv(trials: &[Trial]) -> String {
    let mut csv = Csv::new([
        "kind",
        "chosen",
        "near",
        "bytes",
        "gpu_bytes",
        "triangles",
        "texels",
        "normals",
        "position_bits",
        "normal_bits",
        "uv_bits",
        "mean_angle_deg",
        "p95_angle_deg",
        "mean_color",
        "p95_color",
        "angle_ratio",
        "color_ratio",
        "ceiling_ratio",
    ]);
    let number = |value: Option<f64>| number(value.filter(|value| value.is_finite()));
    for trial in trials {
        let VertexBits { positions, normals, uvs } = trial.bits;
        csv.row([
            trial.kind().into(),
            trial.is_chosen.to_string(),
            trial.is_near.to_string(),
            trial.bytes.to_string(),
            trial.gpu_bytes.to_string(),
            trial.triangles.to_string(),
            trial.size.to_string(),
            trial.normals.map_or_else(String::new, |codec| codec.to_string()),
            positions.to_string(),
            normals.to_string(),
            uvs.to_string(),
            number(Some(trial.mean_angle)),
            number(Some(trial.p95_angle)),
            number(trial.mean_color),
            number(trial.p95_color),
            number(Some(trial.angle_ratio)),
            number(trial.color_ratio),
            number(Some(trial.ceiling_ratio)),
        ]);
    }
    csv.text().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(bytes: u64, mean_angle: f64) -> Trial {
        let mut trial = Trial::default();
        (trial.bytes, trial.mean_angle) = (bytes, mean_angle);
        trial
    }

    #[test]
    fn the_frontier_excludes_dominated_trials() {
        let trials =
            [trial(4000, 0.5), trial(1000, 3.0), trial(2000, 1.0), trial(3000, 2.0), trial(2000, 1.5)];
        assert_eq!(frontier(&trials), [[1.0, 3.0], [2.0, 1.0], [4.0, 0.5]]);
    }

    #[test]
    fn every_trial_is_a_line() {
        let text = trials_csv(&[trial(4000, 0.5), trial(1000, 3.0)]);
        assert_eq!(text.lines().count(), 3);
        assert!(!trials_csv(&[trial(1, f64::INFINITY)]).contains("inf"));
        assert!(text.contains("no normal map,false,false,4000,0,0,0,,16,12,16,0.5,0,,,0,,0\r\n"), "{text}");
    }
}
