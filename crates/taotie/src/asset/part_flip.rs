//! FLIP at the worst windows of the worst UV islands and materials.

use super::regions::WorstParts;
use crate::compare::{self, DisplayImage, PIXELS_PER_DEGREE};
use crate::error::Result;
use crate::proof::{PatchQuantity, PatchView, Region, WorstRegions};
use crate::scene::Camera;

/// A part that an asset is divided into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// A UV island.
    Island,
    /// The triangles of one material.
    Material,
}

/// FLIP between scan and asset, close up, where the worst UV island or the worst material differs most.
///
/// ```
/// use taotie::asset::{PartFlip, PartKind, Proof};
/// use taotie::proof::PatchQuantity;
///
/// /// Returns FLIP at the worst window of the UV island with the largest normal error.
/// fn worst_island(proof: &Proof) -> Option<f64> {
///     let is_it = |found: &&PartFlip| (found.part, found.of) == (PartKind::Island, PatchQuantity::Angle);
///     proof.part_flips.iter().find(is_it).map(|found| found.flip)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PartFlip {
    /// The kind of the part.
    pub part: PartKind,
    /// The quantity in which it is the worst: pictures are in grey for normals, in full material for colours.
    pub of: PatchQuantity,
    /// The mean FLIP between the two pictures, [0, 1].
    pub flip: f64,
}

/// The worst window of a part, before pictures are rendered.
pub(super) struct PartView {
    part: PartKind,
    pub of: PatchQuantity,
    pub camera: Camera,
    /// Pixels along a side of its pictures.
    pub side: u32,
}

impl PartView {
    /// Returns views of the worst parts of an object with this diagonal, model units, for pictures of `side` pixels;
    /// none if `side` is 0.
    pub fn all(parts: &WorstParts, diagonal: f64, side: u32) -> Vec<Self> {
        let both = [(PartKind::Island, &parts.islands), (PartKind::Material, &parts.materials)];
        let regions = both.into_iter().filter(|_| side > 0).flat_map(|(part, worst)| {
            let of = |worst: &WorstRegions| {
                [(PatchQuantity::Angle, worst.angle.clone()), (PatchQuantity::Color, worst.color.clone())]
            };
            worst.iter().flat_map(of).map(move |(of, region)| (part, of, region)).collect::<Vec<_>>()
        });
        let view = |(part, of, region): (PartKind, PatchQuantity, Option<Region>)| {
            let camera = PatchView::of(region?.worst, diagonal).camera();
            Some(Self { part, of, camera, side })
        };
        regions.filter_map(view).collect()
    }

    /// Compares its rendered pictures of scan and asset.
    ///
    /// # Errors
    /// Those of [`compare::flip`].
    pub fn with_pictures(&self, [scan, asset]: &[DisplayImage; 2]) -> Result<PartFlip> {
        let flip = mean_flip(scan, asset)?;
        Ok(PartFlip { part: self.part, of: self.of, flip })
    }
}

/// Returns the mean FLIP between two pictures, [0, 1].
///
/// # Errors
/// Those of [`compare::flip`].
pub(super) fn mean_flip(scan: &DisplayImage, asset: &DisplayImage) -> Result<f64> {
    Ok(compare::flip(scan, asset, PIXELS_PER_DEGREE)?.summary().map_or(0.0, |flip| flip.mean))
}
