//! The figures of a proof: the differences of an asset from its scan, in numbers.

use crate::asset::bake::percent;
use taotie_engine::bake::{Fit, MaterialError, TexturedMesh};
use taotie_engine::compare::Summary;
use taotie_engine::error::Result;
use taotie_engine::length::Unit;
use taotie_engine::proof::{
    CloseUp, DistanceBounds, Exceedance, Overview, Pair, Patch, SilhouetteFigures, SurfaceSample,
    WorstRegions,
};
use taotie_engine::surface::uv_islands;

/// The differences of an asset from its scan, in numbers.
///
/// ```
/// use taotie::asset::Figures;
///
/// /// Returns the mean angle by which the map improves on plain vertex normals, degrees, on the surface.
/// fn gain(figures: &Figures) -> Option<f64> {
///     let finest = figures.finest()?;
///     Some(finest.without_map?.mean - finest.surface_angles?.mean)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Figures {
    /// The unit of all lengths, that of the scan's coordinates; `None` if unknown. In JSON it is `unit`, its name,
    /// and `metres_per_unit`.
    #[serde(flatten, with = "unit_as_json")]
    pub unit: Option<Unit>,
    /// One for each level of detail, the finest first.
    pub levels: Vec<LevelFigures>,
    /// The scan's diagonal, in the scan's unit, like all lengths.
    pub diagonal: f64,
    /// How well the meshes fit each other; `None` if the low-poly mesh has no area.
    pub fit: Option<FitFigures>,
    /// Bytes of the scan's files; 0 for a scan in memory.
    pub bytes_in: u64,
    /// Bytes of the asset, including the files that it references.
    pub bytes_out: u64,
    /// Bytes that the asset takes on a graphics card; `None` unless it is glTF.
    pub gpu_bytes: Option<u64>,
    /// One for each material of the asset, if it has several.
    pub parts: Vec<PartFigures>,
    /// Contents that no figure and no image compares.
    pub unseen: Vec<String>,
}

impl Figures {
    /// Returns the figures of the finest level; `None` if nothing was measured.
    pub fn finest(&self) -> Option<&LevelFigures> {
        self.levels.first()
    }
}

/// A unit and its size in metres, which is derived from it.
mod unit_as_json {
    use super::Unit;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Fields {
        /// The unit of all lengths, that of the scan's coordinates; `None` if unknown.
        unit: Option<Unit>,
        /// Its size in metres; `None` if unknown.
        #[serde(skip_deserializing)]
        metres_per_unit: Option<f64>,
    }

    #[allow(clippy::ref_option)] // serde passes the field itself.
    pub fn serialize<S: Serializer>(unit: &Option<Unit>, serializer: S) -> Result<S::Ok, S::Error> {
        Fields { unit: *unit, metres_per_unit: unit.map(Unit::metres) }.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Unit>, D::Error> {
        Fields::deserialize(deserializer).map(|fields| fields.unit)
    }
}

/// How well two meshes fit each other; see [`Fit`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct FitFigures {
    /// The fraction of the low-poly mesh far from the scan.
    pub away: f64,
    /// The fraction that faces the opposite way.
    pub turned: f64,
    /// The mean distance as a fraction of the diagonal.
    pub distance_of_diagonal: f64,
}

impl From<Fit> for FitFigures {
    fn from(fit: Fit) -> Self {
        Self { away: fit.away, turned: fit.turned, distance_of_diagonal: fit.distance }
    }
}

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
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// The histogram of these angles, with bins of [`LevelFigures::BIN_WIDTH`]; the last is open-ended.
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

impl LevelFigures {
    /// The width of a bin of [`LevelFigures::histogram`], degrees.
    ///
    /// ```
    /// use taotie::asset::LevelFigures;
    ///
    /// /// Returns the angles at which a bin begins and ends, degrees.
    /// fn range(bin: usize) -> [f64; 2] {
    ///     [bin, bin + 1].map(|edge| edge as f64 * LevelFigures::BIN_WIDTH)
    /// }
    /// assert_eq!(range(0), [0.0, 0.2]);
    /// ```
    pub const BIN_WIDTH: f64 = 0.2;
}

