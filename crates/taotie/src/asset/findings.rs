//! The problems that a proof finds, in plain words: on how much of the surface, and where.

use super::figures::{Figures, FitFigures};
use super::judgement::{INSIDE_OUT, useless_map};
use super::level_figures::Coverage;
use super::requirement::Requirement;
use super::shown::ShownLevel;
use super::worst_places;
use crate::error::Warnings;
use crate::length::{Unit, place_text, texel_text};
use crate::names::Named;
use crate::proof::Mismatch;

/// Shares of the area below this are noise: folds, thin cracks.
const WORTH_A_WORD: f64 = 0.01;
/// The share of the surface above which texels coarser than the scan's detail lose something.
const COARSE: f64 = 0.005;
/// Metallic, roughness, emission and alpha that are off by more than this on average cause a warning.
const MATERIAL: f64 = 0.1;
/// Visible normals that are off by more than this on average, degrees, have a cause in the asset as a whole.
const OFF_DEG: f64 = 3.0;

/// Notes problems of an asset's finest level as a whole: its place, axes and unit, its material, and its map.
pub(super) fn note_whole(all: &Figures, level: &ShownLevel<'_>, warnings: &mut Warnings) {
    let Some(figures) = all.finest() else { return };
    let is_off = figures.overview.angles.is_some_and(|angles| angles.summary.mean > OFF_DEG);
    if let Some(what) = mismatch(level, (all.fit, is_off), all.unit) {
        warnings.note(what, 1);
    }
    if level.lacks_material() {
        let what = "the asset has no colours and no material, but its scan does: the scan is compared with the \
                    default that viewers show";
        warnings.note(what, 1);
    }
    if level.parts.iter().any(|part| part.has_relief)
        && let (Some(with), Some(without)) = (&figures.surface_angles, &figures.without_map)
        && let Some(what) = useless_map(with, without)
    {
        warnings.note(what, 1);
    }
}

/// Notes where an asset differs from its scan, which requirements are not met there, and other differences of its
/// finest level.
pub(super) fn note(all: &Figures, requirements: &[Requirement], warnings: &mut Warnings) {
    let Some(figures) = all.finest() else { return };
    note_coverage(&figures.coverage, warnings);
    worst_places::note(all, requirements, warnings);
    for (name, found) in figures.material.numbers() {
        if let Some(found) = found.filter(|found| found.mean > MATERIAL) {
            warnings.note(format!("{name} is off by {:.2} on average", found.mean), 1);
        }
    }
}

/// Notes texels that are coarser than the scan's detail.
pub(super) fn note_texels(all: &Figures, warnings: &mut Warnings) {
    let resolution = all.finest().and_then(|figures| figures.resolution);
    if let Some(resolution) = resolution.filter(|resolution| resolution.share > COARSE) {
        let (times, share) = (resolution.coarser, percent(resolution.share));
        let texel = texel_text(resolution.texel, all.unit);
        let what = format!(
            "texels, {texel} wide, are up to {times:.1} × coarser than the scan's detail on {share} of the surface; use a \
             larger map, or --size auto"
        );
        warnings.note(what, 1);
    }
}

/// Describes how an asset as a whole differs from its scan; `None` if it does not. `fit` is the fit of its surface;
/// `is_off` is `true` if its visible normals are far off.
pub(super) fn mismatch(
    level: &ShownLevel<'_>,
    (fit, is_off): (Option<FitFigures>, bool),
    unit: Option<Unit>,
) -> Option<String> {
    let scan = level.scan();
    let Some(found) = Mismatch::find(scan, &level.surface, is_off) else {
        let turned = fit.filter(|fit| fit.away < 0.5)?.turned;
        let what = format!(
            "the asset looks inside out: {} of it faces the opposite way to the nearby scan; reverse its triangles and \
             normals",
            percent(turned)
        );
        return (turned > INSIDE_OUT).then_some(what);
    };
    let size = found.units.map(|[asset, scan]| {
        let (ratio, than) =
            if found.size() < 1.0 { (1.0 / found.size(), "smaller") } else { (found.size(), "larger") };
        let ratio = (ratio * 100.0).round() / 100.0;
        format!("{ratio} times {than} ({} instead of {})", asset.name(), scan.name())
    });
    let moved = found.moved.map(|by| format!("moved by {}", place_text(by, scan.mesh().diagonal(), unit)));
    let changes: Vec<String> = [found.axes_text(), size, moved].into_iter().flatten().collect();
    let distance = match found.distance {
        part if part < 1.0 => format!("{:.2} %", part * 100.0),
        part => format!("{part:.0} diagonals"),
    };
    Some(format!(
        "the asset looks {}: without that, asset and scan are {:.2} % of the diagonal apart on average instead of {distance}",
        changes.join(" and "),
        found.without * 100.0
    ))
}

fn note_coverage(coverage: &Coverage, warnings: &mut Warnings) {
    if coverage.is_interior {
        warnings.note(
            "the scan is an interior: only what can be seen from its largest free space is compared",
            1,
        );
    }
    if coverage.hidden_of_scan > WORTH_A_WORD {
        let share = percent(coverage.hidden_of_scan);
        let what = format!(
            "{share} of the scan's area cannot be seen (hidden walls, ghost layers, duplicate shells or cavities) and is not \
             compared"
        );
        warnings.note(what, 1);
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}
