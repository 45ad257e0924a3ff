//! Pictures of scan and asset: from all sides in the same light, in grey and in their own materials; and close up, of
//! the worst patches and parts.

use super::figures::{ViewFigures, WorstParts, WorstPatches};
use super::shown::ShownLevel;
use crate::asset::source::{is_plain, used_materials};
use crate::studio::{EnvironmentOptions, EnvironmentSource};
use taotie_engine::compare::{self, DisplayImage, Field, PIXELS_PER_DEGREE};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::film::Development;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::progress::Progress;
use taotie_engine::proof::{Patch, PatchQuantity, PatchView, Region, WorstRegions};
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Renderer, Shot};
use taotie_engine::scene::{Camera, Material, Orbit, Outline, Scene, three_point_rig};

/// The number of views.
const COUNT: usize = 8;
/// Alternating elevations, degrees above and below the horizon.
const ELEVATIONS: [f64; 2] = [20.0, -12.0];

/// Images of scan and asset and their differences, view by view.
///
/// ```
/// use taotie::asset::{ViewFigures, Views};
///
/// /// Returns the view from which asset and scan differ most.
/// fn worst(views: &Views) -> Option<&ViewFigures> {
///     views.figures.iter().max_by(|a, b| a.flip.total_cmp(&b.flip))
/// }
/// ```
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Views {
    /// Of the scan.
    pub scan: Vec<DisplayImage>,
    /// Of the asset.
    pub asset: Vec<DisplayImage>,
    /// The perceived difference.
    pub flip: Vec<Field>,
    /// The same in numbers.
    pub figures: Vec<ViewFigures>,
}

/// Views of each level of the asset, the finest first, in both looks.
pub(super) struct Looks {
    /// In one grey material, so that only shape and normals differ.
    pub grey: Vec<Views>,
    /// In the original materials; empty if the scan specifies no material.
    pub full: Vec<Views>,
    /// The worst patches and parts: in grey for normals, in the original materials for colours.
    pub close_ups: TakenCloseUps,
}

/// The images to take.
pub(super) struct Wanted {
    /// Pixels along a side of the images from all sides.
    pub side: u32,
    /// The worst patches and parts.
    pub close_ups: CloseUps,
}

/// Renders the scan and each level of the asset in each look, and the close-ups of the finest.
///
/// # Errors
/// [`taotie_engine::Error::Cancelled`]; those of rendering, which do not occur for scenes read from files.
pub(super) fn take(
    scan: Scene,
    levels: Vec<Scene>,
    Wanted { side, close_ups }: Wanted,
    progress: Progress<'_>,
) -> Result<Looks> {
    let mut setting = Setting { cameras: cameras(&scan), side, environment: None };
    let [of_angle, of_color] = close_ups.by_quantity();
    let (mut full, mut colors, mut rest) = (Vec::new(), TakenCloseUps::default(), progress);
    if !is_plain(&scan) {
        setting.environment = environment(std::iter::once(&scan).chain(&levels))?;
        let own = levels.iter().cloned().map(in_own_materials).collect::<Result<Vec<_>>>()?;
        let scene = in_own_materials(scan.clone())?;
        (full, colors) = setting.views((scene, own), of_color, progress.part(0.0, 0.5))?;
        (setting.environment, rest) = (None, progress.part(0.5, 1.0));
    }
    let opacity = if is_plain(&scan) { Opacity::OfMaterials } else { Opacity::Full };
    let levels = levels.into_iter().map(|level| in_grey(level, opacity)).collect::<Result<Vec<_>>>()?;
    let (grey, mut close_ups) = setting.views((in_grey(scan, opacity)?, levels), of_angle, rest)?;
    close_ups.extend(colors);
    Ok(Looks { grey, full, close_ups })
}

/// How images are rendered.
struct Setting {
    cameras: Vec<Camera>,
    /// Pixels along a side.
    side: u32,
    /// The environment light, in place of lights.
    environment: Option<EnvironmentLight>,
}

