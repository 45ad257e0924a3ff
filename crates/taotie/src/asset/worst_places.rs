//! The places where a level of detail differs most from its scan, each with the requirements that fail because of it.

use super::figure::Figure;
use super::figures::Figures;
use super::level_figures::{Coverage, LevelFigures};
use super::met::RequirementOutcome;
use super::requirement::Requirement;
use crate::error::Warnings;
use crate::length::place_text;

/// A larger missed share of the surface than this causes a warning.
const MISSED: f64 = 0.001;
/// The mean differences of the worst window above which there is a warning: degrees, and CIEDE2000.
const PATCH_DEG: f64 = 10.0;
const PATCH_COLOR: f64 = 3.0;

/// A kind of difference at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    /// One surface lacks what the other shows.
    Missing,
    /// Normals are off.
    Normals,
    /// Colours are off.
    Colors,
    /// The surfaces are apart.
    Apart,
}

/// A place where a level is worst, with all faults there.
struct Place<'a> {
    /// As displayed; empty if unknown.
    at: String,
    faults: String,
    unmet: Vec<&'a RequirementOutcome>,
}

/// Notes where each level of detail differs most from its scan, once per place, with all requirements that fail
/// because of it. Faults of the finest level are noted even if all requirements are met.
pub(super) fn note(all: &Figures, requirements: &[Requirement], warnings: &mut Warnings) {
    let unmet: Vec<RequirementOutcome> =
        all.require(requirements).into_iter().filter(|met| !met.met).collect();
    for number in 0..all.levels.len() {
        let of_level =
            if all.levels.len() > 1 { format!(" at level of detail {number}") } else { String::new() };
        for place in places(all, number, &unmet) {
            let lists = lists(&place.unmet, &of_level).into_iter().chain([place.faults]);
            warnings.note(lists.collect::<Vec<_>>().join("; "), 1);
        }
    }
}

/// Returns the places where a level is worst.
fn places<'a>(all: &Figures, number: usize, unmet: &'a [RequirementOutcome]) -> Vec<Place<'a>> {
    let level = &all.levels[number];
    let mut places: Vec<Place<'_>> = Vec::new();
    for fault in [Fault::Missing, Fault::Normals, Fault::Colors, Fault::Apart] {
        let is_its =
            |met: &&RequirementOutcome| met.level == Some(number) && Fault::behind(met.figure) == Some(fault);
        let unmet: Vec<&RequirementOutcome> = unmet.iter().filter(is_its).collect();
        if unmet.is_empty() && (number > 0 || !fault.is_large(level)) {
            continue;
        }
        let Some(what) = fault.text(level) else { continue };
        let at = fault.place(level).map_or_else(String::new, |at| place_text(at, all.diagonal, all.unit));
        match places.iter_mut().find(|place| place.at == at) {
            Some(place) => {
                place.faults += &format!("; {what} there");
                place.unmet.extend(unmet);
            }
            None if at.is_empty() => places.push(Place { at, faults: what, unmet }),
            None => {
                let faults = format!("{what}{} around {at}{}", fault.extent(), fault.cause(level));
                places.push(Place { at, faults, unmet });
            }
        }
    }
    places
}

/// Returns a list of the requirements that are not met, and one of those that are undecided.
fn lists(unmet: &[&RequirementOutcome], of_level: &str) -> Vec<String> {
    let (undecided, failed): (Vec<&RequirementOutcome>, Vec<&RequirementOutcome>) =
        unmet.iter().partition(|met| met.is_undecided());
    let list = |(are, met): (&str, Vec<&RequirementOutcome>)| {
        let items: Vec<String> = met.iter().map(|met| met.in_list()).collect();
        let name = if items.len() == 1 { "requirement" } else { "requirements" };
        (!items.is_empty()).then(|| format!("{name} {are}{of_level}: {}", items.join(", ")))
    };
    [("not met", failed), ("undecided", undecided)].into_iter().filter_map(list).collect()
}

