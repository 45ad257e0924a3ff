//! Pictures of the worst patches: scan, asset and their difference.

use super::level_figures::WorstPatches;
use super::part_flip::mean_flip;
use super::shown::ShownLevel;
use crate::compare::{DisplayImage, Field};
use crate::error::Result;
use crate::proof::{Patch, PatchQuantity, PatchView};
use crate::scene::Camera;

/// Scan and asset at a worst patch, seen from the same place.
///
/// ```
/// use taotie::asset::{PatchPictures, Proof};
/// use taotie::proof::PatchQuantity;
///
/// /// Returns the pictures of the patch whose normals differ most.
/// fn worst(proof: &Proof) -> Option<&PatchPictures> {
///     proof.patches.iter().find(|patch| patch.of == PatchQuantity::Angle)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PatchPictures {
    /// The patch.
    pub patch: Patch,
    /// The quantity in which it is the worst.
    pub of: PatchQuantity,
    /// The scan, in grey for a patch of normals, in its own material for one of colours.
    pub scan: DisplayImage,
    /// The asset, likewise.
    pub asset: DisplayImage,
    /// The difference at every other pixel, degrees or CIEDE2000; NaN where there is nothing to compare.
    pub difference: Field,
    /// The mean FLIP between the two pictures, [0, 1].
    pub flip: f64,
}

/// A measured patch, before its pictures are rendered.
pub(super) struct MeasuredPatch {
    pub patch: Patch,
    pub of: PatchQuantity,
    pub camera: Camera,
    /// Pixels along a side of its pictures.
    pub side: u32,
    difference: Field,
}

impl MeasuredPatch {
    /// Compares the worst patches of a level at every other pixel of pictures with `side` pixels along a side; none
    /// if `side` is 0.
    ///
    /// # Errors
    /// Those of [`PatchView::differences`].
    pub fn all(patches: &WorstPatches, level: &ShownLevel<'_>, side: u32) -> Result<Vec<Self>> {
        let scan = level.scan();
        let both = [(patches.angle, PatchQuantity::Angle), (patches.color, PatchQuantity::Color)];
        let wanted = both.into_iter().filter(|_| side > 0);
        let measured = |(patch, of): (Option<Patch>, PatchQuantity)| {
            let patch = patch?;
            let view = PatchView::of(patch.window(), scan.mesh().diagonal());
            let difference = view.differences([scan, &level.surface], of, side.div_ceil(2));
            Some(difference.map(|difference| Self { patch, of, camera: view.camera(), side, difference }))
        };
        wanted.filter_map(measured).collect()
    }

    /// Adds its rendered pictures.
    ///
    /// # Errors
    /// Those of [`crate::compare::flip`].
    pub fn with_pictures(self, [scan, asset]: [DisplayImage; 2]) -> Result<PatchPictures> {
        let Self { patch, of, difference, .. } = self;
        let flip = mean_flip(&scan, &asset)?;
        Ok(PatchPictures { patch, of, scan, asset, difference, flip })
    }
}
