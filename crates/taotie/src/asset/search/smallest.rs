//! The complete search: for the smallest asset that meets a goal, or the best one within a number of bytes. The size
//! and losses of maps other than normal maps are chosen first, for all candidates made from the scan.

use super::bare::Bare;
use super::encodings::Encodings;
use super::goal::{Ceilings, Goal, Level};
use super::workshop::{Best, Candidate, Draft, Shape, Subject, Winner, Workshop};
use super::{mapped, packed};
use crate::asset::ask::{Requirement, requirement};
use crate::asset::bake::{MadeAsset, Recipe, Rounding, Trial};
use crate::asset::source::{Scan, low_poly};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Bitmap, Encoding};
use taotie_engine::math::scalar::{exp, ln};
use taotie_engine::progress::Progress;
use taotie_engine::proof::{Relook, Side};
use taotie_io::{ImageCodec, LossyTexture, PackedGeometry, PackedImage, TextureCodecs, VertexBits};

/// The result of a search.
pub(in crate::asset) struct Found {
    pub smallest: Smallest,
    pub trials: Vec<Trial>,
    /// The warnings of the search.
    pub warnings: Warnings,
}

/// The smallest asset.
pub(in crate::asset) enum Smallest {
    /// A mesh and maps generated from the scan.
    Made(Box<MadeAsset>),
    /// The packed scan.
    Packed(PackedAsset),
}

/// A packed scan.
pub(in crate::asset) struct PackedAsset {
    pub glb: Vec<u8>,
    pub geometry: PackedGeometry,
    /// Images that replace its own.
    pub images: Vec<PackedImage>,
    /// A lower bound of its loss.
    pub rounding: Rounding,
}

/// Finds the smallest asset in bytes that meets the goal of a bake, or the nearest one within its byte budget; if
/// none does, the nearest one, with a warning. A coarser level of detail is made from scratch for its pixels.
///
/// # Errors
/// Those of making candidates, if none can be made.
pub(in crate::asset) fn smallest(
    recipe: Recipe<'_>,
    (scan, level): (&Scan, Level),
    progress: Progress<'_>,
) -> Result<Found> {
    scan.sort(progress)?;
    // A scan that does not fit is an error now, not a reason to refuse every candidate with maps.
    scan.sorted().load_on_device()?;
    let side = Side::of(scan.sorted());
    let mut warnings = Warnings::default();
    let base = low_poly::base(scan, recipe.options, &mut warnings, progress)?;
    if base.mesh.triangles().is_empty() {
        return Err(no_triangles());
    }
    let required = recipe.options.limits();
    let (goal, ceilings) = (Goal::of(&required, level.number), Ceilings::of(&required));
    let is_single = recipe.options.lods.is_empty();
    let ceilings = if is_single { ceilings } else { ceilings.of_level(level) };
    let subject = Subject { scan, base: &base, side: &side, level };
    let mut workshop = Workshop::new(recipe, (goal.clone(), ceilings), subject);
    let (stage, tried) = (progress.begin("search")?, Arc::clone(&workshop.tried));
    // All stages of candidates are reported as this one.
    let listener = |_: &'static str, _: f64| stage.at(part_done(tried.load(Ordering::Relaxed))).is_ok();
    let progress = Progress::new(&listener);
    let of_goal = ceilings.bytes.is_finite().then_some(ceilings.bytes as u64);
    let most = of_goal.into_iter().chain(recipe.options.bytes).min();
    let best = match most {
        Some(most) => within_budget(&mut workshop, &goal, most, progress)?,
        None => round(&mut workshop, progress)?,
    };
    let Some(Winner { candidate, trial }) = best.into_winner() else { return Err(none_at_all(workshop)) };
    let smallest = match candidate {
        Candidate::Packed { glb, geometry, images } => {
            // The notes so far concern generated meshes.
            warnings = workshop.packing_losses.clone();
            let normals = trial.normals.unwrap_or(workshop.codecs().least_lossy());
            let rounding = workshop.rounding(trial.bits, normals);
            Smallest::Packed(PackedAsset { glb, geometry, images, rounding })
        }
        Candidate::Made(draft, rounding) => {
            let Draft { shape, low, maps } = *draft;
            low_poly::note_simplified(workshop.simplified(shape, progress)?, shape.triangles, &mut warnings);
            low_poly::note_opened(&low, &mut warnings);
            Smallest::Made(Box::new(MadeAsset { low, maps, size: shape.size, rounding }))
        }
    };
    if !trial.is_within() {
        let Trial { triangles, gpu_bytes, .. } = trial;
        let what = format!(
            "no candidate is within the ceilings; the nearest has {triangles} triangles and {gpu_bytes} \
             bytes of GPU memory"
        );
        warnings.note(what, 1);
    } else if !trial.is_near && workshop.has_goal() {
        warnings.note(none_near_enough(&required, &trial), 1);
    }
    if let Some(most) = most.filter(|most| trial.bytes as f64 > room(scan, *most)) {
        let what = format!(
            "no candidate has at most {most} bytes with its metadata; the smallest has {} without",
            trial.bytes
        );
        warnings.note(what, 1);
    }
    let Workshop { mut trials, refused, not_packed, .. } = workshop;
    trials.iter_mut().filter(|own| **own == trial).take(1).for_each(|own| own.is_chosen = true);
    not_packed
        .into_iter()
        .for_each(|error| warnings.note(format!("not considered: the packed scan: {error}"), 1));
    refused.into_values().for_each(|error| warnings.note(format!("not considered: {error}"), 1));
    Ok(Found { smallest, trials, warnings })
}

