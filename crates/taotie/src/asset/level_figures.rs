//! The figures of one level of detail.

use super::beyond::{AskedLimits, Beyond};
use super::material_figures::MaterialFigures;
use super::regions::WorstParts;
use super::seen::Seen;
use super::view_figures::ViewFigures;
use crate::bake::{MaterialError, TexturedMesh, Verifier};
use crate::compare::{Field, Summary};
use crate::error::Result;
use crate::math::Mat4;
use crate::proof::{
    CloseUp, DistanceBounds, Overview, Pair, Patch, SilhouetteFigures, most_missing, root_mean_square,
    share_interval,
};

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
/// Three kinds of figures: *as seen* ([`LevelFigures::overview`], [`LevelFigures::patches`]) compares the same pixel
/// of scan and asset; *silhouette* compares outlines; *on the surface* compares each point of the asset with the
/// point of the scan that its projection ray meets.
///
/// ```
/// use taotie::asset::{Figures, LevelFigures};
///
/// /// Returns the number of the coarsest level whose normals are off by less than `degrees` on average, as seen.
/// fn coarsest_below(figures: &Figures, degrees: f64) -> Option<usize> {
///     let is_near = |level: &LevelFigures| level.overview.angles.is_some_and(|angles| angles.summary.mean < degrees);
///     figures.levels.iter().rposition(is_near)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LevelFigures {
    /// Triangles.
    pub triangles: usize,
    /// As seen: differences at the same pixel, with the object filling 512²; a coarser level at the size at which it
    /// is first shown.
    pub overview: Overview,
    /// As seen close up: the worst windows of one per cent of the visible surface.
    pub patches: WorstPatches,
    /// As seen close up: the worst UV island and the worst material.
    pub worst_parts: WorstParts,
    /// As seen close up: the share of the visible surface beyond any limit.
    pub beyond: Beyond,
    /// The deviation of outlines.
    pub silhouette: SilhouetteFigures,
    /// Surface that one of the two shows and the other lacks.
    pub coverage: Coverage,
    /// The largest distance between the visible parts of the surfaces, model units.
    pub hausdorff: DistanceBounds,
    /// The same as a fraction of the diagonal.
    pub hausdorff_of_diagonal: DistanceBounds,
    /// The root mean square distance of visible points, model units.
    pub rms: f64,
    /// The same as a fraction of the diagonal.
    pub rms_of_diagonal: f64,
    /// How the asset's texels compare with the scan's detail; `None` without textures.
    pub resolution: Option<Resolution>,
    /// On the surface: degrees between the displayed normals and the scan's, over evenly spread points; `None` if no
    /// point was found.
    pub surface_angles: Option<Summary>,
    /// The histogram of these angles, with bins of [`BIN_WIDTH`]; the last is open-ended.
    pub histogram: Vec<u64>,
    /// The same angles without the map, from plain vertex normals.
    pub without_map: Option<Summary>,
    /// The share of points whose projection ray missed the scan, so that its closest point was used, [0, 1].
    pub surface_missed: f64,
    /// On the surface: the differences of colour and material.
    pub material: MaterialFigures,
    /// For the images from all sides in one grey material, each compared with the scan's.
    pub views: Vec<ViewFigures>,
    /// The same in full material; empty if the scan does not specify any.
    pub full_views: Vec<ViewFigures>,
}

/// The worst windows of one per cent of the visible surface, seen close up, of scan and asset.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WorstPatches {
    /// The window with the largest mean angle between normals, degrees.
    pub angle: Option<Patch>,
    /// The window with the largest mean difference of base colours, CIEDE2000; `None` if colours are not compared.
    pub color: Option<Patch>,
}

/// Surface that one of the two shows and the other lacks, as shares of area, [0, 1].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Coverage {
    /// The share of the scan's visible area where the asset shows nothing, or another part of the object.
    pub missed_of_scan: f64,
    /// The share of the asset's visible area where the scan shows nothing, or another part of the object.
    pub missed_of_asset: f64,
    /// The 99 % interval of the larger of the two.
    pub missed_interval: [f64; 2],
    /// The middle of the place where most is missing, model units; `None` if nothing is.
    pub missed_at: Option<[f64; 3]>,
    /// The share of the scan's visible area within half a per cent of the diagonal of the asset.
    pub completeness: f64,
    /// The share of the scan's area that cannot be seen: hidden walls, ghost layers, duplicate shells, closed cavities.
    pub hidden_of_scan: f64,
    /// `true` if the scan is an interior, seen from within: a room, a tomb, a cave.
    pub is_interior: bool,
}

impl Coverage {
    /// Returns the share of the visible area that is missing, the worse of both directions.
    pub fn missed(&self) -> f64 {
        self.missed_of_scan.max(self.missed_of_asset)
    }
}

/// How the asset's texels compare with the finest detail of its scan: a texel of its textures, or half its median
/// edge.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Resolution {
    /// The median width of the asset's finest texels, model units.
    pub texel: f64,
    /// The factor by which coarser texels exceed the scan's detail, at the 95th percentile; 1 if none is coarser.
    pub coarser: f64,
    /// The share of the visible area where they are more than twice as coarse, [0, 1].
    pub share: f64,
}

/// The triangles of one material at a level of detail, with their normal map and without.
pub(super) struct PartSurface<'a> {
    pub mapped: Verifier<'a>,
    pub plain: Verifier<'a>,
    /// Their material, if it is compared.
    pub material: Option<&'a TexturedMesh>,
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