impl Fault {
    /// Returns the fault that a figure measures; `None` for figures without a place.
    fn behind(figure: Figure) -> Option<Self> {
        match figure {
            Figure::Missed => Some(Self::Missing),
            Figure::Completeness | Figure::Hausdorff | Figure::WithinDistance | Figure::Silhouette => {
                Some(Self::Apart)
            }
            Figure::MeanColor | Figure::P95Color | Figure::PatchColor | Figure::WithinColor => {
                Some(Self::Colors)
            }
            Figure::Texel | Figure::Triangles | Figure::GpuMemory | Figure::Bytes => None,
            _ => Some(Self::Normals),
        }
    }

    /// Returns `true` if the fault warrants a warning even if no requirement limits it.
    fn is_large(self, level: &LevelFigures) -> bool {
        match self {
            Self::Missing => level.coverage.missed() > MISSED,
            Self::Apart => false,
            Self::Normals => level.patches.angle.is_some_and(|patch| patch.mean > PATCH_DEG),
            Self::Colors => level.patches.color.is_some_and(|patch| patch.mean > PATCH_COLOR),
        }
    }

    /// Describes the fault; `None` if unknown.
    fn text(self, level: &LevelFigures) -> Option<String> {
        match self {
            Self::Missing => missing(&level.coverage),
            Self::Normals => {
                level.patches.angle.map(|patch| format!("normals are off by {:.1}° on average", patch.mean))
            }
            Self::Colors => {
                level.patches.color.map(|patch| format!("colours are off by ΔE {:.1} on average", patch.mean))
            }
            Self::Apart => level.hausdorff.at.map(|_| "the surfaces are farthest apart".into()),
        }
    }

    /// Returns the place where it is worst, model units; `None` if unknown.
    fn place(self, level: &LevelFigures) -> Option<[f64; 3]> {
        match self {
            Self::Missing => level.coverage.missed_at,
            Self::Normals => level.patches.angle.map(|patch| patch.center),
            Self::Colors => level.patches.color.map(|patch| patch.center),
            Self::Apart => level.hausdorff.at,
        }
    }

    /// Returns how much of the fault is at its place, in words that precede the place.
    fn extent(self) -> &'static str {
        match self {
            Self::Missing => ", most of it",
            Self::Normals | Self::Colors => " in the worst 1 % of the surface,",
            Self::Apart => "",
        }
    }

    /// Returns the likely cause of the fault, for the first one of a place.
    fn cause(self, level: &LevelFigures) -> &'static str {
        if self == Self::Normals && self.is_large(level) { ": relief is lost, inverted or moved" } else { "" }
    }
}

