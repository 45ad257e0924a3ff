//! Close-ups to be rendered: the worst patches, and the worst windows of the worst parts.

use super::part_flip::{PartFlip, PartView};
use super::patch_pictures::{MeasuredPatch, PatchPictures};
use crate::compare::DisplayImage;
use crate::error::Result;
use crate::proof::PatchQuantity;
use crate::scene::Camera;

/// Close-ups to render.
#[derive(Default)]
pub(super) struct CloseUps {
    /// The worst patches.
    pub patches: Vec<MeasuredPatch>,
    /// The worst windows of the worst parts.
    pub parts: Vec<PartView>,
}

/// The rendered close-ups.
#[derive(Default)]
pub(super) struct TakenCloseUps {
    /// The worst patches: in grey for normals, in the original materials for colours.
    pub patches: Vec<PatchPictures>,
    /// FLIP of the worst parts, likewise.
    pub parts: Vec<PartFlip>,
}

impl CloseUps {
    /// Separates those for normals from those for colours.
    pub fn by_quantity(self) -> [Self; 2] {
        let (angles, colors) = self.patches.into_iter().partition(|patch| patch.of == PatchQuantity::Angle);
        let (part_angles, part_colors) =
            self.parts.into_iter().partition(|part| part.of == PatchQuantity::Angle);
        [Self { patches: angles, parts: part_angles }, Self { patches: colors, parts: part_colors }]
    }

    /// Returns the cameras, with the pixels along a side of their pictures.
    pub fn shots(&self) -> Vec<(Camera, u32)> {
        let patches = self.patches.iter().map(|patch| (patch.camera.clone(), patch.side));
        patches.chain(self.parts.iter().map(|part| (part.camera.clone(), part.side))).collect()
    }

    /// Adds the rendered pictures of scan and asset, in the order of [`CloseUps::shots`].
    ///
    /// # Errors
    /// Those of [`crate::compare::flip`].
    pub fn with_pictures(self, mut of_patches: Vec<[DisplayImage; 2]>) -> Result<TakenCloseUps> {
        let of_parts = of_patches.split_off(self.patches.len());
        let patches = self.patches.into_iter().zip(of_patches).map(|(patch, pair)| patch.with_pictures(pair));
        let parts = self.parts.iter().zip(&of_parts).map(|(part, pair)| part.with_pictures(pair));
        Ok(TakenCloseUps { patches: patches.collect::<Result<_>>()?, parts: parts.collect::<Result<_>>()? })
    }
}

impl TakenCloseUps {
    /// Appends others.
    pub fn extend(&mut self, others: Self) {
        self.patches.extend(others.patches);
        self.parts.extend(others.parts);
    }
}