/// The worst windows of one per cent of the visible surface, seen close up, of scan and asset.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct WorstPatches {
    /// The window with the largest mean angle between normals, degrees.
    pub angle: Option<Patch>,
    /// The window with the largest mean colour difference, CIEDE2000; `None` if colours are not compared.
    pub color: Option<Patch>,
    /// The window with the largest mean difference of metallic, roughness or occlusion, [0, 1]; `None` if materials are not
    /// compared.
    #[serde(default)]
    pub material: Option<Patch>,
    /// The window in which most of the scan's relief or colours is lost, relative to their variation there, or most of the
    /// asset's colours is not the scan's.
    #[serde(default)]
    pub detail: Option<Patch>,
}

/// Surface that one of the two shows and the other lacks, as shares of area, [0, 1]. Surface on which only the asset is
/// unlit (KHR_materials_unlit) counts as lacking on both: it does not show the scan's relief.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
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
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Resolution {
    /// The median width of the asset's finest texels, model units.
    pub texel: f64,
    /// The factor by which coarser texels exceed the scan's detail, at the 95th percentile; 1 if none is coarser.
    pub coarser: f64,
    /// The share of the visible area where they are more than twice as coarse, [0, 1].
    pub share: f64,
}

impl Resolution {
    /// Describes the lost detail; `None` if there is none.
    pub fn loss(&self) -> Option<String> {
        let (times, share) = (self.coarser, percent(self.share));
        let text = format!("up to {times:.1} × coarser than the scan's detail on {share} of the surface");
        (self.share > 0.0).then_some(text)
    }
}

/// Limits that requirements name: the shares are exact at these.
#[derive(Debug, Clone, Default)]
pub(super) struct AskedLimits {
    /// Degrees.
    pub angles: Vec<f64>,
    /// CIEDE2000.
    pub colors: Vec<f64>,
    /// Per cent of the diagonal.
    pub distances: Vec<f64>,
}

/// The shares of the visible surface beyond given limits, seen close up, the worse of scan and asset.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Beyond {
    /// Limits of the angle between normals, degrees; surface that the other one lacks counts as 90, as does surface
    /// on which only the asset is unlit.
    pub angle: Option<Exceedance>,
    /// Limits of the colour difference, CIEDE2000; `None` if colours are not compared.
    pub color: Option<Exceedance>,
    /// Limits of the distance to the other surface, per cent of the diagonal.
    pub distance: Option<Exceedance>,
}

impl Beyond {
    /// Counts the close-up samples of scan and asset.
    pub(super) fn of(surfaces: [&CloseUp; 2], diagonal: f32, asked: &AskedLimits) -> Self {
        let curve = |difference: &dyn Fn(&SurfaceSample) -> f32, asked: &[f64]| {
            let [scan, asset] = surfaces.map(|of| of.samples.iter().map(difference).collect::<Vec<f32>>());
            Exceedance::of([&scan, &asset], asked)
        };
        Self {
            angle: curve(&|sample| sample.angle_deg, &asked.angles),
            color: curve(&|sample| sample.color, &asked.colors),
            distance: curve(&|sample| sample.distance / diagonal * 100.0, &asked.distances),
        }
    }
}

/// The UV islands and materials of an asset that differ most from the scan, seen close up.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct WorstParts {
    /// The worst of its UV islands; `None` without uvs, or if there is only one.
    pub islands: Option<WorstRegions>,
    /// The worst of its materials; `None` if there is only one.
    pub materials: Option<WorstRegions>,
    /// The names of the materials, in the order of their numbers; empty if there is only one.
    pub material_names: Vec<String>,
}

impl WorstParts {
    /// Compares the parts of an asset.
    ///
    /// # Errors
    /// Those of [`WorstRegions::of`].
    pub(super) fn of(pair: &Pair<'_>, of_asset: &CloseUp) -> Result<Self> {
        let asset = pair.asset.surface.surface();
        let mesh = asset.mesh();
        let worst = |labels: Vec<u32>| -> Result<Option<WorstRegions>> {
            match labels.iter().any(|label| *label != labels[0]) {
                true => WorstRegions::of(pair, of_asset, &labels).map(Some),
                false => Ok(None),
            }
        };
        let islands = if mesh.uvs().is_empty() { None } else { worst(uv_islands(mesh))? };
        let numbers = 0..mesh.triangles().len() as u32;
        let materials = worst(numbers.map(|t| asset.material_number(t) as u32).collect())?;
        let material_names = materials.as_ref().map_or_else(Vec::new, |_| names(asset));
        Ok(Self { islands, materials, material_names })
    }
}

