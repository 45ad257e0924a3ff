//! The scan beside the asset that was baked from it, and the error of the asset's normals on its surface.

use super::blob::{Blob, bytes_of_words};
use serde::Serialize;
use taotie::bake::{self, Cage, SimplifyOptions, TexturedMesh, Verifier, simplify};
use taotie::compare::{ColorMap, Field};
use taotie::math::Mat4;
use taotie::proof::{CloseUp, Pair, ShapeFigures, Side};
use taotie::render::{Prepared, Surface};
use taotie::scene::{Instance, Material, Scene, SceneData};
use taotie::{Progress, Result, Warnings};

/// The most triangles of a scan that a page shows.
pub const MOST_TRIANGLES: usize = 1_000_000;

/// Texels along a side of the map of errors.
const MAP: u32 = 1024;
/// The last colour stands for this many degrees.
const TOP: f32 = 10.0;
/// Colours of the legend.
const STOPS: usize = 17;
/// Steps of a degree in which errors are stored, and the step that stands for none.
const STEPS: f32 = 100.0;
const NONE: u16 = u16::MAX;
/// Points of each surface at which it is looked at, as many as in a proof.
const POINTS: usize = 20_000;

/// A scan beside its asset.
#[derive(Clone, Copy)]
pub struct ScanSubject<'a> {
    /// Its triangles as they are shown: [`scene_to_show`] makes few enough of them.
    pub shown: &'a Prepared,
    /// All of its triangles.
    pub high: &'a bake::Scan,
}

/// Returns the scene that a page shows of a scan: itself, or its shape in at most [`MOST_TRIANGLES`] triangles, which is
/// noted.
///
/// # Errors
/// As [`simplify`].
pub fn scene_to_show(scene: &Scene, high: &bake::Scan, warnings: &mut Warnings) -> Result<Scene> {
    if scene.triangle_count() <= MOST_TRIANGLES {
        return Ok(scene.clone());
    }
    let options = SimplifyOptions { triangles: MOST_TRIANGLES, ..SimplifyOptions::default() };
    let simple = simplify(high.mesh(), &options, Progress::SILENT)?;
    let what = format!(
        "the page shows {} of the scan's {} triangles, without its colours",
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

/// The error of an asset's normals at the texels of its maps, and the distance of its shape from the scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Errors {
    /// Of each surface; none where it has no uvs, or its normals cannot be looked up so.
    maps: Vec<Option<ErrorMap>>,
    /// Degrees of the last colour, and the colours from 0 to it.
    top: f32,
    stops: Vec<[u8; 3]>,
    /// Steps of a degree.
    steps: f32,
    /// In the unit of the model.
    rms: f64,
    hausdorff: f64,
}

/// A map of errors among the numbers of `errors`, row by row.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ErrorMap {
    width: u32,
    height: u32,
    /// The number of numbers before it.
    from: usize,
    /// Degrees, over all texels.
    mean: f64,
}

/// Measures an asset against its scan. Says what cannot be measured.
pub(super) fn errors(
    prepared: &Prepared,
    high: &bake::Scan,
    warnings: &mut Warnings,
) -> Result<(Errors, Blob)> {
    let mut codes: Vec<u16> = Vec::new();
    let mut maps = Vec::new();
    for (instance, surface) in prepared.surfaces().iter().enumerate() {
        let field =
            is_measurable(surface).then(|| error_map(prepared.scene(), instance, high)).transpose()?;
        warnings.note("surfaces without a map of their normals' error", usize::from(field.is_none()));
        maps.push(field.map(|field| ErrorMap::put(&field, &mut codes)));
    }
    let (scan, asset) = (Side::of(high), bake::Scan::new(Scene::clone(prepared.scene()))?);
    let (asset, diagonal) = (scan.like(&asset), high.mesh().diagonal() as f32);
    let pair = Pair { scan: &scan, asset: &asset, diagonal, has_material: false };
    let close_ups = [CloseUp::of_scan(&pair, POINTS)?, CloseUp::of_asset(&pair, POINTS)?];
    let shape = ShapeFigures::of(&pair, close_ups.each_ref());
    let errors = Errors::new(maps, [shape.rms, shape.hausdorff.upper]);
    Ok((errors, Blob::new("errors", bytes_of_words(codes.into_iter()))))
}

