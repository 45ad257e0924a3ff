//! The smallest mesh and map whose normals are near enough.

use super::judgement::Pair;
use super::low::{self, LowPoly};
use super::maps::{StoredMaps, bake_maps};
use super::options::BakeOptions;
use super::scan::Scan;
use crate::bake::{Simplified, Verifier};
use crate::error::{Error, Result, Warnings};
use crate::image::{Encoding, Texture};
use crate::progress::Progress;
use crate::scene::NormalSpace;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The sizes that are tried: triangles, and texels along a side.
const TRIANGLES: [u32; 9] = [1_000, 2_500, 5_000, 10_000, 20_000, 40_000, 80_000, 150_000, 300_000];
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// Bytes of a triangle with half a vertex, and of a texel of a PNG normal map.
const TRIANGLE: u64 = 36;
const TEXEL: u64 = 2;
/// The number of points at which a trial is measured.
const POINTS: usize = 40_000;

/// A mesh and a map that were tried for a wanted error.
///
/// ```
/// use taotie::asset::{Asset, Trial};
///
/// /// Returns the trial that came nearest to the scan.
/// fn nearest(asset: &Asset) -> Option<&Trial> {
///     asset.trials().iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Trial {
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side.
    pub size: u32,
    /// The mean angle between its normals and the scan's, degrees.
    pub mean_angle: f64,
}

/// The mesh and map that were found.
pub(super) struct Found {
    pub low: LowPoly,
    pub maps: StoredMaps,
    /// Texels along a side.
    pub size: u32,
    pub trials: Vec<Trial>,
    /// The warnings on the way to it.
    pub warnings: Warnings,
}

/// Tries meshes and maps from the smallest file up, passing over those that are coarser both ways than one that failed.
///
/// # Errors
/// [`Error::Invalid`] where none comes within `most` degrees, with the nearest that was found.
pub(super) fn smallest(
    options: &BakeOptions,
    scan: &Scan,
    most: f64,
    progress: Progress<'_>,
) -> Result<Found> {
    let mut trials: Vec<Trial> = Vec::new();
    // Maps of several sizes are tried on the same triangles.
    let mut known: BTreeMap<u32, Simplified> = BTreeMap::new();
    for [triangles, size] in candidates(scan.mesh().triangles().len()) {
        let fails = |trial: &Trial| triangles as usize <= trial.triangles && size <= trial.size;
        if trials.iter().any(fails) {
            continue;
        }
        let simplified = match known.entry(triangles) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(place) => place.insert(low::simplified(scan, triangles, progress)?),
        };
        let low = LowPoly::made(scan, simplified, size, progress)?;
        let pair = Pair { scan, low: &low };
        let maps = bake_maps(options, [size; 2], pair, progress)?;
        let mean_angle = mean_angle(pair, &maps)?;
        trials.push(Trial { triangles: triangles as usize, size, mean_angle });
        if mean_angle <= most {
            let mut warnings = Warnings::default();
            low::note_simplified(simplified, triangles, &mut warnings);
            return Ok(Found { low, maps, size, trials, warnings });
        }
    }
    Err(none_near_enough(most, &trials, scan.mesh().triangles().len()))
}

/// Triangles and texels along a side of candidates coarser than the scan, by the size of the file.
fn candidates(scan: usize) -> Vec<[u32; 2]> {
    let mut candidates: Vec<[u32; 2]> = TRIANGLES
        .into_iter()
        .filter(|triangles| (*triangles as usize) < scan)
        .flat_map(|triangles| SIZES.map(|size| [triangles, size]))
        .collect();
    candidates.sort_by_key(|[t, s]| u64::from(*t) * TRIANGLE + u64::from(*s) * u64::from(*s) * TEXEL);
    candidates
}

fn none_near_enough(most: f64, trials: &[Trial], scan: usize) -> Error {
    let best = trials.iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle));
    let why = match best {
        Some(Trial { triangles, size, mean_angle }) => format!(
            "no mesh and map come so near; the nearest are {triangles} triangles and {size}×{size} texels with \
             {mean_angle:.3}°"
        ),
        None => format!(
            "the scan has {scan} triangles, too few to be simplified; name the number of triangles instead"
        ),
    };
    Error::invalid(format!("a mean normal error of {most}°"), why)
}

fn mean_angle(pair: Pair<'_>, maps: &StoredMaps) -> Result<f64> {
    let Some(bitmap) = maps.textures.normal.clone() else {
        return Err(Error::invalid("a mean normal error", "it needs a normal map in tangent space"));
    };
    let texture = Texture::new(bitmap, Encoding::Normal);
    let verifier = Verifier {
        mesh: &pair.low.mesh,
        normal: Some((&texture, NormalSpace::Tangent)),
        cage: &maps.cage,
        scan: &pair.scan.high,
    };
    let angles = verifier.normal_error(POINTS)?.angles;
    Ok(angles.summary().map_or(f64::INFINITY, |summary| summary.mean))
}
