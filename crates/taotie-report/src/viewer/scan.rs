//! The scan from which the asset was baked, and the normal error on the asset's surface.

use super::document::{Blob, bytes_of_words};
use serde::Serialize;
use taotie::asset::{Figures, Proof, Scan, VerifyOptions, measure};
use taotie_engine::bake::{
    self, Cage, SimplifyOptions, TexelChecks, TexturedMesh, Verifier, leading_texture, simplify,
};
use taotie_engine::compare::{ColorMap, Field};
use taotie_engine::length::Unit;
use taotie_engine::math::Mat4;
use taotie_engine::render::{Prepared, Surface};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};
use taotie_engine::{Progress, Result, Warnings};

/// The maximum number of triangles of a scan that a page shows.
pub const MOST_TRIANGLES: usize = 1_000_000;

/// The side of the error map, texels.
const MAP: u32 = 1024;
/// The maximum side of the error map in a report, texels.
const SHRUNK: u32 = 512;
/// The angle at the end of the colour scale of errors, degrees.
const TOP: f32 = 10.0;
/// The number of colours in the legend.
const STOPS: usize = 17;
/// The number of steps per degree in which errors are stored, and the code for no value.
const STEPS: f32 = 100.0;
const NONE: u16 = u16::MAX;

/// The scan of an asset.
#[derive(Clone, Copy)]
pub struct ScanSubject<'a> {
    /// All its triangles, against which the asset is measured.
    pub measured: &'a Scan,
    /// The triangles published with the page, limited by [`scene_to_show`]. With `None`, the scan is not published.
    pub published: Option<&'a Prepared>,
}

/// Returns the scene that a page shows for a scan: the scan, or its shape simplified to at most [`MOST_TRIANGLES`]
/// triangles, with a warning.
///
/// # Errors
/// Those of [`simplify`].
pub fn scene_to_show(scene: &Scene, high: &bake::Scan, warnings: &mut Warnings) -> Result<Scene> {
    if scene.triangle_count() <= MOST_TRIANGLES {
        return Ok(scene.clone());
    }
    let options = SimplifyOptions { triangles: MOST_TRIANGLES, ..SimplifyOptions::default() };
    let simple = simplify(high.mesh(), &options, Progress::SILENT)?;
    let what = format!(
        "the page shows the scan simplified to {} of {} triangles, without colours",
        simple.mesh.triangles().len(),
        scene.triangle_count()
    );
    warnings.note(what, 1);
    Scene::new(SceneData {
        meshes: vec![simple.mesh],
        materials: vec![Material::default()],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    })
}

/// Degrees at the texels of an asset's maps: its normal error, or the uncertainty of its normals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Errors {
    quantity: Quantity,
    /// The map of each surface; `None` if it has no uvs or its normals cannot be laid out on them.
    maps: Vec<Option<ErrorMap>>,
    /// The degrees at the last colour, and the colours from 0 to it.
    top: f32,
    stops: Vec<[u8; 3]>,
    /// Steps per degree.
    steps: f32,
    /// The mean on the surface in degrees; of errors, from the proof rather than from the texels.
    mean: Option<f64>,
    /// The distance from the scan.
    distance: Option<Distance>,
}

/// The meaning of the degrees on a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Quantity {
    Error,
    Uncertainty,
}

/// Distances of two shapes, in the unit of the model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Distance {
    /// Root mean square.
    rms: f64,
    /// Upper bound of the largest.
    hausdorff: f64,
}

/// An error map in the blob `errors`, row by row.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ErrorMap {
    width: u32,
    height: u32,
    /// Its offset, in numbers.
    from: usize,
    /// The uv set of its layout.
    uv_set: usize,
    /// The transform from these uvs to the map: the rows of the linear part, then the offset.
    transform: [f32; 6],
}

/// Measures an asset against its scan, as a proof does, and adds warnings.
pub(super) fn errors(prepared: &Prepared, scan: &Scan, warnings: &mut Warnings) -> Result<(Errors, Blob)> {
    let (figures, found) = measure(prepared.scene(), scan, &VerifyOptions::default(), Progress::SILENT)?;
    warnings.absorb(found);
    let mut codes: Vec<u16> = Vec::new();
    let mut maps = Vec::new();
    for (instance, surface) in prepared.surfaces().iter().enumerate() {
        let map = match is_measurable(surface) {
            true => error_map(prepared.scene(), instance, scan.sorted())?,
            false => None,
        };
        warnings.note("surfaces without a normal error map", usize::from(map.is_none()));
        maps.push(map.map(|field| ErrorMap::put(&field, surface, &mut codes)));
    }
    let errors = Errors::new(maps, ShownFigures::of(&figures));
    Ok((errors, Blob::new("errors", bytes_of_words(codes.into_iter()))))
}

