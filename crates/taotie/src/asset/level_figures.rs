//! The figures of one level of detail.

use super::material_figures::MaterialFigures;
use super::views::ViewFigures;
use crate::bake::{MaterialError, TexturedMesh, Verifier};
use crate::compare::{Field, Summary};
use crate::error::Result;
use crate::math::Mat4;

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

/// The triangles of one material at a level of detail, with their normal map and without.
pub(super) struct PartSurface<'a> {
    pub mapped: Verifier<'a>,
    pub plain: Verifier<'a>,
    /// Their material, where that is compared.
    pub material: Option<&'a TexturedMesh>,
}

/// A level of detail.
pub(super) struct LevelSurface<'a> {
    /// Its parts, by material.
    pub parts: Vec<PartSurface<'a>>,
    /// All of its triangles, from which distances are measured.
    pub whole: Verifier<'a>,
}

/// The differences of the triangles of one material, point by point.
pub(super) struct Measured {
    pub angles: Field,
    pub plain: Field,
    pub missed: f64,
    pub lost: f64,
    material: Option<MaterialError>,
}

impl PartSurface<'_> {
    fn measured(&self, points: usize) -> Result<Measured> {
        let normal_error = self.mapped.normal_error(points)?;
        Ok(Measured {
            plain: self.plain.normal_error((points / 10).max(1))?.angles,
            missed: normal_error.missed,
            lost: normal_error.lost,
            angles: normal_error.angles,
            material: self.material.map(|own| self.mapped.material_error(own, points)).transpose()?,
        })
    }
}

impl LevelSurface<'_> {
    /// Measures each part, at points that are spread evenly over the area of all.
    ///
    /// # Errors
    /// Those of [`Verifier::normal_error`].
    pub fn measured(&self, points: PointCounts) -> Result<Vec<Measured>> {
        if let [only] = &self.parts[..] {
            return Ok(vec![only.measured(points.normals)?]);
        }
        let areas: Vec<f64> = self.parts.iter().map(|part| part.mapped.mesh.area(&Mat4::IDENTITY)).collect();
        let all: f64 = areas.iter().sum();
        let count = |area: f64| (points.normals as f64 * area / all).max(1.0) as usize;
        self.parts.iter().zip(areas).map(|(part, area)| part.measured(count(area))).collect()
    }

    /// Returns all figures but those of the views. `diagonal` is the scan's, model units.
    ///
    /// # Errors
    /// Those of [`Verifier::deviation`].
    pub fn figures(&self, found: &[Measured], points: PointCounts, diagonal: f64) -> Result<LevelFigures> {
        let angles = chained(found.iter().map(|part| &part.angles))?;
        let plain = chained(found.iter().map(|part| &part.plain))?;
        let deviation = self.whole.deviation(points.distances)?;
        Ok(LevelFigures {
            triangles: self.whole.mesh.triangles().len(),
            angles: angles.summary(),
            histogram: angles.histogram(BINS, (BINS as f64 * BIN_WIDTH) as f32),
            without_map: plain.summary(),
            missed: weighted(found, |part| part.missed),
            lost: weighted(found, |part| part.lost),
            hausdorff: deviation.hausdorff(),
            hausdorff_of_diagonal: deviation.hausdorff() / diagonal,
            rms: deviation.rms(),
            rms_of_diagonal: deviation.rms() / diagonal,
            material: material_figures(found)?,
            views: Vec::new(),
            full_views: Vec::new(),
        })
    }
}

/// Returns the mean of a figure over the points of all parts.
fn weighted(found: &[Measured], figure: impl Fn(&Measured) -> f64) -> f64 {
    if let [only] = found {
        return figure(only);
    }
    let points = |part: &Measured| part.angles.values().len() as f64;
    let sum: f64 = found.iter().map(|part| figure(part) * points(part)).sum();
    sum / found.iter().map(points).sum::<f64>()
}

fn material_figures(found: &[Measured]) -> Result<MaterialFigures> {
    let errors: Option<Vec<&MaterialError>> = found.iter().map(|part| part.material.as_ref()).collect();
    let Some(errors) = errors else { return Ok(MaterialFigures::default()) };
    let all = |of: fn(&MaterialError) -> &Field| chained(errors.iter().map(|error| of(error)));
    Ok(MaterialFigures::of(&MaterialError {
        color: all(|error| &error.color)?,
        metallic: all(|error| &error.metallic)?,
        roughness: all(|error| &error.roughness)?,
        emission: all(|error| &error.emission)?,
        alpha: all(|error| &error.alpha)?,
        not_finite: weighted(found, |part| part.material.as_ref().map_or(0.0, |error| error.not_finite)),
    }))
}

/// Returns one row of the numbers of several fields.
pub(super) fn chained<'a>(fields: impl Iterator<Item = &'a Field>) -> Result<Field> {
    let values: Vec<f32> = fields.flat_map(|field| field.values()).copied().collect();
    Field::new(values.len() as u32, 1, values)
}

/// Returns fields of one width, one below the other.
pub(super) fn stacked(fields: &[Field]) -> Result<Field> {
    let values: Vec<f32> = fields.iter().flat_map(Field::values).copied().collect();
    let height = fields.iter().map(Field::height).sum();
    Field::new(fields.first().map_or(0, Field::width), height, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(angles: &[f32], missed: f64) -> Measured {
        let row = |values: &[f32]| Field::new(values.len() as u32, 1, values.to_vec()).unwrap();
        Measured { angles: row(angles), plain: row(&[1.0]), missed, lost: 0.0, material: None }
    }

    #[test]
    fn parts_count_by_their_points() {
        let found = [measured(&[1.0, 2.0, 3.0], 0.0), measured(&[10.0], 1.0)];
        let all = chained(found.iter().map(|part| &part.angles)).unwrap();
        assert_eq!((all.values().len(), all.summary().unwrap().mean), (4, 4.0));
        assert_eq!(weighted(&found, |part| part.missed), 0.25);
        let columns = [Field::new(1, 2, vec![1.0, 2.0]).unwrap(), Field::new(1, 1, vec![3.0]).unwrap()];
        let stack = stacked(&columns).unwrap();
        assert_eq!((stack.width(), stack.height(), stack.values()), (1, 3, &[1.0, 2.0, 3.0][..]));
    }
}
