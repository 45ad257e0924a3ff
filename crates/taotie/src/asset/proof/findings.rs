//! The problems that a proof finds, in plain words: on how much of the surface, and where; and what it does not
//! compare.

use super::figures::{Coverage, Figures, FitFigures, LevelFigures};
use super::outcome::RequirementOutcome;
use super::shown::{Shading, ShownLevel};
use crate::asset::ask::requirement::{MISSED, PATCH_COLOR, PATCH_DEG, PATCH_DETAIL, PATCH_MATERIAL};
use crate::asset::ask::{Figure, Requirement};
use crate::asset::bake::{INSIDE_OUT, percent, useless_map};
use crate::asset::source::{Property, is_plain, used_materials};
use crate::asset::write::MapNote;
use taotie_engine::bake::TexturedMesh;
use taotie_engine::error::Warnings;
use taotie_engine::length::{Unit, place_text, texel_text};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::proof::{Mismatch, Patch};
use taotie_engine::scene::{LAYERS, Material, Scene, Specular};

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
    if let Some(what) = unlit(level) {
        warnings.note(
            format!("{what}; where only the asset is, its relief is not shown and counts as missed"),
            1,
        );
    }
    note_shading(level, warnings);
    if level.parts.iter().any(|part| part.has_relief)
        && let (Some(with), Some(without)) = (&figures.surface_angles, &figures.without_map)
        && let Some(what) = useless_map(with, without)
    {
        warnings.note(what, 1);
    }
}

/// Notes flat shading, which explains large angles, and what no figure shows: occlusion that only the asset has, if it is
/// dark, and blending of opaque surface, which viewers sort wrongly.
fn note_shading(level: &ShownLevel<'_>, warnings: &mut Warnings) {
    /// The mean light that baked occlusion hardly ever goes below.
    const DARK: f64 = 0.5;
    /// Shares of flat-shaded surface: nearly all of an asset, at most half of its scan.
    const FLAT: [f64; 2] = [0.99, 0.5];
    let surfaces = [&level.surface, level.scan()];
    let [of_asset, of_scan] = surfaces.map(|surface| Shading::of(surface.surface()));
    // A normal map may smooth flat triangles.
    let is_mapped = level.parts.iter().any(|part| part.has_relief);
    if !is_mapped && of_asset.flat > FLAT[0] && of_scan.flat < FLAT[1] {
        let what = "the asset is flat-shaded, and the scan's normals are smooth; if they are computed from a flat-shaded \
                    scan, a crease angle of 0 keeps it flat";
        warnings.note(what, 1);
    }
    if of_asset.occlusion < DARK && of_scan.occlusion == 1.0 {
        let what = format!(
            "the asset's occlusion texture, which the scan lacks, leaves {} of ambient light on average",
            percent(of_asset.occlusion)
        );
        warnings.note(what, 1);
    }
    if of_asset.needlessly_blended - of_scan.needlessly_blended > WORTH_A_WORD {
        let what = format!(
            "{} of the asset's surface is blended (alphaMode BLEND) although nothing shows through it: viewers may draw \
             far parts over near ones",
            percent(of_asset.needlessly_blended)
        );
        warnings.note(what, 1);
    }
}

/// Describes on how much of their surfaces an asset and its scan are unlit; `None` if on the same share.
pub(super) fn unlit(level: &ShownLevel<'_>) -> Option<String> {
    let [asset, scan] = [level.surface.surface(), level.scan().surface()].map(unlit_share);
    ((asset - scan).abs() > WORTH_A_WORD).then(|| {
        format!(
            "unlit look (KHR_materials_unlit), on {} of the asset's surface and {} of the scan's",
            percent(asset),
            percent(scan)
        )
    })
}