/// The errors of a model that were measured earlier, or its uncertainty.
#[derive(Clone, Copy)]
pub struct MeasuredErrors<'a> {
    /// Degrees over the map of the model's single surface. With several surfaces, no map is shown.
    normals: &'a Field,
    figures: ShownFigures,
}

impl<'a> MeasuredErrors<'a> {
    /// Returns the errors of a proof; `None` if the model has no map on which they could be shown.
    pub fn of(proof: &'a Proof) -> Option<Self> {
        let figures = ShownFigures::of(&proof.figures);
        proof.error_map.as_ref().map(|normals| Self { normals, figures })
    }

    /// Returns the uncertainty of normals from photographs: degrees, with its mean, and the value of the last colour.
    pub fn of_uncertainty(sigma: &'a Field, mean: f64, top: f32) -> Self {
        let figures = ShownFigures { quantity: Quantity::Uncertainty, top, mean: Some(mean), distance: None };
        Self { normals: sigma, figures }
    }
}

/// The figures of a proof that the viewer shows.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ShownFigures {
    quantity: Quantity,
    /// The degrees at the last colour.
    top: f32,
    /// The mean on the surface, degrees.
    mean: Option<f64>,
    distance: Option<Distance>,
}

impl ShownFigures {
    fn of(figures: &Figures) -> Self {
        let finest = figures.finest();
        let mean = finest.and_then(|finest| finest.surface_angles).map(|angles| angles.mean);
        // Models are in metres if the unit of the scan is known.
        let metres = figures.unit.map_or(1.0, Unit::metres);
        let distance = finest
            .map(|finest| Distance { rms: finest.rms * metres, hausdorff: finest.hausdorff.upper * metres });
        Self { quantity: Quantity::Error, top: TOP, mean, distance }
    }
}

/// Returns the errors of a model with these surfaces, as measured earlier.
pub(super) fn known_errors(known: &MeasuredErrors<'_>, surfaces: &[Surface<'_>]) -> (Errors, Blob) {
    let mut codes = Vec::new();
    let maps = match surfaces {
        [only] => vec![Some(ErrorMap::put_shrunk(known.normals, only, &mut codes))],
        several => vec![None; several.len()],
    };
    let errors = Errors::new(maps, known.figures);
    (errors, Blob::new("errors", bytes_of_words(codes.into_iter())))
}

/// Returns the normal error of one instance at the texels of its map, degrees; `None` if its maps repeat too often.
fn error_map(scene: &Scene, instance: usize, high: &bake::Scan) -> Result<Option<Field>> {
    let mut own = scene.clone();
    own.edit(|scene| scene.instances = vec![scene.instances[instance]])?;
    let shown = TexturedMesh::new(own)?;
    let (mesh, cage) = (shown.mesh(), Cage::automatic(shown.mesh(), high));
    let verifier = Verifier { mesh, shown: Some(&shown), cage: &cage, scan: high };
    Ok(verifier.error_maps([MAP; 2], TexelChecks::default())?.map(|maps| maps.angles))
}

impl Errors {
    fn new(maps: Vec<Option<ErrorMap>>, figures: ShownFigures) -> Self {
        let ShownFigures { quantity, top, mean, distance } = figures;
        let color = |i: usize| ColorMap::Viridis.color(i as f64 / (STOPS - 1) as f64);
        let stops = (0..STOPS).map(color).collect();
        Self { quantity, maps, top, stops, steps: STEPS, mean, distance }
    }
}

impl ErrorMap {
    /// Stores a subsampled map with no side longer than [`SHRUNK`].
    fn put_shrunk(field: &Field, surface: &Surface<'_>, codes: &mut Vec<u16>) -> Self {
        let step = field.width().max(field.height()).div_ceil(SHRUNK).max(1);
        let (width, height, from) = (field.width() / step, field.height() / step, codes.len());
        let at = |i: u32| (i / width * step * field.width() + i % width * step) as usize;
        codes.extend((0..width * height).map(|i| code(&field.values()[at(i)])));
        Self::on(surface, [width, height], from)
    }

    fn put(field: &Field, surface: &Surface<'_>, codes: &mut Vec<u16>) -> Self {
        let from = codes.len();
        codes.extend(field.values().iter().map(code));
        Self::on(surface, [field.width(), field.height()], from)
    }