/// Returns the completed fraction of a search after `tried` trials. Their total is unknown; most searches take 8 to
/// 25.
fn part_done(tried: usize) -> f64 {
    const AHEAD: f64 = 6.0;
    tried as f64 / (tried as f64 + AHEAD)
}

/// Describes the nearest candidate if none is close enough.
fn none_near_enough(required: &[Requirement], nearest: &Trial) -> String {
    let Trial { triangles, mean_angle, p95_angle, mean_color, p95_color, .. } = *nearest;
    let colors = mean_color.zip(p95_color);
    let colors = colors.map_or_else(String::new, |(mean, p95)| format!(", ΔE {mean:.2} and p95 {p95:.2}"));
    format!(
        "no candidate meets {} by the search's own, coarser measurement; the nearest has {triangles} triangles with a \
         mean angle of {mean_angle:.3}° and p95 {p95_angle:.3}°{colors}: its proof decides",
        requirement::argument(&Goal::decided(required))
    )
}

fn no_triangles() -> Error {
    Error::invalid("the search for an asset", "the scan has no visible triangles")
}

/// Returns why no candidate could be made.
fn none_at_all(mut workshop: Workshop<'_>) -> Error {
    workshop.refused.pop_first().map_or_else(no_triangles, |(_, error)| error)
}

/// Returns the smallest candidate that meets the goal of a workshop, or the nearest one.
fn round(workshop: &mut Workshop<'_>, progress: Progress<'_>) -> Result<Best> {
    let (mut best, scan) = (Best::default(), workshop.scan());
    if workshop.packs_first() {
        packed::smallest(workshop, &mut best, progress)?;
    }
    // Candidates made from the scan no longer move.
    let is_packed = best.is_mostly_textures() || (scan.about.is_rigged && best.bytes().is_finite());
    if !is_packed && let Some(size) = chosen_size(workshop, &best, progress)? {
        Bare::smallest(workshop, size, &mut best, progress)?;
        mapped::smallest(workshop, size, &mut best, progress)?;
    }
    // The result is no larger than the scan, and no farther from it than necessary.
    let is_enough = best.bytes().is_finite() && best.bytes() <= bytes_of(scan);
    if !is_enough && workshop.may_pack() && !workshop.packs_first() {
        packed::smallest(workshop, &mut best, progress)?;
    }
    Ok(best)
}

/// Returns the bytes of a scan's files; infinite in memory.
fn bytes_of(scan: &Scan) -> f64 {
    if scan.about.bytes > 0 { scan.about.bytes as f64 } else { f64::INFINITY }
}

/// The sizes tried for the finest level, and the triangles of the mesh they are tried on.
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
const TRIANGLES: u32 = 8_000;
/// If a size has more than this fraction of the colour error of the size before, it is not worth its bytes: the mesh
/// is the cause.
const WORTH: f64 = 0.85;
/// The ratio of colours with a negligible loss, and the largest one that is chosen: the rest is for fewer triangles.
const LEAST_LOSS: f64 = 0.2;
const MOST: f64 = 0.95;