/// Returns the names of the materials in the order of the first triangles that use them.
fn names(asset: &TexturedMesh) -> Vec<String> {
    let mut numbers: Vec<usize> = Vec::new();
    let mut names = Vec::new();
    for t in 0..asset.mesh().triangles().len() as u32 {
        let number = asset.material_number(t);
        if !numbers.contains(&number) {
            numbers.push(number);
            names.push(match asset.material(t).name.as_str() {
                "" => format!("material {number}"),
                name => name.to_owned(),
            });
        }
    }
    names
}

/// The differences between the materials of an asset and its scan, over evenly spread points; all `None` if the scan
/// specifies no material, or no point was found.
///
/// ```
/// use taotie::asset::MaterialFigures;
///
/// /// Returns `true` if a difference of colour is hardly visible.
/// fn keeps_its_colors(material: &MaterialFigures) -> bool {
///     material.color.is_some_and(|color| color.mean < 1.0 && color.p95 < 3.0)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
#[non_exhaustive]
pub struct MaterialFigures {
    /// CIEDE2000 between the base colours; about 1 is just visible.
    pub color: Option<Summary>,
    /// Between the metallic values, [0, 1].
    pub metallic: Option<Summary>,
    /// Between the perceptual roughness values, [0, 1].
    pub roughness: Option<Summary>,
    /// Between the emitted radiances, in the channel that differs most.
    pub emission: Option<Summary>,
    /// Between the alphas, [0, 1]; those of a mask are 0 or 1.
    pub alpha: Option<Summary>,
    /// The share of the points at which a value of scan or asset is not finite, [0, 1]: these values are in none of
    /// the summaries.
    pub not_finite: f64,
}

impl MaterialFigures {
    /// Summarizes measured errors.
    pub(super) fn of(error: &MaterialError) -> Self {
        Self {
            color: error.color.summary(),
            metallic: error.metallic.summary(),
            roughness: error.roughness.summary(),
            emission: error.emission.summary(),
            alpha: error.alpha.summary(),
            not_finite: error.not_finite,
        }
    }

    /// Returns the differences of scalar properties with their names, in reporting order.
    pub fn numbers(&self) -> [(&'static str, Option<Summary>); 4] {
        [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("emission", self.emission),
            ("alpha", self.alpha),
        ]
    }
}

/// The difference between an image of an asset and that of its scan.
///
/// ```
/// use taotie::asset::ViewFigures;
///
/// /// Returns a row of a table.
/// fn row(view: &ViewFigures) -> String {
///     format!("{:>4}° {:>4}° {:.3} {:.3}", view.azimuth_deg, view.elevation_deg, view.flip, view.ssim)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct ViewFigures {
    /// The azimuth of the view, degrees.
    pub azimuth_deg: f64,
    /// Degrees above the horizon.
    pub elevation_deg: f64,
    /// The mean FLIP, [0, 1]; 0 if equal.
    pub flip: f64,
    /// SSIM; 1 if equal.
    pub ssim: f64,
}

/// The differences of the triangles of one material from the scan, in numbers.
///
/// ```
/// use taotie::asset::{Figures, PartFigures};
///
/// /// Returns the material with the largest normal error.
/// fn worst(figures: &Figures) -> Option<&PartFigures> {
///     let mean = |part: &PartFigures| part.angles.map_or(f64::INFINITY, |angles| angles.mean);
///     figures.parts.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)))
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct PartFigures {
    /// The name of the material as used in file names.
    pub material: String,
    /// Triangles.
    pub triangles: usize,
    /// Degrees between the displayed normals and the scan's; `None` if no point was found.
    pub angles: Option<Summary>,
    /// The same without the normal map.
    pub without_map: Option<Summary>,
    /// The share of points whose projection ray missed the scan.
    pub missed: f64,
    /// The share for which no point of the scan was found at all.
    pub lost: f64,
}