impl Setting {
    /// Renders the scan and each level, and compares them; also renders the close-ups of the finest level.
    fn views(
        &self,
        (scan, levels): (Scene, Vec<Scene>),
        wanted: CloseUps,
        progress: Progress<'_>,
    ) -> Result<(Vec<Views>, TakenCloseUps)> {
        let near = wanted.shots();
        let shots = |scene: Scene, near: &[(Camera, u32)], progress: Progress<'_>| {
            let around = self.cameras.iter().map(|camera| (camera.clone(), self.side));
            let shots: Vec<_> = around.chain(near.iter().cloned()).collect();
            let mut around = self.pictures(scene, &shots, progress)?;
            let close_ups = around.split_off(self.cameras.len());
            Result::Ok((around, close_ups))
        };
        let (scan, close_ups_of_scan) = shots(scan, &near, progress.part(0.0, 0.5))?;
        let share = 0.5 / levels.len().max(1) as f64;
        let (mut views, mut close_ups) = (Vec::with_capacity(levels.len()), Vec::new());
        for (i, level) in levels.into_iter().enumerate() {
            let from = 0.5 + i as f64 * share;
            let own = if i == 0 { &near[..] } else { &[] };
            let (asset, of_level) = shots(level, own, progress.part(from, from + 0.8 * share))?;
            close_ups.extend(of_level);
            views.push(compared(scan.clone(), asset, progress.part(from + 0.8 * share, from + share))?);
        }
        let pairs = close_ups_of_scan.into_iter().zip(close_ups).map(|(scan, asset)| [scan, asset]);
        Ok((views, wanted.with_pictures(pairs.collect())?))
    }

    /// Renders an image for each camera, with the given number of pixels along a side.
    fn pictures(
        &self,
        scene: Scene,
        shots: &[(Camera, u32)],
        progress: Progress<'_>,
    ) -> Result<Vec<DisplayImage>> {
        let development = Development { background: Some(Vec3::splat(0.03)), ..Development::default() };
        let usual = RenderSettings { samples: 4, ..RenderSettings::default() };
        let mut renderer = Renderer::new(scene, &usual.surface)?;
        let (mut pictures, mut codes) = (Vec::new(), Vec::new());
        for (i, (camera, side)) in shots.iter().enumerate() {
            let [from, to] = [i, i + 1].map(|views| views as f64 / shots.len() as f64);
            let settings = RenderSettings { width: *side, height: *side, ..usual.clone() };
            let lighting = lighting(camera, self.environment.as_ref());
            let shot = Shot { camera, lighting: &lighting, settings: &settings };
            renderer.develop(&shot, &development, &mut codes, progress.part(from, to))?;
            pictures.push(DisplayImage::from_developed(*side, *side, &codes)?);
        }
        Ok(pictures)
    }
}

/// Returns pictures of an angle for each vertex of a mesh, degrees, from the front and from the back, with `side` pixels
/// along a side; NaN elsewhere.
///
/// # Errors
/// Those of rendering.
pub(super) fn vertex_angles(mesh: &Mesh, angles: &[f32], side: u32) -> Result<Vec<Field>> {
    const MOST: f32 = 180.0;
    let colors = angles.iter().map(|angle| [angle / MOST, 0.0, 0.0, 1.0]).collect();
    let MeshData { positions, triangles, .. } = mesh.clone().into_data();
    let painted = Mesh::new(MeshData { positions, triangles, colors, ..MeshData::default() })?;
    let scene = Scene::of_mesh(painted, Material { base_color: [1.0; 4], double_sided: true, ..neutral() })?;
    let (cameras, settings) = (
        cameras(&scene),
        RenderSettings { width: side, height: side, aovs: true, samples: 1, ..RenderSettings::default() },
    );
    let mut renderer = Renderer::new(scene, &settings.surface)?;
    let mut pictures = Vec::new();
    for camera in cameras.iter().step_by(COUNT / 2) {
        let lighting = lighting(camera, None);
        let frame =
            renderer.render(&Shot { camera, lighting: &lighting, settings: &settings }, Progress::SILENT)?;
        let angle = |[red, _, _, seen]: &[f32; 4]| if *seen > 0.0 { red * MOST } else { f32::NAN };
        let values = frame.aovs.iter().flat_map(|aovs| aovs.albedo.pixels()).map(angle).collect();
        pictures.push(Field::new(side, side, values)?);
    }
    Ok(pictures)
}

/// Compares the images view by view.
fn compared(scan: Vec<DisplayImage>, asset: Vec<DisplayImage>, progress: Progress<'_>) -> Result<Views> {
    let mut views = Views { scan, asset, ..Views::default() };
    for (i, (a, b)) in views.scan.iter().zip(&views.asset).enumerate() {
        progress.at(i as f64 / COUNT as f64)?;
        let flip = compare::flip(a, b, PIXELS_PER_DEGREE)?;
        views.figures.push(ViewFigures {
            azimuth_deg: azimuth(i),
            elevation_deg: ELEVATIONS[i % 2],
            flip: flip.mean().unwrap_or(0.0),
            ssim: compare::ssim(a, b)?,
        });
        views.flip.push(flip);
    }
    Ok(views)
}

fn azimuth(view: usize) -> f64 {
    view as f64 * 360.0 / COUNT as f64
}

