//! Faults of a pair of meshes, in plain words and with numbers. A bad map is never baked silently.

use crate::asset::source::{Extent, Pair, Scan, Spot, Whole, turned};
use taotie_engine::bake::{self, Astray, BakeCounts, BakedMaps, Cage, Faults, Fit, TexelStatus, Verifier};
use taotie_engine::compare::Summary;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::length::{ShownLength, Unit};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::Mesh;
use taotie_engine::surface::{HardEdges, Opposed};

/// Points at which the pair is examined.
const POINTS: usize = 4_000;
/// A larger fraction of missing texels than this causes a warning.
const MISSED: f64 = 0.001;
/// A larger fraction of the low-poly mesh far away or reversed than this causes a warning.
const PART: f64 = 0.02;
/// Meshes with a larger fraction far away than this do not overlap.
const APART: f64 = 0.9;
/// The distance, as a fraction of the diagonal, beyond which two surfaces are considered unrelated. For coarser
/// meshes it is [`OF_SIDE`] of the diagonal divided by the square root of their triangle count: about half a
/// triangle's side.
const FAR: f64 = 0.02;
const OF_SIDE: f64 = 0.5;
/// The fraction far from the other mesh above which a generated mesh, or its scan, is refused. Measured on 28 models
/// by others at 12 to 1,000 triangles: sound meshes have at most 25 %, a head of 36 triangles and a camera with many
/// thin parts at 508; nearly all have less than 1 %. A sword of 50 triangles that lost half its blade has 43 %, and
/// the remains of balls with unwelded seams or in loose triangles have 40 to 99 %.
const MOST_FAR: f64 = 1.0 / 3.0;
/// A part of the scan is missing if the low-poly mesh is farther from it than this fraction of the diagonal.
const MISSING: f64 = 0.01;
/// Points of the scan tested for missing parts.
const SCAN_POINTS: usize = 8_192;
/// The minimum number of points that make up a part.
const LEAST_POINTS: usize = 4;
/// A larger fraction of total edge length in hard edges inside UV islands than this causes a warning.
const HARD: f64 = 0.001;
/// An asset with a larger fraction facing the opposite way than this is inside out as a whole.
pub(in crate::asset) const INSIDE_OUT: f64 = 0.9;

/// Refuses maps that show nothing of the scan.
///
/// # Errors
/// [`Error::Invalid`] if no triangle covers a texel, or no ray met the scan.
pub(super) fn refuse_no_hit(pair: Pair<'_>, cage: &Cage, counts: &BakeCounts) -> Result<()> {
    let what = "the low-poly mesh";
    if counts.samples == 0 {
        let triangles = pair.low.mesh.triangles().len();
        let why = format!(
            "none of its {triangles} triangles covers a texel of the map ({} without uv area); unwrap it, or use a \
             larger map",
            counts.flat
        );
        return Err(Error::invalid(what, why));
    }
    if counts.missed < counts.samples {
        return Ok(());
    }
    if cage.matches_uvs() {
        let why =
            "none of its texels has a point of the scan with the same uv; give both meshes the same uvs";
        return Err(Error::invalid(what, why));
    }
    let faults: Vec<String> = misfits(pair, cage).into_iter().map(|fault| format!("; {fault}")).collect();
    let why = format!(
        "none of its {} projection rays met the scan, at most {} to either side{}; align the meshes, or use a \
         larger ray distance or a cage",
        counts.samples,
        ShownLength::of(cage.longest().into(), pair.scan.unit(), 3),
        faults.concat()
    );
    Err(Error::invalid(what, why))
}

/// Refuses a generated low-poly mesh that does not match the scan's shape, or only part of it. The scan must be
/// sorted.
///
/// # Errors
/// [`Error::Invalid`] with the fraction of each mesh that is far from the other, or if one of them has no area.
pub(in crate::asset) fn refuse_astray(Pair { scan, low }: Pair<'_>) -> Result<()> {
    let triangles = low.mesh.triangles().len();
    let far = FAR.max(OF_SIDE / (triangles as f64).sqrt());
    let astray = Astray::measure(&low.mesh, scan.sorted(), far * scan.mesh().diagonal())?;
    let Astray { low: of_low, scan: of_scan } = astray;
    if of_low <= MOST_FAR && of_scan <= MOST_FAR {
        return Ok(());
    }
    let why = format!(
        "simplification lost the scan's shape: {} of the mesh is farther than {} of the diagonal from the scan, and {} \
         of the scan is that far from the mesh; use more triangles, or repair the scan: weld its vertices, close its \
         holes and remove loose triangles",
        percent(of_low),
        percent(far),
        percent(of_scan)
    );
    Err(Error::invalid(format!("a low-poly mesh of {triangles} triangles"), why))
}