/// Returns the share of the area that is unlit, [0, 1].
fn unlit_share(surface: &TexturedMesh) -> f64 {
    let triangles = 0..surface.mesh().triangles().len() as u32;
    let is_unlit = |t: &u32| surface.material(*t).unlit;
    if !triangles.clone().any(|t| is_unlit(&t)) {
        return 0.0;
    }
    let area = |t: u32| {
        let [a, b, c] = surface.mesh().corners(t as usize).map(Vec3::to_f64);
        (b - a).cross(c - a).length()
    };
    let all: f64 = triangles.clone().map(area).sum();
    let unlit: f64 = triangles.filter(is_unlit).map(area).sum();
    if all > 0.0 { unlit / all } else { 0.0 }
}

/// Notes where an asset differs from its scan, which requirements are not met there, and other differences of its
/// finest level.
pub(super) fn note(all: &Figures, requirements: &[Requirement], warnings: &mut Warnings) {
    let Some(figures) = all.finest() else { return };
    note_coverage(&figures.coverage, warnings);
    note_worst_places(all, requirements, warnings);
    for (name, found) in figures.material.numbers() {
        if let Some(found) = found.filter(|found| found.mean > MATERIAL) {
            warnings.note(format!("{name} is off by {:.2} on average", found.mean), 1);
        }
    }
}