/// Chooses the smallest size at which colours are close enough, and the losses of maps at it. Returns that size, 0 if
/// there are only normal maps; `None` if these maps by themselves are larger than the best candidate. If no size is
/// close enough, it is the one beyond which colours hardly improve.
fn chosen_size(workshop: &mut Workshop<'_>, best: &Best, progress: Progress<'_>) -> Result<Option<u32>> {
    if !workshop.has_other_maps() {
        return Ok(Some(0));
    }
    let triangles = workshop.level().triangles(TRIANGLES).min(workshop.triangles());
    let (level, most) = (workshop.level(), workshop.most_side());
    let mut before: Option<(u32, f64)> = None;
    for size in SIZES.into_iter().map(|size| level.side(size)).filter(|size| *size <= most) {
        let shape = Shape { triangles, size, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else { continue };
        let trial = choose_losses(workshop, &draft)?;
        let of_maps =
            trial.bytes.saturating_sub(draft.mesh_bytes(VertexBits::default(), workshop.codecs().set)?);
        if of_maps as f64 > best.bytes() {
            return Ok(None);
        }
        let Some(ratio) = trial.color_ratio.filter(|ratio| *ratio > 1.0) else { return Ok(Some(size)) };
        if before.is_some_and(|(_, known)| ratio > WORTH * known) {
            break;
        }
        before = Some((size, ratio));
    }
    let size = before.map_or(most.min(level.side(SIZES[SIZES.len() - 1])), |(size, _)| size);
    Ok(best.bytes().is_infinite().then_some(size))
}

/// Chooses the losses of a draft's maps, and returns the trial with them.
fn choose_losses(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Trial> {
    let surface = workshop.surface(draft)?;
    let side = Side::of(&surface);
    let look = Relook::new(&side, workshop.picture());
    let texture = |bitmap: &Option<Bitmap>, encoding: Encoding| {
        bitmap.as_ref().map(|bitmap| LossyTexture::new(bitmap.clone(), encoding))
    };
    let textures = &draft.maps.textures;
    let (colors, numbers) =
        (texture(&textures.color, Encoding::Srgb), texture(&textures.orm, Encoding::Linear));
    let colors = encodings(colors.as_ref(), &look, workshop)?;
    let numbers = encodings(numbers.as_ref(), &look, workshop)?;
    let least = workshop.codecs().least_lossy();
    let codec = |of: &Option<Encodings<'_>>, most: f64| -> Result<ImageCodec> {
        let found = of.as_ref().map(|of| of.smallest_of(draft.shape.size, most)).transpose()?;
        Ok(found.flatten().map_or(least, |found| found.codec))
    };
    let (near, numbers) = (codec(&colors, LEAST_LOSS)?, codec(&numbers, 1.0)?);
    workshop.images = TextureCodecs { colors: near, normals: least, numbers };
    let bits = VertexBits::default();
    let exact = workshop.trial(draft, workshop.rounding(bits, least))?;
    let Some(of_size) = exact.color_ratio.filter(|ratio| *ratio <= MOST) else { return Ok(exact) };
    let far = codec(&colors, (MOST * MOST - of_size * of_size).sqrt().max(LEAST_LOSS))?;
    if far == near {
        return Ok(exact);
    }
    workshop.images.colors = far;
    let lossy = workshop.trial(draft, workshop.rounding(bits, least))?;
    if lossy.color_ratio.is_none_or(|ratio| ratio <= 1.0) {
        return Ok(lossy);
    }
    workshop.images.colors = near;
    Ok(exact)
}

/// Returns the encodings of a texture of the examined surface; `None` if there is none.
fn encodings<'a>(
    texture: Option<&'a LossyTexture>,
    look: &'a Relook<'a>,
    workshop: &Workshop<'_>,
) -> Result<Option<Encodings<'a>>> {
    let Some(texture) = texture else { return Ok(None) };
    let limits = (&workshop.goal, workshop.codecs());
    Ok(look.first(texture.encoding())?.map(|look| Encodings::new(texture, look, limits)))
}

/// The maximum number of searches, each for a goal closer to the budget.
const ROUNDS: usize = 5;
/// The fraction of the budget that is sufficient.
const ENOUGH: f64 = 0.93;
/// The power of the saved bytes with which differences grow, until two rounds measure it, and its range.
const POWER: f64 = 0.8;
const LEAST_POWER: f64 = 0.2;
const MOST_POWER: f64 = 3.0;
/// The range of goals, as factors of the limits.
const RANGE: [f64; 2] = [0.05, 100.0];
/// The bytes of metadata in every asset.
const METADATA: f64 = 1_500.0;

/// Returns the bytes of a budget that remain for an asset without its metadata.
fn room(scan: &Scan, most: u64) -> f64 {
    let xmp = scan.about.xmp.as_ref().map_or(0, |xmp| xmp.to_string().len());
    (most as f64 - METADATA - xmp as f64).max(0.0)
}

