//! The figures of one level of detail.

use super::material_figures::MaterialFigures;
use super::views::ViewFigures;
use crate::bake::{TexturedMesh, Verifier};
use crate::compare::Summary;
use crate::error::Result;

/// Bins of the histogram.
const BINS: usize = 50;
/// The width of a bin of [`LevelFigures::histogram`], degrees.
///
/// ```
/// use taotie::asset::BIN_WIDTH;
///
/// /// Returns the angles at which a bin begins and ends, degrees.
/// fn range(bin: usize) -> [f64; 2] {
///     [bin, bin + 1].map(|edge| edge as f64 * BIN_WIDTH)
/// }
/// assert_eq!(range(0), [0.0, 0.2]);
/// ```
pub const BIN_WIDTH: f64 = 0.2;

/// The differences of one level of detail from the scan, in numbers. All levels show the same maps.
///
/// ```
/// use taotie::asset::{Figures, LevelFigures};
///
/// /// Returns the number of the coarsest level whose normals are off by less than `degrees` on average.
/// fn coarsest_below(figures: &Figures, degrees: f64) -> Option<usize> {
///     let is_near = |level: &LevelFigures| level.angles.is_some_and(|angles| angles.mean < degrees);
///     figures.levels.iter().rposition(is_near)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LevelFigures {
    /// Triangles.
    pub triangles: usize,
    /// Degrees between the normals shown and the scan's, over points spread evenly; `None` where no point was found.
    pub angles: Option<Summary>,
    /// Their histogram, [`BIN_WIDTH`] a bin; the last is open.
    pub histogram: Vec<u64>,
    /// The same angles without the map: what vertex normals alone would give.
    pub without_map: Option<Summary>,
    /// The part of the points whose projection ray missed the scan, so that its closest point was taken, [0, 1].
    pub missed: f64,
    /// The part for which that failed too; they have no angle.
    pub lost: f64,
    /// The largest distance between the surfaces, model units.
    pub hausdorff: f64,
    /// The same as a part of the diagonal.
    pub hausdorff_of_diagonal: f64,
    /// The root mean square distance, model units.
    pub rms: f64,
    /// The same as a part of the diagonal.
    pub rms_of_diagonal: f64,
    /// The differences of colour and material.
    pub material: MaterialFigures,
    /// Of the images from all sides in one grey material, each against that of the scan.
    pub views: Vec<ViewFigures>,
    /// The same in full material; empty where the scan says nothing of its own.
    pub full_views: Vec<ViewFigures>,
}

/// The numbers of points at which a level is measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointCounts {
    /// At which normals are compared.
    pub normals: usize,
    /// From which distances are measured, on each surface.
    pub distances: usize,
}

impl PointCounts {
    /// Returns a quarter of them, for a coarser level.
    pub fn quarter(self) -> Self {
        Self { normals: (self.normals / 4).max(10), distances: (self.distances / 4).max(1) }
    }
}

/// A level of detail with its normal map and without.
pub(super) struct LevelSurface<'a> {
    pub mapped: Verifier<'a>,
    pub plain: Verifier<'a>,
    /// Its material, where that is compared.
    pub material: Option<&'a TexturedMesh>,
}

impl LevelSurface<'_> {
    /// Measures all but the views. `diagonal` is the scan's, model units.
    ///
    /// # Errors
    /// Those of [`Verifier::normal_error`].
    pub fn figures(&self, points: PointCounts, diagonal: f64) -> Result<LevelFigures> {
        let normal_error = self.mapped.normal_error(points.normals)?;
        let plain = self.plain.normal_error(points.normals / 10)?;
        let deviation = self.mapped.deviation(points.distances)?;
        Ok(LevelFigures {
            triangles: self.mapped.mesh.triangles().len(),
            angles: normal_error.angles.summary(),
            histogram: normal_error.angles.histogram(BINS, (BINS as f64 * BIN_WIDTH) as f32),
            without_map: plain.angles.summary(),
            missed: normal_error.missed,
            lost: normal_error.lost,
            hausdorff: deviation.hausdorff(),
            hausdorff_of_diagonal: deviation.hausdorff() / diagonal,
            rms: deviation.rms(),
            rms_of_diagonal: deviation.rms() / diagonal,
            material: self.material_figures(points.normals)?,
            views: Vec::new(),
            full_views: Vec::new(),
        })
    }

    fn material_figures(&self, points: usize) -> Result<MaterialFigures> {
        let Some(material) = self.material else { return Ok(MaterialFigures::default()) };
        Ok(MaterialFigures::of(&self.mapped.material_error(material, points)?))
    }
}