/// The errors of a model that were measured before.
#[derive(Clone, Copy)]
pub struct MeasuredErrors<'a> {
    /// Degrees between the normals of model and scan, over the map of the model's one surface. Where it has several
    /// surfaces no map is shown.
    pub normals: &'a Field,
    /// The root mean square distance of the shapes, in the unit of the model.
    pub rms: f64,
    /// The largest distance, in the unit of the model.
    pub hausdorff: f64,
}

/// The errors of a model of so many surfaces, as they were measured before.
pub(super) fn known_errors(known: &MeasuredErrors<'_>, surfaces: usize) -> (Errors, Blob) {
    let mut codes = Vec::new();
    let maps = match surfaces {
        1 => vec![Some(ErrorMap::put(known.normals, &mut codes))],
        several => vec![None; several],
    };
    let errors = Errors::new(maps, [known.rms, known.hausdorff]);
    (errors, Blob::new("errors", bytes_of_words(codes.into_iter())))
}

/// The error of the normals of one instance at the texels of its map, degrees.
fn error_map(scene: &Scene, instance: usize, high: &bake::Scan) -> Result<Field> {
    let mut own = scene.clone();
    own.edit(|scene| scene.instances = vec![scene.instances[instance]])?;
    let shown = TexturedMesh::new(own)?;
    let (mesh, cage) = (shown.mesh(), Cage::automatic(shown.mesh(), high));
    Verifier { mesh, shown: Some(&shown), cage: &cage, scan: high }.error_map([MAP; 2])
}

impl Errors {
    fn new(maps: Vec<Option<ErrorMap>>, [rms, hausdorff]: [f64; 2]) -> Self {
        let color = |i: usize| ColorMap::Viridis.color(i as f64 / (STOPS - 1) as f64);
        Self { maps, top: TOP, stops: (0..STOPS).map(color).collect(), steps: STEPS, rms, hausdorff }
    }
}

impl ErrorMap {
    fn put(field: &Field, codes: &mut Vec<u16>) -> Self {
        let from = codes.len();
        codes.extend(field.values().iter().map(code));
        let mean = field.summary().map_or(0.0, |summary| summary.mean);
        Self { width: field.width(), height: field.height(), from, mean }
    }
}

fn code(degrees: &f32) -> u16 {
    if degrees.is_nan() { NONE } else { (degrees * STEPS + 0.5).min(f32::from(NONE - 1)) as u16 }
}

/// Returns `true` if the error of a surface's normals can be laid out on its first uvs.
fn is_measurable(surface: &Surface<'_>) -> bool {
    !surface.uvs.is_empty() && !surface.triangles.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::math::Vec3;
    use taotie::mesh::Mesh;
    use taotie::render::SurfaceSettings;

    /// A ball that is pressed flat, with its own normals or still with those of the ball.
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
        let high = bake::Scan::new(pressed([64, 32], true)).unwrap();
        let prepared = Prepared::new(pressed([24, 12], false), &SurfaceSettings::default()).unwrap();
        let (errors, _) = errors(&prepared, &high, &mut Warnings::default()).unwrap();
        let [Some(map)] = &errors.maps[..] else { panic!("a sphere has uvs") };
        // The angle is at most 6.4°.
        assert!(map.mean > 2.0 && map.mean < 6.4, "{errors:?}");
        assert!(errors.rms > 1e-4 && errors.hausdorff < 0.1, "{errors:?}");
        assert_eq!([code(&0.126), code(&f32::NAN), code(&1e9)], [13, NONE, NONE - 1]);
    }

    #[test]
    fn a_small_scan_is_shown_as_it_is() {
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 16, 8), Material::default()).unwrap();
        let high = bake::Scan::new(scene.clone()).unwrap();
        let mut warnings = Warnings::default();
        let shown = scene_to_show(&scene, &high, &mut warnings).unwrap();
        assert_eq!(shown.triangle_count(), scene.triangle_count());
        assert!(warnings.is_empty());
    }
}