    /// Describes a map of this size with the layout of the surface's maps.
    fn on(surface: &Surface<'_>, [width, height]: [u32; 2], from: usize) -> Self {
        let lead = leading_texture(surface.material, surface.uvs.len());
        let (uv_set, used) = lead.map(|lead| (lead.uv_set, lead.transform)).unwrap_or_default();
        let ([[a, b], [c, d]], [e, f]) = (used.linear, used.offset);
        Self { width, height, from, uv_set, transform: [a, b, c, d, e, f] }
    }
}

fn code(degrees: &f32) -> u16 {
    if degrees.is_nan() { NONE } else { (degrees * STEPS + 0.5).min(f32::from(NONE - 1)) as u16 }
}

/// Returns `true` if the normal error of a surface can be laid out on its uvs.
fn is_measurable(surface: &Surface<'_>) -> bool {
    !surface.uvs.is_empty() && !surface.triangles.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::Vec3;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::SurfaceSettings;

    /// A flattened sphere, with either its own normals or those of the sphere.
    fn pressed([columns, rows]: [usize; 2], own: bool) -> Scene {
        let mut data = Mesh::sphere(1.0, columns, rows).into_data();
        for v in 0..data.positions.len() {
            let (p, n) = (data.positions[v], data.normals[v]);
            data.positions[v] = Vec3::new(p.x, 0.8 * p.y, p.z);
            data.normals[v] = if own { Vec3::new(n.x, n.y / 0.8, n.z).normalize() } else { n };
        }
        Scene::of_mesh(Mesh::new(data).unwrap(), Material::default()).unwrap()
    }

    #[test]
    fn wrong_normals_have_their_error() {
        let scan = Scan::from_scene(pressed([64, 32], true), Progress::SILENT).unwrap();
        let prepared = Prepared::new(pressed([24, 12], false), &SurfaceSettings::default()).unwrap();
        let (errors, _) = errors(&prepared, &scan, &mut Warnings::default()).unwrap();
        assert!(matches!(&errors.maps[..], [Some(_)]), "a sphere has uvs");
        // The angle is at most 6.4°.
        let mean = errors.mean.unwrap();
        assert!(mean > 2.0 && mean < 6.4, "{errors:?}");
        let Some(distance) = errors.distance else { panic!("{errors:?}") };
        assert!(distance.rms > 1e-4 && distance.hausdorff < 0.1, "{errors:?}");
        assert_eq!([code(&0.126), code(&f32::NAN), code(&1e9)], [13, NONE, NONE - 1]);
    }

    #[test]
    fn the_figures_are_those_of_a_proof() {
        let scan = Scan::from_scene(pressed([64, 32], true), Progress::SILENT).unwrap();
        let model = pressed([24, 12], false);
        let options = VerifyOptions::default();
        let (figures, _) = measure(&model, &scan, &options, Progress::SILENT).unwrap();
        let prepared = Prepared::new(model, &SurfaceSettings::default()).unwrap();
        let (errors, _) = errors(&prepared, &scan, &mut Warnings::default()).unwrap();
        let finest = figures.finest().unwrap();
        assert_eq!(errors.mean, finest.surface_angles.map(|angles| angles.mean));
        let distance = Distance { rms: finest.rms, hausdorff: finest.hausdorff.upper };
        assert_eq!((errors.distance, errors.quantity), (Some(distance), Quantity::Error));
    }

    #[test]
    fn a_displaced_model_is_rejected() {
        let scan = Scan::from_scene(pressed([64, 32], true), Progress::SILENT).unwrap();
        let mut data = Mesh::sphere(1.0, 24, 12).into_data();
        data.positions.iter_mut().for_each(|p| p.x += 5.0);
        let model = Scene::of_mesh(Mesh::new(data).unwrap(), Material::default()).unwrap();
        let prepared = Prepared::new(model, &SurfaceSettings::default()).unwrap();
        let error = errors(&prepared, &scan, &mut Warnings::default()).err().unwrap().to_string();
        assert!(error.contains("the meshes do not overlap: 100.0 %"), "{error}");
    }

    #[test]
    fn a_small_scan_is_shown_unchanged() {
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 16, 8), Material::default()).unwrap();
        let high = bake::Scan::new(scene.clone()).unwrap();
        let mut warnings = Warnings::default();
        let shown = scene_to_show(&scene, &high, &mut warnings).unwrap();
        assert_eq!(shown.triangle_count(), scene.triangle_count());
        assert!(warnings.is_empty());
    }
}