fn cameras(scene: &Scene) -> Vec<Camera> {
    let outline = Outline::new(scene);
    let Some(bounds) = outline.bounds() else { return Vec::new() };
    let camera = |i: usize| {
        let [azimuth, elevation, fov_y] = [azimuth(i), ELEVATIONS[i % 2], 30.0].map(f64::to_radians);
        let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: bounds.center(), fov_y };
        orbit.distance = outline.fitting_distance(&orbit, 1.0, 0.92);
        orbit.camera(bounds.diagonal() / 2.0)
    };
    (0..COUNT).map(camera).collect()
}

/// The opacity of grey scenes.
#[derive(Clone, Copy, PartialEq)]
enum Opacity {
    /// All is opaque: pictures in full material show transparency.
    Full,
    /// That of materials without a texture, since there are no pictures in full material.
    OfMaterials,
}

/// Returns the scene in one grey material, keeping its normal and height maps and which sides are drawn; vertex colours,
/// textures and lights are removed.
fn in_grey(scene: Scene, opacity: Opacity) -> Result<Scene> {
    let mut data = scene.into_data();
    for mesh in data.meshes.iter_mut().filter(|mesh| !mesh.colors().is_empty()) {
        *mesh = Mesh::new(MeshData { colors: Vec::new(), ..std::mem::take(mesh).into_data() })?;
    }
    for material in &mut data.materials {
        let Material { normal, height, double_sided, alpha, base_color: [.., opaque], .. } = *material;
        let mut grey = Material { normal, height, double_sided, ..neutral() };
        if opacity == Opacity::OfMaterials && material.base_color_texture.is_none() {
            (grey.alpha, grey.base_color[3]) = (alpha, opaque);
        }
        *material = grey;
    }
    data.lights.clear();
    Scene::new(data)
}

/// Returns the scene in its own materials, without its lights.
fn in_own_materials(mut scene: Scene) -> Result<Scene> {
    scene.edit(|data| data.lights.clear())?;
    Ok(scene)
}

fn neutral() -> Material {
    Material { base_color: [0.55, 0.55, 0.55, 1.0], roughness: 0.5, ..Material::default() }
}

/// Returns the environment light for scenes if one of them is metallic, which would be black without it: the built-in
/// studio.
fn environment<'a>(mut scenes: impl Iterator<Item = &'a Scene>) -> Result<Option<EnvironmentLight>> {
    let is_metal = |scene: &Scene| used_materials(scene).any(|material| material.metallic > 0.0);
    let source = scenes.any(is_metal).then_some(EnvironmentSource::Studio);
    EnvironmentOptions { source, ..EnvironmentOptions::default() }.load(&mut Warnings::default())
}

/// Returns the light on a scene: the environment if there is one, else three lights that follow the camera.
fn lighting(camera: &Camera, environment: Option<&EnvironmentLight>) -> Lighting {
    match environment {
        Some(light) => Lighting { environment: Some(light.clone()), ..Lighting::default() },
        None => Lighting { lights: three_point_rig(camera), ambient: Vec3::splat(0.15), environment: None },
    }
}

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
    /// Those of [`taotie_engine::compare::flip`].
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

/// Scan and asset at a worst patch, seen from the same place.
///
/// ```
/// use taotie::asset::{PatchPictures, Proof};
/// use taotie_engine::proof::PatchQuantity;
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
        let all = [
            (patches.angle, PatchQuantity::Angle),
            (patches.color, PatchQuantity::Color),
            (patches.material, PatchQuantity::Material),
        ];
        let wanted = all.into_iter().filter(|_| side > 0);
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
    /// Those of [`taotie_engine::compare::flip`].
    pub fn with_pictures(self, [scan, asset]: [DisplayImage; 2]) -> Result<PatchPictures> {
        let Self { patch, of, difference, .. } = self;
        let flip = mean_flip(&scan, &asset)?;
        Ok(PatchPictures { patch, of, scan, asset, difference, flip })
    }
}

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
/// use taotie_engine::proof::PatchQuantity;
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
fn mean_flip(scan: &DisplayImage, asset: &DisplayImage) -> Result<f64> {
    Ok(compare::flip(scan, asset, PIXELS_PER_DEGREE)?.mean().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(material: Material, colors: Vec<[f32; 4]>) -> Scene {
        let data = Mesh::sphere(1.0, 8, 4).into_data();
        Scene::of_mesh(Mesh::new(MeshData { colors, ..data }).unwrap(), material).unwrap()
    }

    #[test]
    fn grey_is_grey() {
        let count = Mesh::sphere(1.0, 8, 4).positions().len();
        let red = Material { base_color: [1.0, 0.0, 0.0, 0.5], emissive: [1.0; 3], ..Material::default() };
        let grey = in_grey(ball(red, vec![[0.0, 1.0, 0.0, 1.0]; count]), Opacity::Full).unwrap();
        assert!(grey.meshes()[0].colors().is_empty());
        assert_eq!(grey.materials(), [neutral()]);
    }
}
