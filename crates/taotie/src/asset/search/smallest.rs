//! The complete search.

use super::budget;
use super::ceilings::Ceilings;
use super::goal::Goal;
use super::level::Level;
use super::round::round;
use super::trial::Trial;
use super::winner::{Candidate, Winner};
use super::workshop::{Draft, Rounding, Subject, Workshop};
use crate::asset::low::{self, LowPoly};
use crate::asset::maps::{Recipe, StoredMaps};
use crate::asset::requirement::Requirement;
use crate::asset::requirement_text;
use crate::asset::scan::Scan;
use crate::error::{Error, Result, Warnings};
use crate::io::{PackedGeometry, PackedImage};
use crate::progress::Progress;
use crate::proof::Side;
use std::sync::Arc;
use std::sync::atomic::Ordering;

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

/// A mesh and maps.
pub(in crate::asset) struct MadeAsset {
    pub low: LowPoly,
    pub maps: StoredMaps,
    /// Texels along a side; 0 without maps.
    pub size: u32,
    /// The loss of the file's formats.
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
    let side = Side::of(scan.sorted());
    let mut warnings = Warnings::default();
    let seen = low::seen(scan, &mut warnings)?;
    if seen.triangles().is_empty() {
        return Err(no_triangles());
    }
    let required = recipe.options.limits();
    let (goal, ceilings) = (Goal::of(&required, level.number), Ceilings::of(&required));
    let is_single = recipe.options.lods.is_empty();
    let ceilings = if is_single { ceilings } else { ceilings.of_level(level) };
    let subject = Subject { scan, seen: &seen, side: &side, level };
    let mut workshop = Workshop::new(recipe, (goal.clone(), ceilings), subject);
    let (stage, tried) = (progress.begin("search")?, Arc::clone(&workshop.tried));
    // All stages of candidates are reported as this one.
    let listener = |_: &'static str, _: f64| stage.at(part_done(tried.load(Ordering::Relaxed))).is_ok();
    let progress = Progress::new(&listener);
    let of_goal = ceilings.bytes.is_finite().then_some(ceilings.bytes as u64);
    let most = of_goal.into_iter().chain(recipe.options.bytes).min();
    let best = match most {
        Some(most) => budget::within(&mut workshop, &goal, most, progress)?,
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
            low::note_simplified(workshop.simplified(shape, progress)?, shape.triangles, &mut warnings);
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
    if let Some(most) = most.filter(|most| trial.bytes > *most) {
        warnings.note(format!("no candidate has at most {most} bytes; the smallest has {}", trial.bytes), 1);
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
        "no candidate meets {}; the nearest has {triangles} triangles with a mean angle of {mean_angle:.3}° and \
         p95 {p95_angle:.3}°{colors}",
        requirement_text::argument(&Goal::decided(required))
    )
}

fn no_triangles() -> Error {
    Error::invalid("the search for an asset", "the scan has no visible triangles")
}

/// Returns why no candidate could be made.
fn none_at_all(mut workshop: Workshop<'_>) -> Error {
    workshop.refused.pop_first().map_or_else(no_triangles, |(_, error)| error)
}