/// Returns how much each surface lacks; only the worse one if both lack little, and `None` if nothing is missing.
fn missing(coverage: &Coverage) -> Option<String> {
    let most = coverage.missed();
    let decimals = if most > MISSED { 1 } else { 4 };
    let shares = [
        (coverage.missed_of_scan, "of the scan's visible area has no counterpart on the asset"),
        (coverage.missed_of_asset, "of the asset's visible area has no counterpart on the scan"),
    ];
    let texts: Vec<String> = shares
        .into_iter()
        .filter(|(share, _)| *share > MISSED || *share == most)
        .map(|(share, what)| format!("{:.decimals$} % {what}", share * 100.0))
        .collect();
    (most > 0.0).then(|| texts.join(", and "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proof::Patch;

    fn level() -> LevelFigures {
        let mut level = LevelFigures::default();
        let patch =
            |mean: f64| Patch { mean, interval: [mean; 2], center: [1.0, 2.0, 3.0], ..Patch::default() };
        (level.patches.angle, level.patches.color) = (Some(patch(14.23)), Some(patch(2.0)));
        level.hausdorff.at = Some([4.0, 5.0, 6.0]);
        level
    }

    fn warned(levels: Vec<LevelFigures>, requirements: &str) -> Vec<String> {
        let figures = Figures { levels, diagonal: 10.0, ..Figures::default() };
        let read = |text| Requirement::read(text).unwrap();
        let requirements: Vec<Requirement> =
            requirements.split(',').filter(|text| !text.is_empty()).flat_map(read).collect();
        let mut warnings = Warnings::default();
        note(&figures, &requirements, &mut warnings);
        warnings.iter().map(|(what, _)| what.to_owned()).collect()
    }

    #[test]
    fn all_requirements_that_a_place_misses_are_one_warning() {
        let normals = "normals are off by 14.2° on average in the worst 1 % of the surface, around (1.00, 2.00, 3.00): \
                       relief is lost, inverted or moved";
        assert_eq!(warned(vec![level()], ""), [normals]);
        assert_eq!(warned(vec![level()], "patch-angle=15"), [normals]);
        let mut elsewhere = level();
        elsewhere.patches.color.as_mut().unwrap().center[0] = 4.0;
        let found =
            warned(vec![elsewhere], "patch-angle=10,patch-color=1,mean-angle=1,bytes=0,patch-color=3");
        let colors = "requirement not met: patch-color 2 ΔE (at most 1 ΔE); colours are off by ΔE 2.0 on average in the \
                      worst 1 % of the surface, around (4.00, 2.00, 3.00)";
        let unmet =
            "requirements not met: patch-angle 14.23° (at most 10°), mean-angle not measured (at most 1°); ";
        assert_eq!(found, [format!("{unmet}{normals}"), colors.into()]);
    }

    #[test]
    fn undecided_requirements_are_a_list_of_their_own() {
        let mut undecided = level();
        (undecided.hausdorff_of_diagonal.lower, undecided.hausdorff_of_diagonal.upper) = (0.003, 0.005);
        undecided.patches.angle = None;
        let found = warned(vec![undecided], "hausdorff=0.4,completeness=99%");
        assert_eq!(
            found,
            [
                "requirement not met: completeness 0 % (at least 99 %); requirement undecided: hausdorff between 0.3 % and \
              0.5 % (at most 0.4 %); the surfaces are farthest apart around (4.00, 5.00, 6.00)"
            ]
        );
    }

    #[test]
    fn coarser_levels_have_warnings_only_if_they_are_limited() {
        let found = warned(vec![LevelFigures::default(), level()], "");
        assert!(found.is_empty(), "{found:?}");
        let found = warned(vec![LevelFigures::default(), level()], "patch-angle@1=10");
        let start =
            "requirement not met at level of detail 1: patch-angle 14.23° (at most 10°); normals are off";
        assert!(found.len() == 1 && found[0].starts_with(start), "{found:?}");
    }

    #[test]
    fn missing_parts_of_both_are_one_warning() {
        let of = |[scan, asset]: [f64; 2], requirements: &str| {
            let mut level = LevelFigures::default();
            (level.coverage.missed_of_scan, level.coverage.missed_of_asset) = (scan, asset);
            level.coverage.missed_interval = [scan.max(asset); 2];
            level.coverage.missed_at = Some([1.0, 2.0, 3.0]);
            warned(vec![level], requirements)
        };
        let both = "12.0 % of the scan's visible area has no counterpart on the asset, and 3.0 % of the asset's visible \
                    area has no counterpart on the scan, most of it around (1.00, 2.00, 3.00)";
        assert_eq!(of([0.12, 0.03], ""), [both]);
        let unmet = "requirement not met: missed 12 % (at most 0.1 %); ";
        assert_eq!(of([0.12, 0.03], "missed=0.1%"), [format!("{unmet}{both}")]);
        let little = "requirement not met: missed 0.05 % (at most 0.01 %); 0.0500 % of the asset's visible area has no \
                      counterpart on the scan, most of it around (1.00, 2.00, 3.00)";
        assert_eq!(of([0.0, 0.0005], "missed=0.01%"), [little]);
        assert!(of([0.0; 2], "missed=0.01%").is_empty() && of([0.0005; 2], "").is_empty());
    }

    #[test]
    fn faults_of_one_place_are_one_warning() {
        let mut level = level();
        (level.coverage.missed_of_scan, level.coverage.missed_interval) = (0.12, [0.12; 2]);
        level.coverage.missed_at = Some([1.0, 2.0, 3.0]);
        let found = warned(vec![level], "missed=0.1%,patch-angle=10,patch-color=1");
        let text = "requirements not met: missed 12 % (at most 0.1 %), patch-angle 14.23° (at most 10°), patch-color 2 ΔE (at \
                    most 1 ΔE); 12.0 % of the scan's visible area has no counterpart on the asset, most of it around \
                    (1.00, 2.00, 3.00); normals are off by 14.2° on average there; colours are off by ΔE 2.0 on average there";
        assert_eq!(found, [text]);
    }
}