/// Notes problems of a pair and of its bake.
pub(in crate::asset) fn judge(pair: Pair<'_>, cage: &Cage, counts: &BakeCounts, warnings: &mut Warnings) {
    for misfit in misfits(pair, cage) {
        warnings.note(misfit, 1);
    }
    let missed = part(counts.missed_texels, counts.texels);
    if missed > MISSED && cage.matches_uvs() {
        let what = "of the texels have no point of the scan with the same uv and keep the low-poly mesh's own normal; the \
                    report shows where; give both meshes the same uvs";
        warnings.note(format!("{} {what}", percent(missed)), 1);
    } else if missed > MISSED {
        warnings.note(
            format!(
                "{} of the texels have rays that missed the scan: {} of all rays used its closest point, {} had no hit and \
                 kept the low-poly mesh's own normal; the report shows where; a larger ray distance or a cage may reach \
                 farther",
                percent(missed),
                percent(part(counts.missed - counts.lost, counts.samples)),
                percent(part(counts.lost, counts.samples))
            ),
            1,
        );
    }
    if counts.shared > counts.samples / 1000 {
        let advice = match pair.low.origin.islands {
            Some(_) => "use a larger map",
            None => "unwrap the low-poly mesh without overlaps",
        };
        warnings.note(
            format!(
                "{} of the map is under more than one triangle: UV islands overlap, and each place has the relief of \
                 one of them; {advice}",
                percent(part(counts.shared, counts.samples))
            ),
            1,
        );
    }
    warnings.note("triangles of the low-poly mesh without uv area, which get no relief", counts.flat);
    let turned = turned(&pair.low.mesh);
    match is_made(pair) {
        true => warnings.note(
            "triangles folded over by simplification; a different triangle count may avoid that",
            turned.len(),
        ),
        false => judge_given(pair, &turned, warnings),
    }
}

/// Notes problems of a given low-poly mesh, some of whose triangles face away from their normals.
fn judge_given(Pair { scan, low }: Pair<'_>, turned: &[usize], warnings: &mut Warnings) {
    let unit = scan.unit();
    if let Some(extent) = extent_of(&low.mesh, unit, turned) {
        let what = "triangles of the low-poly mesh that face away from their own normals";
        warnings.note(format!("{what}: {extent}"), turned.len());
    }
    let Opposed { reversed, doubtful } = Opposed::of(&low.mesh);
    let opposed: Vec<usize> = reversed.into_iter().chain(doubtful).map(|t| t as usize).collect();
    if let Some(extent) = extent_of(&low.mesh, unit, &opposed) {
        let what = "triangles of the low-poly mesh wound opposite to their neighbours";
        warnings.note(format!("{what}: {extent}; make their winding consistent"), opposed.len());
    }
    if low.origin.islands.is_none() {
        note_hard_edges(&low.mesh, unit, warnings);
    }
}

/// Notes hard edges inside UV islands, where texels of both sides are blended.
fn note_hard_edges(low: &Mesh, unit: Option<Unit>, warnings: &mut Warnings) {
    let HardEdges { inside, length } = HardEdges::inside_islands(low);
    let spots: Vec<Spot> =
        inside.iter().map(|[a, b]| Spot { at: (*a + *b) * 0.5, amount: (*b - *a).length() }).collect();
    let whole = Whole { amount: length, diagonal: low.diagonal(), unit };
    if let Some(extent) = Extent::of(&spots, whole).filter(|extent| extent.share > HARD) {
        let text = format!(
            "hard edges inside UV islands of the low-poly mesh: {} of the length of its edges, around {}; the map blends \
             both sides there; split the uvs at these edges, or smooth them",
            extent.percent(),
            extent.place()
        );
        warnings.note(text, 1);
    }
}

/// Returns the extent of some triangles of a mesh; `None` if there are none.
fn extent_of(mesh: &Mesh, unit: Option<Unit>, triangles: &[usize]) -> Option<Extent> {
    let spots: Vec<Spot> = triangles.iter().map(|t| Spot::of_triangle(mesh, *t, &Mat4::IDENTITY)).collect();
    if spots.is_empty() { None } else { Extent::of(&spots, Whole::of_mesh(mesh, unit)) }
}