/// Returns the candidate closest to the scan among those with at most `most` bytes. If a goal is requested, a smaller
/// one that meets it is sufficient. If all are larger, returns the smallest found.
fn within_budget(
    workshop: &mut Workshop<'_>,
    goal: &Goal,
    most: u64,
    progress: Progress<'_>,
) -> Result<Best> {
    let most = room(workshop.scan(), most);
    let aim = 0.5 * (1.0 + ENOUGH) * most.max(1.0);
    let is_goal_enough = workshop.has_goal();
    let (mut found, mut factor): (Option<Best>, f64) = (None, 1.0);
    // The largest factor with too many bytes, and the smallest within the budget.
    let [mut low, mut high] = [0.0, f64::INFINITY];
    let mut rounds = Vec::with_capacity(ROUNDS);
    for _ in 0..ROUNDS {
        workshop.goal = goal.times(factor);
        let before = workshop.trials.len();
        let mut best = round(workshop, progress)?;
        workshop.trials[before..].iter_mut().for_each(|trial| trial.scale(factor));
        best.scale(factor);
        let bytes = best.least_bytes();
        let is_within = bytes <= most;
        if is_within {
            high = factor
        } else {
            low = factor
        }
        if is_within || found.as_ref().is_none_or(|known| bytes < known.least_bytes()) {
            found = Some(best);
        }
        let is_done = is_within && (bytes >= ENOUGH * most || (is_goal_enough && factor == 1.0));
        if is_done || factor == RANGE[usize::from(!is_within)] {
            break;
        }
        let power = rounds.last().map_or(POWER, |[known, of_known]: &[f64; 2]| {
            (ln(factor / known) / ln(of_known / bytes)).clamp(LEAST_POWER, MOST_POWER)
        });
        rounds.push([factor, bytes]);
        let next = (factor * exp(ln(bytes / aim) * power)).clamp(RANGE[0], RANGE[1]);
        factor = match (low > 0.0, high.is_finite()) {
            (true, true) if next <= low || next >= high => (low * high).sqrt(),
            _ => next,
        };
    }
    workshop.goal = goal.clone();
    Ok(found.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::super::workshop::{under_map, uv_bits};
    use super::*;
    use crate::asset::ask::BakeOptions;
    use crate::asset::bake::BakePlan;
    use crate::asset::source::{RayLength, Rays, Skew};
    use taotie_engine::math::Vec3;
    use taotie_engine::math::scalar::sin;
    use taotie_engine::mesh::{Mesh, MeshData};
    use taotie_io::Limits;

    /// The maximum ratio of the search's result to the smallest of the grid.
    const WITHIN: f64 = 1.05;
    /// Factors applied to the resulting triangles, or to the fraction kept.
    const FACTORS: [f64; 11] = [0.7, 0.78, 0.84, 0.89, 0.93, 0.965, 1.0, 1.035, 1.08, 1.15, 1.3];
    const POSITION_BITS: [u8; 4] = [11, 12, 13, 14];
    const NORMAL_BITS: [u8; 5] = [7, 8, 9, 10, 12];
    /// Triangles, texels and formats of candidates with a normal map.
    const TRIANGLES: [u32; 5] = [1_000, 2_000, 4_000, 8_000, 16_000];
    const SIZES: [u32; 4] = [256, 512, 768, 1024];
    const CODECS: [ImageCodec; 10] = [
        ImageCodec::Jpeg(55),
        ImageCodec::Jpeg(80),
        ImageCodec::Jpeg(90),
        ImageCodec::Jpeg(96),
        ImageCodec::LossyWebP(35),
        ImageCodec::LossyWebP(65),
        ImageCodec::LossyWebP(82),
        ImageCodec::LossyWebP(93),
        ImageCodec::LossyWebP(97),
        ImageCodec::WebP,
    ];

    /// Compares the search with brute force, which tries every combination of a grid around the result. It takes
    /// minutes per model, so it runs among the slow tests on a ball, and manually on any model: `make brute-force
    /// SCANS="a.obj b.glb"`.
    #[test]
    #[ignore = "takes minutes per model"]
    fn the_search_is_near_brute_force() {
        let models = option_env!("SCANS").unwrap_or_default().split_whitespace();
        let read =
            |path: &str| (path.to_owned(), Scan::read(path, &Limits::default(), Progress::SILENT).unwrap());
        let mut scans: Vec<(String, Scan)> = models.map(read).collect();
        if scans.is_empty() {
            scans.push(("a ball with waves".into(), ball()));
        }
        let (lines, ratios): (Vec<String>, Vec<f64>) =
            scans.iter().map(|(name, scan)| line(name, scan)).unzip();
        assert!(ratios.iter().all(|ratio| *ratio <= WITHIN), "{lines:#?}");
    }

    /// A ball with waves.
    fn ball() -> Scan {
        let data = Mesh::sphere(1.0, 200, 100).into_data();
        let wave = |p: &Vec3| {
            let [x, y, z] = p.to_array().map(|v| sin(9.0 * f64::from(v)));
            *p * (1.0 + 0.02 * x * y * z) as f32
        };
        let mesh = MeshData {
            positions: data.positions.iter().map(wave).collect(),
            triangles: data.triangles,
            ..MeshData::default()
        };
        Scan::from_mesh(Mesh::new(mesh).unwrap(), Progress::SILENT).unwrap()
    }

    /// Returns the result for a model as a line, and the ratio of bytes.
    fn line(name: &str, scan: &Scan) -> (String, f64) {
        let (found, others) = compared(scan).unwrap_or_else(|error| panic!("{name}: {error}"));
        let near = others.iter().filter(|trial| trial.is_near);
        let least = near.min_by_key(|trial| trial.bytes).expect("some are near");
        let (ratio, count) = (found.bytes as f64 / least.bytes as f64, others.len());
        (format!("{name}: {ratio:.3} of the smallest of {count}; found {found:?}; that is {least:?}"), ratio)
    }

    /// Returns the search's result for 1°, and all assets of a grid.
    fn compared(scan: &Scan) -> Result<(Trial, Vec<Trial>)> {
        let goal = vec![Requirement::mean_angle_deg(1.0)];
        let asked = BakeOptions { goal: Some(goal.clone()), ..BakeOptions::default() };
        let options = BakePlan::of(&asked.sized(scan.about.size), &scan.about.carried, &[]).options;
        let rays = Rays { length: RayLength::Auto, skew: Skew::Corrected, uvs: None };
        let recipe = Recipe { options: &options, rays: &rays };
        let found = smallest(recipe, (scan, Level::FINEST), Progress::SILENT)?;
        let chosen = *found.trials.iter().find(|trial| trial.is_chosen).expect("one is chosen");
        let side = Side::of(scan.sorted());
        let base = low_poly::base(scan, &options, &mut Warnings::default(), Progress::SILENT)?;
        let subject = Subject { scan, base: &base, side: &side, level: Level::FINEST };
        let mut workshop = Workshop::new(recipe, (Goal::of(&goal, 0), Ceilings::of(&goal)), subject);
        match found.smallest {
            Smallest::Packed(asset) => {
                let kept: Vec<f64> =
                    FACTORS.iter().map(|factor| (asset.geometry.kept * factor).min(1.0)).collect();
                packed::all(&mut workshop, (&kept, &[0.8, 0.95]), Progress::SILENT)?;
            }
            Smallest::Made(_) => {
                bare(&mut workshop, &chosen)?;
                mapped(&mut workshop)?;
            }
        }
        Ok((chosen, workshop.trials))
    }

    fn bare(workshop: &mut Workshop<'_>, chosen: &Trial) -> Result<()> {
        for factor in FACTORS {
            let triangles = (chosen.triangles as f64 * factor) as u32;
            let shape = Shape { triangles, size: chosen.size, has_normal_map: false };
            let Some(draft) = workshop.draft(shape, Progress::SILENT)? else { continue };
            for (positions, normals) in POSITION_BITS.iter().flat_map(|p| NORMAL_BITS.map(|n| (*p, n))) {
                let bits = VertexBits { positions, normals, uvs: uv_bits(chosen.size) };
                let rounding = workshop.rounding(bits, workshop.codecs().least_lossy());
                workshop.trial(&draft, rounding)?;
            }
        }
        Ok(())
    }

    fn mapped(workshop: &mut Workshop<'_>) -> Result<()> {
        for (triangles, size) in TRIANGLES.iter().flat_map(|count| SIZES.map(|size| (*count, size))) {
            let shape = Shape { triangles, size, has_normal_map: true };
            let Some(draft) = workshop.draft(shape, Progress::SILENT)? else { continue };
            for codec in CODECS {
                workshop.trial(&draft, workshop.rounding(under_map(size), codec))?;
            }
        }
        Ok(())
    }
}