/// Measures each part along the rays of a bake, at `points` points spread evenly over the total area.
///
/// # Errors
/// Those of [`Verifier::normal_error`].
pub(super) fn measured(parts: &[PartSurface<'_>], points: usize) -> Result<Vec<Measured>> {
    if let [only] = parts {
        return Ok(vec![only.measured(points)?]);
    }
    let areas: Vec<f64> = parts.iter().map(|part| part.mapped.mesh.area(&Mat4::IDENTITY)).collect();
    let all: f64 = areas.iter().sum();
    let count = |area: f64| (points as f64 * area / all).max(1.0) as usize;
    parts.iter().zip(areas).map(|(part, area)| part.measured(count(area))).collect()
}

impl LevelFigures {
    /// Returns the figures on the surface, from the measurements of all parts.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] for more than 2^32 − 1 points.
    pub(super) fn on_surface(found: &[Measured], triangles: usize) -> Result<Self> {
        let angles = chained(found.iter().map(|part| &part.angles))?;
        let plain = chained(found.iter().map(|part| &part.plain))?;
        Ok(Self {
            triangles,
            surface_angles: angles.summary(),
            histogram: angles.histogram(BINS, (BINS as f64 * BIN_WIDTH) as f32),
            without_map: plain.summary(),
            surface_missed: weighted(found, |part| part.missed),
            material: material_figures(found)?,
            ..Self::default()
        })
    }

    /// Adds what a viewer sees of the level.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a surface has no area.
    pub(super) fn with_seen(self, pair: &Pair<'_>, seen: &Seen, asked: &AskedLimits) -> Result<Self> {
        let [of_scan, of_asset] = &seen.close_ups;
        let (rms, diagonal) = (root_mean_square([of_scan, of_asset]), f64::from(pair.diagonal));
        Ok(Self {
            overview: seen.overview.clone(),
            patches: WorstPatches {
                angle: seen.worse_patch(pair, |sample| sample.angle_deg)?,
                color: seen.worse_patch(pair, |sample| sample.color)?,
            },
            worst_parts: WorstParts::of(pair, of_asset)?,
            beyond: Beyond::of([of_scan, of_asset], pair.diagonal, asked),
            silhouette: seen.silhouette,
            coverage: coverage(pair, [of_scan, of_asset]),
            hausdorff: seen.hausdorff,
            hausdorff_of_diagonal: seen.hausdorff.scaled(1.0 / diagonal),
            rms,
            rms_of_diagonal: rms / diagonal,
            resolution: resolution(of_scan, of_asset),
            ..self
        })
    }
}

/// The distance, as a fraction of the diagonal, within which the asset counts as complete.
const COMPLETE: f32 = 0.005;
fn coverage(pair: &Pair<'_>, [of_scan, of_asset]: [&CloseUp; 2]) -> Coverage {
    let worse = if of_asset.missing() > of_scan.missing() { of_asset } else { of_scan };
    let near = of_scan.samples.iter().filter(|sample| sample.distance <= pair.diagonal * COMPLETE).count();
    Coverage {
        missed_of_scan: of_scan.missing(),
        missed_of_asset: of_asset.missing(),
        missed_interval: share_interval(worse.missing(), worse.samples.len()),
        missed_at: most_missing(worse),
        completeness: near as f64 / of_scan.samples.len().max(1) as f64,
        hidden_of_scan: of_scan.hidden,
        is_interior: pair.scan.visibility.is_interior(),
    }
}

/// Returns how coarse the asset's texels are; `None` if it has none.
fn resolution(of_scan: &CloseUp, of_asset: &CloseUp) -> Option<Resolution> {
    /// The factor above which texels lose detail.
    const TWICE: f32 = 2.0;
    let numbers = |values: Vec<f32>| {
        let mut values: Vec<f32> = values.into_iter().filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f32::total_cmp);
        values
    };
    let texels = numbers(of_asset.samples.iter().map(|sample| sample.texel).collect());
    let texel = f64::from(*texels.get(texels.len() / 2)?);
    let coarser = numbers(of_scan.samples.iter().map(|sample| sample.coarser).collect());
    let lossy = &coarser[coarser.partition_point(|v| *v <= TWICE)..];
    let share = lossy.len() as f64 / coarser.len().max(1) as f64;
    let p95 = lossy.get(lossy.len() * 95 / 100).map_or(1.0, |v| f64::from(*v));
    Some(Resolution { texel, coarser: p95, share })
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

/// Returns the values of several fields as one row.
pub(super) fn chained<'a>(fields: impl Iterator<Item = &'a Field>) -> Result<Field> {
    let values: Vec<f32> = fields.flat_map(|field| field.values()).copied().collect();
    Field::new(values.len() as u32, 1, values)
}

/// Returns fields stacked vertically, left-aligned; narrower ones are padded with NaN.
pub(super) fn stacked(fields: &[Field]) -> Result<Field> {
    let width = fields.iter().map(Field::width).max().unwrap_or_default();
    let mut values = Vec::new();
    for field in fields {
        for row in field.values().chunks(field.width() as usize) {
            values.extend_from_slice(row);
            values.extend(std::iter::repeat_n(f32::NAN, width as usize - row.len()));
        }
    }
    Field::new(width, fields.iter().map(Field::height).sum(), values)
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
        let columns = [Field::new(1, 2, vec![1.0, 2.0]).unwrap(), Field::new(2, 1, vec![3.0, 4.0]).unwrap()];
        let stack = stacked(&columns).unwrap();
        assert_eq!((stack.width(), stack.height()), (2, 3));
        let known: Vec<f32> = stack.values().iter().copied().filter(|value| !value.is_nan()).collect();
        assert_eq!(known, [1.0, 2.0, 3.0, 4.0]);
        assert!(stack.values()[1].is_nan() && stack.values()[3].is_nan(), "next to the narrower one");
    }
}