/// Notes parts of the scan that the whole low-poly mesh lacks, such as thin ones that simplification removed. Meshes
/// that are entirely apart are left to [`judge`]. Sorts the scan if necessary.
pub(in crate::asset) fn note_missing_parts(scan: &Scan, low: &Mesh, is_made: bool, warnings: &mut Warnings) {
    let diagonal = scan.mesh().diagonal();
    let points = bake::uncovered(scan.sorted(), low, SCAN_POINTS, MISSING * diagonal);
    if points.len() < LEAST_POINTS || points.len() > SCAN_POINTS / 2 {
        return;
    }
    let spots: Vec<Spot> = points.into_iter().map(|at| Spot { at, amount: 1.0 }).collect();
    let whole = Whole { amount: SCAN_POINTS as f64, diagonal, unit: scan.unit() };
    let Some(extent) = Extent::of(&spots, whole) else { return };
    let advice = if is_made { "use more triangles" } else { "add them to it, or remove them from the scan" };
    let text = format!(
        "the low-poly mesh lacks parts of the scan: it has nothing within 1 % of the diagonal of {} of the scan's surface, \
         around {}; {advice}",
        extent.percent(),
        extent.place()
    );
    warnings.note(text, 1);
}

/// Returns a warning if a normal map does not reduce the normal error, given the angles with and without it, degrees.
pub(in crate::asset) fn useless_map(with: &Summary, without: &Summary) -> Option<String> {
    /// The largest mean error, degrees, that rounding to 8 bits explains.
    const ROUNDED: f64 = 0.4;
    let cause = match with.mean < ROUNDED {
        true => "the scan has no relief that the mesh lacks, and the map adds rounding",
        false => "check the direction of its green channel, the uvs and the ray distance",
    };
    (with.mean >= without.mean).then(|| {
        format!(
            "the normal map does not reduce the error: {:.2}° on average with it, {:.2}° without; {cause}",
            with.mean, without.mean
        )
    })
}

/// Returns `true` if the low-poly mesh was generated from the scan, so that its faults are not the user's.
fn is_made(pair: Pair<'_>) -> bool {
    pair.low.origin.simplified.is_some()
}

/// Returns the ways in which the meshes of a pair do not match.
fn misfits(pair: Pair<'_>, cage: &Cage) -> Vec<String> {
    let diagonal = pair.scan.mesh().diagonal();
    let verifier = Verifier { mesh: &pair.low.mesh, shown: None, cage, scan: pair.scan.sorted() };
    let Some(fit) = verifier.fit(POINTS, diagonal) else {
        return vec!["the low-poly mesh has no area".into()];
    };
    let mut misfits = Vec::new();
    if fit.away > PART {
        misfits.push(match is_made(pair) {
            true => {
                too_few(&format!("{} is farther than 2 % of the diagonal from the scan", percent(fit.away)))
            }
            false => apart(&fit),
        });
    }
    // Far from the scan, it is chance which of its sides is closest.
    if fit.turned > PART && fit.away < 0.5 {
        misfits.push(match is_made(pair) {
            true => too_few(&format!("{} faces the opposite way to the nearby scan", percent(fit.turned))),
            false => reversed(&fit),
        });
    }
    misfits
}

/// Refuses a model that does not match its scan at all, and notes one that partly does not. `cause` names what is
/// wrong with the model as a whole, if known.
///
/// # Errors
/// [`Error::Invalid`] if the meshes do not overlap.
pub(in crate::asset) fn refuse_misfit(
    fit: &Fit,
    cause: impl Fn() -> Option<String>,
    warnings: &mut Warnings,
) -> Result<()> {
    if fit.away > APART {
        let cause = cause().map_or_else(String::new, |cause| format!("; {cause}"));
        return Err(Error::invalid("the model and its scan", apart(fit) + &cause));
    }
    warnings.note(apart(fit), usize::from(fit.away > PART));
    // Beyond that fraction, the proof reports that the asset is inside out.
    let is_partly_turned = fit.turned > PART && fit.turned <= INSIDE_OUT;
    warnings.note(reversed(fit), usize::from(is_partly_turned && fit.away < 0.5));
    Ok(())
}

fn too_few(fault: &str) -> String {
    format!("the generated mesh does not follow the scan's thin or curved parts: {fault}; use more triangles")
}

fn apart(fit: &Fit) -> String {
    let apart = if fit.away > APART { "the meshes do not overlap" } else { "the meshes are apart" };
    format!(
        "{apart}: {} of the low-poly mesh is farther than 2 % of the diagonal from the scan ({} on average); is one of \
         them moved, scaled or posed differently?",
        percent(fit.away),
        percent(fit.distance)
    )
}

fn reversed(fit: &Fit) -> String {
    let whole = fit.turned > 0.5;
    let who = if whole { "one of the meshes is inside out" } else { "reversed winding of some triangles" };
    format!(
        "{who}: {} of the low-poly mesh faces the opposite way to the nearby scan; reverse its triangles and normals",
        percent(fit.turned)
    )
}

