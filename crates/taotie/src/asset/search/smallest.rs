//! The search as a whole.

use super::bare::Bare;
use super::goal::Goal;
use super::mapped;
use super::trial::Trial;
use super::winner::Winner;
use super::workshop::{Draft, Rounding, Shape, Subject, Workshop};
use crate::asset::low::{self, LowPoly};
use crate::asset::maps::{Recipe, StoredMaps};
use crate::asset::scan::Scan;
use crate::error::{Error, Result, Warnings};
use crate::progress::Progress;
use crate::proof::Side;

/// The largest mean difference of colours that is allowed, CIEDE2000: what `standard` requires.
const COLOR: f64 = 1.0;
/// The quality of colours as lossy WebP on a mesh without a normal map.
const COLOR_QUALITY: u8 = 85;
/// Sizes of the maps of colours that are tried, on a mesh of so many triangles.
const COLOR_SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
const COLOR_TRIANGLES: u32 = 8_000;

/// The mesh and maps that were found.
pub(in crate::asset) struct Found {
    pub low: LowPoly,
    pub maps: StoredMaps,
    /// Texels along a side; 0 without maps.
    pub size: u32,
    /// What the file loses.
    pub rounding: Rounding,
    pub trials: Vec<Trial>,
    /// The warnings on the way to it.
    pub warnings: Warnings,
}

/// Finds the asset of the fewest bytes whose mean angle as seen is at most `most` degrees.
///
/// # Errors
/// [`Error::Invalid`] if none comes so near, with the nearest that was found.
pub(in crate::asset) fn smallest(
    recipe: Recipe<'_>,
    scan: &Scan,
    most: f64,
    progress: Progress<'_>,
) -> Result<Found> {
    scan.sort(progress)?;
    let side = Side::of(scan.sorted());
    let mut warnings = Warnings::default();
    let seen = low::seen(scan, &mut warnings)?;
    let goal = Goal { angle: most, color: COLOR };
    let mut workshop = Workshop::new(recipe, goal, Subject { scan, seen: &seen, side: &side });
    let size = color_size(&mut workshop, progress)?;
    let quality = (size > 0).then_some(COLOR_QUALITY);
    let mut best = Bare::smallest(&mut workshop, (size, quality), progress)?;
    mapped::smallest(&mut workshop, size, &mut best, progress)?;
    let Some(Winner { draft, rounding, .. }) = best else { return Err(none_near_enough(most, workshop)) };
    let Draft { shape, low, maps } = draft;
    let Shape { triangles, size, .. } = shape;
    low::note_simplified(workshop.simplified(shape, progress)?, triangles, &mut warnings);
    let Workshop { trials, refused, .. } = workshop;
    refused.into_values().for_each(|error| warnings.note(format!("not considered: {error}"), 1));
    Ok(Found { low, maps, size, rounding, trials, warnings })
}

/// Returns the least size of the maps of colours that are near enough; 0 if there are no maps but that of normals.
fn color_size(workshop: &mut Workshop<'_>, progress: Progress<'_>) -> Result<u32> {
    if !workshop.has_other_maps() {
        return Ok(0);
    }
    let triangles = COLOR_TRIANGLES.min(workshop.triangles());
    for size in COLOR_SIZES {
        let shape = Shape { triangles, size, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else { continue };
        let rounding = Rounding { quality: Some(COLOR_QUALITY), ..Rounding::default() };
        let trial = workshop.trial(&draft, rounding)?;
        if trial.mean_color.is_none_or(|color| color <= workshop.goal.color) {
            return Ok(size);
        }
    }
    Ok(COLOR_SIZES[COLOR_SIZES.len() - 1])
}

fn none_near_enough(most: f64, workshop: Workshop<'_>) -> Error {
    let Workshop { trials, mut refused, .. } = workshop;
    let why = match trials.iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle)) {
        Some(Trial { triangles, size: 0, mean_angle, .. }) => {
            format!("no mesh comes so near; the nearest has {triangles} triangles and {mean_angle:.3}°")
        }
        Some(Trial { triangles, size, mean_angle, .. }) => format!(
            "no mesh and map come so near; the nearest are {triangles} triangles and {size}×{size} texels with \
             {mean_angle:.3}°"
        ),
        None => match refused.pop_first() {
            Some((_, error)) => return error,
            None => "the scan has no triangles".into(),
        },
    };
    Error::invalid(format!("a mean normal error of {most}°"), why)
}
