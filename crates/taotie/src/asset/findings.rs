//! What a proof finds wrong, in plain words: how much of the surface, and where.

use super::figure::Figure;
use super::figures::{Figures, FitFigures};
use super::judgement::{INSIDE_OUT, useless_map};
use super::level_figures::LevelFigures;
use super::requirement::Requirement;
use super::shown::ShownLevel;
use crate::error::Warnings;
use crate::length::{Unit, place_text, texel_text};
use crate::names::Named;
use crate::proof::{Mismatch, Patch};

/// Shares of the area below this are noise: folds, thin cracks.
const WORTH_A_WORD: f64 = 0.01;
/// More of the surface missed than this is worth a warning.
const MISSED: f64 = 0.001;
/// Texels that are coarser than the scan's detail on a larger share than this lose something.
const COARSE: f64 = 0.005;
/// The mean differences of the worst window from which on it is worth a warning: degrees, and CIEDE2000.
const PATCH_DEG: f64 = 10.0;
const PATCH_COLOR: f64 = 3.0;
/// Metallic, roughness, emission and alpha that are off by more than this on average are worth a warning.
const MATERIAL: f64 = 0.1;
/// Normals that are off by more than this on average as seen, degrees, have a cause in the asset as a whole.
const OFF_DEG: f64 = 3.0;

/// Notes what the finest level of an asset shows otherwise than its scan.
pub(super) fn note(all: &Figures, level: &ShownLevel<'_>, warnings: &mut Warnings) {
    let Some(figures) = all.finest() else { return };
    let coordinates = |place| place_text(place, all.diagonal, all.unit);
    let is_off = figures.overview.angles.is_some_and(|angles| angles.summary.mean > OFF_DEG);
    if let Some(what) = mismatch(level, (all.fit, is_off), all.unit) {
        warnings.note(what, 1);
    }
    let there =
        |patch: &Patch| format!("in the worst 1 % of the surface, around {}", coordinates(patch.center));
    if level.lacks_material() {
        let what = "the asset states no colours and no material, but its scan does: what is compared with the scan is the \
                    default that viewers show";
        warnings.note(what, 1);
    }
    note_coverage(figures, &coordinates, warnings);
    let LevelFigures { patches, resolution, .. } = figures;
    if let Some(patch) = patches.angle.filter(|patch| patch.mean > PATCH_DEG) {
        let what = format!(
            "normals are off by {:.1}° on average {}: relief is lost, inverted or moved",
            patch.mean,
            there(&patch)
        );
        warnings.note(what, 1);
    }
    if let Some(patch) = patches.color.filter(|patch| patch.mean > PATCH_COLOR) {
        let what = format!("colours are off by ΔE {:.1} on average {}", patch.mean, there(&patch));
        warnings.note(what, 1);
    }
    for (name, found) in figures.material.numbers() {
        if let Some(found) = found.filter(|found| found.mean > MATERIAL) {
            warnings.note(format!("{name} is off by {:.2} on average", found.mean), 1);
        }
    }
    if let Some(resolution) = resolution.filter(|resolution| resolution.share > COARSE) {
        let (times, share) = (resolution.coarser, percent(resolution.share));
        let texel = texel_text(resolution.texel, all.unit);
        let what = format!(
            "texels, {texel} wide, are up to {times:.1} × coarser than the scan's detail on {share} of the surface; take a \
             larger map, or --size auto"
        );
        warnings.note(what, 1);
    }
    if level.parts.iter().any(|part| part.has_relief)
        && let (Some(with), Some(without)) = (&figures.surface_angles, &figures.without_map)
        && let Some(what) = useless_map(with, without)
    {
        warnings.note(what, 1);
    }
}

/// Returns in words how an asset as a whole differs from its scan; `None` if it does not. `fit` is the fit of its surface;
/// `is_off` is `true` if what is seen of it is far off.
pub(super) fn mismatch(
    level: &ShownLevel<'_>,
    (fit, is_off): (Option<FitFigures>, bool),
    unit: Option<Unit>,
) -> Option<String> {
    let scan = level.scan();
    let Some(found) = Mismatch::find(scan, &level.surface, is_off) else {
        let turned = fit.filter(|fit| fit.away < 0.5)?.turned;
        let what = format!(
            "the asset looks inside out: {} of it faces the other way than the scan beside it; reverse its triangles and \
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

/// Notes each requirement that is not met: what is wrong, and where most.
pub(super) fn note_unmet(all: &Figures, requirements: &[Requirement], warnings: &mut Warnings) {
    for met in all.require(requirements).iter().filter(|met| !met.met) {
        let number = met.level.unwrap_or_default();
        let Some((what, at)) = all.levels.get(number).and_then(|level| fault(met.figure, level)) else {
            continue;
        };
        let of_level =
            if all.levels.len() > 1 { format!(" at level of detail {number}") } else { String::new() };
        let place = place_text(at, all.diagonal, all.unit);
        warnings.note(format!("{}{of_level} {}: {what} around {place}", met.name(), met.text()), 1);
    }
}

/// Returns what is wrong if a figure of a level is beyond its limit, and the place where it is worst; `None` if that is not
/// known.
fn fault(figure: Figure, level: &LevelFigures) -> Option<(String, [f64; 3])> {
    match figure {
        Figure::Missed | Figure::Completeness => {
            level.coverage.missed_at.map(|at| ("one surface lacks most of the other".into(), at))
        }
        Figure::Hausdorff | Figure::WithinDistance | Figure::Silhouette => {
            level.hausdorff.at.map(|at| ("the surfaces are farthest apart".into(), at))
        }
        Figure::MeanColor | Figure::P95Color | Figure::PatchColor | Figure::WithinColor => {
            let patch = level.patches.color?;
            Some((format!("colours are off most, by ΔE {:.1} on average,", patch.mean), patch.center))
        }
        Figure::Texel | Figure::Bytes => None,
        _ => {
            let patch = level.patches.angle?;
            Some((format!("normals are off most, by {:.1}° on average,", patch.mean), patch.center))
        }
    }
}

fn note_coverage(figures: &LevelFigures, coordinates: &dyn Fn([f64; 3]) -> String, warnings: &mut Warnings) {
    let coverage = &figures.coverage;
    if coverage.is_interior {
        warnings.note(
            "the scan is an interior: what is compared is what can be seen from its largest free space",
            1,
        );
    }
    if coverage.hidden_of_scan > WORTH_A_WORD {
        let share = percent(coverage.hidden_of_scan);
        let what = format!(
            "{share} of the scan's area cannot be seen (hidden walls, ghost layers, duplicate shells or cavities); it is not \
             compared"
        );
        warnings.note(what, 1);
    }
    let place =
        coverage.missed_at.map_or_else(String::new, |at| format!(", most of it around {}", coordinates(at)));
    let missed = [
        (coverage.missed_of_scan, "of the scan's visible area has nothing in its place on the asset"),
        (coverage.missed_of_asset, "of the asset's visible area shows what the scan does not have there"),
    ];
    for (share, what) in missed.into_iter().filter(|(share, _)| *share > MISSED) {
        warnings.note(format!("{} {what}{place}", percent(share)), 1);
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}