/// Notes faults of the scan itself.
pub(in crate::asset) fn inspect(scan: &Mesh, warnings: &mut Warnings) {
    let Faults { open_edges, crowded_edges, duplicates, flat } = Faults::of(scan);
    warnings.note("open (boundary) edges of the scan", open_edges);
    warnings.note("edges of the scan where more than two triangles meet", crowded_edges);
    warnings.note("duplicate triangles of the scan", duplicates);
    warnings.note("triangles of the scan without area", flat);
}

/// Returns a fraction in per cent with one decimal.
pub(in crate::asset) fn percent(part: f64) -> String {
    format!("{:.1} %", part * 100.0)
}

fn part(of: usize, all: usize) -> f64 {
    of as f64 / all.max(1) as f64
}

/// The maximum number of texels along the longer side.
const SIDE: usize = 1024;

/// The places where projection rays missed the scan, downscaled for viewing: the status of a map's texels, the worst
/// of each block, so that even a single miss is visible.
///
/// ```
/// use taotie::asset::Misses;
/// use taotie_engine::bake::TexelStatus;
///
/// /// Returns the number of blocks for which nothing was found.
/// fn lost(misses: &Misses) -> usize {
///     misses.texels.iter().filter(|texel| **texel == TexelStatus::Lost).count()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Misses {
    /// Blocks across.
    pub width: usize,
    /// Blocks down.
    pub height: usize,
    /// Row by row from the top.
    pub texels: Vec<TexelStatus>,
}

impl Misses {
    /// Examines the map; `None` if no ray missed.
    pub(super) fn of(maps: &BakedMaps) -> Option<Self> {
        let [width, height] = maps.size().map(|side| side as usize);
        maps.texels.iter().find(|texel| matches!(texel, TexelStatus::Closest | TexelStatus::Lost))?;
        let step = width.max(height).div_ceil(SIDE);
        let (across, down) = (width / step, height / step);
        let worst = |i: usize| {
            let (x, y) = (i % across * step, i / across * step);
            let block = (y..y + step).flat_map(|y| maps.texels[y * width + x..][..step].iter());
            block.copied().max_by_key(|texel| *texel as u8).unwrap_or_default()
        };
        Some(Self { width: across, height: down, texels: (0..across * down).map(worst).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::compare::Field;

    fn summary(angles: &[f32]) -> Summary {
        Field::new(angles.len() as u32, 1, angles.to_vec()).unwrap().summary().unwrap()
    }

    #[test]
    fn a_map_is_useless_unless_it_reduces_the_mean_error() {
        let (small, large) = (summary(&[1.0, 2.0]), summary(&[3.0, 5.0]));
        assert_eq!(useless_map(&small, &large), None);
        let text = useless_map(&large, &small).unwrap();
        assert!(text.contains("4.00° on average with it, 1.50° without"), "{text}");
        assert!(useless_map(&small, &small).is_some());
    }

    /// A ball with a thin spike to x = 2.
    fn spiked() -> Mesh {
        let mut data = Mesh::sphere(1.0, 60, 30).into_data();
        let first = data.positions.len() as u32;
        for (x, y, z) in [(0.9, 0.05, 0.0), (0.9, -0.05, 0.05), (0.9, -0.05, -0.05), (2.0, 0.0, 0.0)] {
            data.positions.push(taotie_engine::math::Vec3::new(x, y, z));
        }
        data.triangles.extend([[0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|t| t.map(|v| v + first)));
        let data = taotie_engine::mesh::MeshData { normals: Vec::new(), uvs: Vec::new(), ..data };
        Mesh::new(data).unwrap()
    }

    #[test]
    fn a_spike_that_is_missing_is_noted_with_its_place() {
        let said = |scan: &Mesh, low: &Mesh| -> String {
            let mut warnings = Warnings::default();
            let scan = Scan::from_mesh(scan.clone(), taotie_engine::Progress::SILENT).unwrap();
            note_missing_parts(&scan, low, true, &mut warnings);
            warnings.iter().map(|(what, _)| what).collect()
        };
        let (spiked, ball) = (spiked(), Mesh::sphere(1.0, 24, 12));
        assert_eq!(said(&spiked, &spiked), "");
        assert_eq!(said(&Mesh::sphere(1.0, 60, 30), &ball), "");
        let text = said(&spiked, &ball);
        assert!(text.starts_with("the low-poly mesh lacks parts of the scan: "), "{text}");
        assert!(
            text.contains("of 1.") && text.contains("around (1.") && text.contains("use more triangles"),
            "{text}"
        );
    }
}
