//! The search as a whole.

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

/// What was found.
pub(in crate::asset) struct Found {
    pub smallest: Smallest,
    pub trials: Vec<Trial>,
    /// The warnings on the way to it.
    pub warnings: Warnings,
}

/// The smallest asset.
pub(in crate::asset) enum Smallest {
    /// A mesh and maps that were made from the scan.
    Made(Box<MadeAsset>),
    /// The packed scan.
    Packed(PackedAsset),
}

/// A packed scan.
pub(in crate::asset) struct PackedAsset {
    pub glb: Vec<u8>,
    pub geometry: PackedGeometry,
    /// Those in place of its own.
    pub images: Vec<PackedImage>,
    /// What it loses at least.
    pub rounding: Rounding,
}

/// A mesh and maps.
pub(in crate::asset) struct MadeAsset {
    pub low: LowPoly,
    pub maps: StoredMaps,
    /// Texels along a side; 0 without maps.
    pub size: u32,
    /// What the file loses.
    pub rounding: Rounding,
}

/// Finds the asset of the fewest bytes that meets the goal of a bake, or the nearest one within its budget of bytes; the one
/// that comes nearest if none does, with a warning. As a coarser level of detail it is made anew for its pixels.
///
/// # Errors
/// Those of making candidates if none can be made.
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
    let is_alone = recipe.options.lods.is_empty();
    let ceilings = if is_alone { ceilings } else { ceilings.of_level(level) };
    let subject = Subject { scan, seen: &seen, side: &side, level };
    let mut workshop = Workshop::new(recipe, (goal.clone(), ceilings), subject);
    let (stage, tried) = (progress.begin("search")?, Arc::clone(&workshop.tried));
    // All stages of candidates are this one.
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
            // The notes so far are about meshes that are made.
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
            "no asset that was tried is within the ceilings; this is the nearest to them, {triangles} triangles and {gpu_bytes} \
             bytes on the graphics card"
        );
        warnings.note(what, 1);
    } else if !trial.is_near && workshop.has_goal() {
        warnings.note(none_near_enough(&required, &trial), 1);
    }
    if let Some(most) = most.filter(|most| trial.bytes > *most) {
        warnings.note(
            format!(
                "no asset that was tried has at most {most} bytes; this is the smallest, {}",
                trial.bytes
            ),
            1,
        );
    }
    let Workshop { mut trials, refused, not_packed, .. } = workshop;
    trials.iter_mut().filter(|own| **own == trial).take(1).for_each(|own| own.is_chosen = true);
    not_packed
        .into_iter()
        .for_each(|error| warnings.note(format!("not considered: the packed scan: {error}"), 1));
    refused.into_values().for_each(|error| warnings.note(format!("not considered: {error}"), 1));
    Ok(Found { smallest, trials, warnings })
}

/// Returns the part of a search that is done after so many trials. Nobody knows how many there will be; most searches take 8 to 25.
fn part_done(tried: usize) -> f64 {
    const AHEAD: f64 = 6.0;
    tried as f64 / (tried as f64 + AHEAD)
}

/// Says what is nearest if nothing is near enough.
fn none_near_enough(required: &[Requirement], nearest: &Trial) -> String {
    let Trial { triangles, mean_angle, p95_angle, mean_color, p95_color, .. } = *nearest;
    let colors = mean_color.zip(p95_color);
    let colors = colors.map_or_else(String::new, |(mean, p95)| format!(", ΔE {mean:.2} and p95 {p95:.2}"));
    format!(
        "no asset that was tried meets {}; this is the nearest, {triangles} triangles with a mean angle of {mean_angle:.3}° and \
         p95 {p95_angle:.3}°{colors}",
        requirement_text::argument(&Goal::decided(required))
    )
}

fn no_triangles() -> Error {
    Error::invalid("the search for an asset", "the scan has no triangles that can be seen")
}

/// Returns why no candidate could be made.
fn none_at_all(mut workshop: Workshop<'_>) -> Error {
    workshop.refused.pop_first().map_or_else(no_triangles, |(_, error)| error)
}
