//! The search as a whole.

use super::bare::Bare;
use super::goal::Goal;
use super::trial::Trial;
use super::winner::{Candidate, Winner};
use super::workshop::{Draft, Rounding, Shape, Subject, Workshop};
use super::{mapped, packed};
use crate::asset::low::{self, LowPoly};
use crate::asset::maps::{Recipe, StoredMaps};
use crate::asset::scan::Scan;
use crate::error::{Error, Result, Warnings};
use crate::io::VertexBits;
use crate::progress::Progress;
use crate::proof::Side;

/// The largest mean difference of colours that is allowed, CIEDE2000: what `standard` requires.
const COLOR: f64 = 1.0;
/// The quality of colours as lossy WebP on a mesh without a normal map.
const COLOR_QUALITY: u8 = 85;
/// Sizes of the maps of colours that are tried, on a mesh of so many triangles.
const COLOR_SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
const COLOR_TRIANGLES: u32 = 8_000;

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
    /// The GLB of the packed scan, and the bits of its vertices.
    Packed(Vec<u8>, VertexBits),
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
    let mut best = None;
    packed::smallest(&mut workshop, &mut best, progress)?;
    if let Some(size) = color_size(&mut workshop, &best, progress)? {
        let quality = (size > 0).then_some(COLOR_QUALITY);
        if let Some(bare) = Bare::smallest(&mut workshop, (size, quality), progress)? {
            Winner::replace(&mut best, bare);
        }
        if !best.as_ref().is_some_and(Winner::is_mostly_textures) {
            mapped::smallest(&mut workshop, size, &mut best, progress)?;
        }
    }
    let Some(Winner { candidate, trial }) = best else { return Err(none_near_enough(most, workshop)) };
    let smallest = match candidate {
        Candidate::Packed { glb, .. } => {
            // Nothing was made without what cannot be seen.
            warnings = Warnings::default();
            Smallest::Packed(glb, trial.bits)
        }
        Candidate::Made(draft, rounding) => {
            let Draft { shape, low, maps } = *draft;
            low::note_simplified(workshop.simplified(shape, progress)?, shape.triangles, &mut warnings);
            Smallest::Made(Box::new(MadeAsset { low, maps, size: shape.size, rounding }))
        }
    };
    let Workshop { mut trials, refused, not_packed, .. } = workshop;
    trials.iter_mut().filter(|own| **own == trial).take(1).for_each(|own| own.is_chosen = true);
    not_packed
        .into_iter()
        .for_each(|error| warnings.note(format!("not considered: the packed scan: {error}"), 1));
    refused.into_values().for_each(|error| warnings.note(format!("not considered: {error}"), 1));
    Ok(Found { smallest, trials, warnings })
}

/// Returns the least size of the maps of colours that are near enough, 0 if there are no maps but that of normals; `None` if
/// they alone are larger than the best candidate.
fn color_size(
    workshop: &mut Workshop<'_>,
    best: &Option<Winner>,
    progress: Progress<'_>,
) -> Result<Option<u32>> {
    if !workshop.has_other_maps() {
        return Ok(Some(0));
    }
    let triangles = COLOR_TRIANGLES.min(workshop.triangles());
    let most = workshop.most_side();
    for size in COLOR_SIZES.into_iter().filter(|size| *size <= most) {
        let shape = Shape { triangles, size, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else { continue };
        workshop.choose_numbers(&draft)?;
        let rounding = workshop.rounding(VertexBits::default(), Some(COLOR_QUALITY));
        let trial = workshop.trial(&draft, rounding)?;
        let of_maps = trial.bytes.saturating_sub(draft.mesh_bytes(rounding.bits)?);
        if best.as_ref().is_some_and(|best| of_maps > best.trial.bytes) {
            return Ok(None);
        }
        if trial.mean_color.is_none_or(|color| color <= workshop.goal.color) {
            return Ok(Some(size));
        }
    }
    Ok(best.is_none().then_some(most.min(COLOR_SIZES[COLOR_SIZES.len() - 1])))
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