/// Notes texels that are coarser than the scan's detail.
pub(super) fn note_texels(all: &Figures, warnings: &mut Warnings) {
    let resolution = all.finest().and_then(|figures| figures.resolution);
    if let Some(resolution) = resolution.filter(|resolution| resolution.share > COARSE)
        && let Some(loss) = resolution.loss()
    {
        let texel = texel_text(resolution.texel, all.unit);
        warnings.note(format!("texels, {texel} wide, are {loss}; use a larger map, or --size auto"), 1);
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

/// A kind of difference at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    /// One surface lacks what the other shows.
    Missing,
    /// Normals are off.
    Normals,
    /// Colours are off.
    Colors,
    /// Metallic, roughness or occlusion is off.
    Material,
    /// Relief or colours are lost.
    Detail,
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
/// because of it, and then those that have no place, such as bytes. Faults of the finest level are noted even if all
/// requirements are met.
fn note_worst_places(all: &Figures, requirements: &[Requirement], warnings: &mut Warnings) {
    let unmet: Vec<RequirementOutcome> =
        all.evaluate(requirements).into_iter().filter(|met| !met.met).collect();
    for number in 0..all.levels.len() {
        let of_level =
            if all.levels.len() > 1 { format!(" at level of detail {number}") } else { String::new() };
        for place in places(all, number, &unmet) {
            let lists = lists(&place.unmet, &of_level).into_iter().chain([place.faults]);
            warnings.note(lists.collect::<Vec<_>>().join("; "), 1);
        }
    }
    let elsewhere: Vec<&RequirementOutcome> =
        unmet.iter().filter(|met| Fault::behind(met.figure).is_none()).collect();
    lists(&elsewhere, "").into_iter().for_each(|list| warnings.note(list, 1));
}

/// Returns the places where a level is worst.
fn places<'a>(all: &Figures, number: usize, unmet: &'a [RequirementOutcome]) -> Vec<Place<'a>> {
    let level = &all.levels[number];
    let mut places: Vec<Place<'_>> = Vec::new();
    for fault in [Fault::Missing, Fault::Normals, Fault::Colors, Fault::Material, Fault::Detail, Fault::Apart]
    {
        let is_its =
            |met: &&RequirementOutcome| met.level == Some(number) && Fault::behind(met.figure) == Some(fault);
        let unmet: Vec<&RequirementOutcome> = unmet.iter().filter(is_its).collect();
        if unmet.is_empty() && (number > 0 || !fault.is_large(level)) {
            continue;
        }
        let what = fault.text(level).or_else(|| (!unmet.is_empty()).then(|| "a figure is undecided".into()));
        let Some(what) = what else { continue };
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
            Figure::Completeness | Figure::Hausdorff | Figure::WithinDistance => Some(Self::Apart),
            Figure::MeanColor | Figure::P95Color | Figure::PatchColor | Figure::WithinColor => {
                Some(Self::Colors)
            }
            Figure::MeanMaterial | Figure::PatchMaterial => Some(Self::Material),
            Figure::PatchDetail => Some(Self::Detail),
            Figure::Silhouette | Figure::Texel | Figure::Triangles | Figure::GpuMemory | Figure::Bytes => {
                None
            }
            _ => Some(Self::Normals),
        }
    }

    /// Returns the window in which it is worst.
    fn patch(self, level: &LevelFigures) -> Option<Patch> {
        let patches = &level.patches;
        match self {
            Self::Missing | Self::Apart => None,
            Self::Normals => patches.angle,
            Self::Colors => patches.color,
            Self::Material => patches.material,
            Self::Detail => patches.detail,
        }
    }

    /// Returns `true` if the fault warrants a warning even if no requirement limits it.
    fn is_large(self, level: &LevelFigures) -> bool {
        let most = match self {
            Self::Missing => return level.coverage.missed() > MISSED,
            Self::Apart => return false,
            Self::Normals => PATCH_DEG,
            Self::Colors => PATCH_COLOR,
            Self::Material => PATCH_MATERIAL,
            Self::Detail => PATCH_DETAIL,
        };
        self.patch(level).is_some_and(|patch| patch.mean > most)
    }

    /// Describes the fault; `None` if unknown.
    fn text(self, level: &LevelFigures) -> Option<String> {
        let mean = self.patch(level).map(|patch| patch.mean);
        match self {
            Self::Missing => missing(&level.coverage),
            Self::Normals => mean.map(|mean| format!("normals are off by {mean:.1}° on average")),
            Self::Colors => mean.map(|mean| format!("colours are off by ΔE {mean:.1} on average")),
            Self::Material => {
                let off = percent(mean?);
                Some(format!("metallic, roughness or occlusion is off by {off} on average"))
            }
            Self::Detail => mean.map(|lost| {
                format!("{} of the relief or of the colours is lost or added", percent(lost.min(1.0)))
            }),
            Self::Apart => level.hausdorff.at.map(|_| "the surfaces are farthest apart".into()),
        }
    }

    /// Returns the place where it is worst, model units; `None` if unknown.
    fn place(self, level: &LevelFigures) -> Option<[f64; 3]> {
        match self {
            Self::Missing => level.coverage.missed_at,
            Self::Apart => level.hausdorff.at,
            _ => self.patch(level).map(|patch| patch.center),
        }
    }

    /// Returns how much of the fault is at its place, in words that precede the place.
    fn extent(self) -> &'static str {
        match self {
            Self::Missing => ", most of it",
            Self::Normals | Self::Colors | Self::Material | Self::Detail => {
                " in the worst 1 % of the surface,"
            }
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

/// Occlusion, among the contents that are not compared.
pub(super) const OCCLUSION: &str = "ambient occlusion, whose map only its bake measures";

/// Returns the contents of an asset's files, or of its scan, that no figure and no image compares; `poses` if one of
/// them moves.
pub(super) fn unseen([scan, asset]: [&Scene; 2], poses: bool) -> Vec<String> {
    let plain = is_plain(scan).then_some("colour and material, which the scan does not specify");
    let poses = poses.then_some("poses and variants: only the default ones are compared");
    let has_occlusion =
        |scene: &Scene| used_materials(scene).any(|material| material.occlusion_texture.is_some());
    let occlusion = (has_occlusion(asset) && !has_occlusion(scan)).then_some(OCCLUSION);
    let all = plain.into_iter().chain(poses).chain(occlusion).map(str::to_owned);
    all.chain(
        layers([scan, asset])
            .into_iter()
            .map(|(name, of)| of.map_or(name.into(), |of| format!("{name}, {of}"))),
    )
    .collect()
}

/// Returns the layers of materials that no figure compares, each with the words for it if only one of the two has it.
fn layers([scan, asset]: [&Scene; 2]) -> Vec<(&'static str, Option<&'static str>)> {
    let layer = |property: Property| match property {
        Property::Layer(layer) => LAYERS.get(layer).filter(|layer| layer.is_optional()),
        _ => None,
    };
    let reflects = |material: &Material| material.specular != Specular::default() || material.ior != 1.5;
    let found = Property::all().into_iter().filter_map(layer).map(|layer| {
        (
            layer.name,
            [scan, asset].map(|scene| used_materials(scene).any(|material| layer.is_present(material))),
        )
    });
    let reflection = [scan, asset].map(|scene| used_materials(scene).any(reflects));
    // Bakes leave a scan's lights out.
    let lights = [false, scan.lights().is_empty() && !asset.lights().is_empty()];
    let all = found.chain([("specular strength and index of refraction", reflection), ("lights", lights)]);
    all.filter(|(_, has)| has.contains(&true))
        .map(|(name, has)| match has {
            [true, true] => (name, None),
            [true, false] => (name, Some("which only the scan has")),
            _ => (name, Some("which only the asset has")),
        })
        .collect()
}

/// Notes layers of materials that only one of the two has: it may look different, although no figure shows it.
pub(super) fn note_layers(scenes: [&Scene; 2], warnings: &mut Warnings) {
    for (name, of) in layers(scenes) {
        if let Some(of) = of {
            warnings
                .note(format!("not compared: {name}, {of}; the asset may look different from the scan"), 1);
        }
    }
}

/// Notes that an asset lacks the backs of its scan's double-sided surfaces, if it lacks anything.
pub(super) fn note_sides([scan, asset]: [&Scene; 2], figures: &Figures, warnings: &mut Warnings) {
    let is_double = |scene: &Scene| used_materials(scene).any(|material| material.double_sided);
    let lacks = figures.finest().is_some_and(|figures| figures.coverage.missed_of_scan > MISSED);
    let what = "the asset has no backs, unlike the double-sided scan: make its materials double-sided";
    warnings.note(what, usize::from(lacks && is_double(scan) && !is_double(asset)));
}

/// Returns the maps of an asset that are not compared with anything.
pub(super) fn unproved_maps(maps: &[MapNote]) -> Vec<String> {
    let mut unproved: Vec<String> = Vec::new();
    for note in maps.iter().filter(|note| note.is_in_no_figure() && note.error.is_none()) {
        let name = match note.packed {
            Some(_) => note.title(),
            None => format!("{} map", note.title()),
        };
        if !unproved.contains(&name) {
            unproved.push(name);
        }
    }
    unproved
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::proof::Patch;
    use taotie_engine::scene::Clearcoat;

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
        note_worst_places(&figures, &requirements, &mut warnings);
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

    fn ball(material: Material) -> Scene {
        Scene::of_mesh(Mesh::sphere(1.0, 8, 4), material).unwrap()
    }

    #[test]
    fn lacking_backs_are_explained() {
        let with = |double_sided| ball(Material { double_sided, ..Material::default() });
        let mut level = LevelFigures::default();
        level.coverage.missed_of_scan = 0.5;
        let figures = Figures { levels: vec![level], ..Figures::default() };
        for (figures, of_asset, wanted) in
            [(&figures, false, 1), (&figures, true, 0), (&Figures::default(), false, 0)]
        {
            let mut warnings = Warnings::default();
            note_sides([&with(true), &with(of_asset)], figures, &mut warnings);
            assert_eq!(warnings.iter().count(), wanted);
        }
    }

    #[test]
    fn what_no_figure_covers_is_named() {
        let coat = Clearcoat { factor: 1.0, ..Clearcoat::default() };
        let plain = ball(Material::default());
        let coated = ball(Material { clearcoat: Some(coat), ..Material::default() });
        let plainly = "colour and material, which the scan does not specify";
        assert_eq!(unseen([&plain, &plain], false), [plainly]);
        assert_eq!(unseen([&coated, &coated], false), ["clearcoat"]);
        assert_eq!(unseen([&coated, &plain], false), ["clearcoat, which only the scan has"]);
        let mut warnings = Warnings::default();
        note_layers([&plain, &coated], &mut warnings);
        let what =
            "not compared: clearcoat, which only the asset has; the asset may look different from the scan";
        assert!(warnings.iter().map(|(what, _)| what).eq([what]), "{warnings:?}");
        assert_eq!(
            unseen([&plain, &plain], true)[1],
            "poses and variants: only the default ones are compared"
        );
    }
}
