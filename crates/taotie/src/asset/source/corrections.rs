//! How a scan is read where its file is ambiguous or faulty: the options, and the corrections of winding, normals and
//! green.

use super::extent::{Extent, Spot, Whole};
use crate::inspection::Pixels;
use std::collections::BTreeMap;
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::length::Unit;
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData, with_flat_normals};
use taotie_engine::names::Named;
use taotie_engine::parallel;
use taotie_engine::scene::{GreenChannel, Material, NormalMap, NormalSpace, Scene, SceneData};
use taotie_engine::surface::{
    Bends, GreenVerdict, MODELLED_CREASE_DEG, Opposed, facet_normal, looks_scanned,
};

/// How a scan is read if its file is ambiguous. Built by `Default` and struct update.
///
/// ```no_run
/// use taotie::Progress;
/// use taotie::asset::{ScanFile, ScanOptions};
/// use taotie::Limits;
///
/// let options = ScanOptions { crease_angle_deg: Some(40.0), ..ScanOptions::default() };
/// let file = ScanFile::read("bracket.stl", &Limits::default(), Progress::SILENT)?;
/// let scan = file.with_options(options).into_scan(Progress::SILENT)?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct ScanOptions {
    /// The angle between facets above which an edge is hard, degrees, [0, 180]: 0 keeps all facets flat, 180 smooths
    /// everything. It applies to meshes without normals, or with one per facet. `None` smooths scans and keeps the
    /// hard edges of modelled shapes.
    pub crease_angle_deg: Option<f64>,
    /// The direction of green in the scan's tangent-space normal maps; `None` trusts the file unless the pixels
    /// contradict it.
    pub green: Option<GreenChannel>,
    /// The unit of the scan's coordinates; `None` is the metre for glTF, as its specification requires, and for FBX,
    /// and an unknown unit for other formats. If a scan has files of both kinds, it is required: those that state
    /// their unit are converted to it.
    pub unit: Option<Unit>,
}

impl ScanOptions {
    /// Returns these options, with unset ones taken from `others`.
    ///
    /// ```
    /// use taotie::asset::ScanOptions;
    /// use taotie_engine::length::Unit;
    ///
    /// let recorded = ScanOptions { crease_angle_deg: Some(40.0), unit: Some(Unit::Inch), ..ScanOptions::default() };
    /// let given = ScanOptions { unit: Some(Unit::Millimetre), ..ScanOptions::default() };
    /// let both = given.or(recorded);
    /// assert_eq!((both.crease_angle_deg, both.unit), (Some(40.0), Some(Unit::Millimetre)));
    /// ```
    #[must_use]
    pub fn or(self, others: Self) -> Self {
        Self {
            crease_angle_deg: self.crease_angle_deg.or(others.crease_angle_deg),
            green: self.green.or(others.green),
            unit: self.unit.or(others.unit),
        }
    }

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a crease angle outside [0, 180].
    pub fn check(&self) -> Result<()> {
        match self.crease_angle_deg {
            Some(angle) if !(0.0..=180.0).contains(&angle) => {
                let why = "it must be between 0 and 180 degrees: 0 keeps all facets, 180 smooths everything";
                Err(Error::invalid(format!("crease angle {angle}"), why))
            }
            _ => Ok(()),
        }
    }

    /// Returns the command-line arguments for all options that differ from the defaults.
    pub(in crate::asset) fn arguments(&self) -> Vec<String> {
        let crease_angle = self.crease_angle_deg.map(|angle| ("--crease-angle", angle.to_string()));
        let green = self.green.map(|green| ("--scan-green", green.name().to_owned()));
        let unit = self.unit.map(|unit| ("--unit", unit.name().to_owned()));
        let all = [crease_angle, green, unit].into_iter().flatten();
        all.flat_map(|(name, value)| [name.to_owned(), value]).collect()
    }
}

/// Returns the metres of a unit other than the metre, by which an asset's root node is scaled; `None` if there is
/// nothing to scale.
pub(in crate::asset) fn root_scale(unit: Option<Unit>) -> Option<f32> {
    unit.filter(|unit| *unit != Unit::Metre).map(|unit| unit.metres() as f32)
}

/// Converts a scan's scene, with coordinates in `unit`, to the space of its assets, which are in metres.
///
/// ```
/// use taotie::asset::into_metres;
/// use taotie::{Material, Mesh, Scene};
/// use taotie_engine::length::Unit;
///
/// let mut scan = Scene::of_mesh(Mesh::sphere(40.0, 16, 8), Material::default())?;
/// into_metres(&mut scan, Some(Unit::Millimetre))?;
/// assert!(scan.bounds().unwrap().max.y < 0.041);
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if its transforms are no longer finite.
pub fn into_metres(scene: &mut Scene, unit: Option<Unit>) -> Result<()> {
    match root_scale(unit) {
        Some(scale) => scaled(scene, |v| v * f64::from(scale)),
        None => Ok(()),
    }
}

/// Converts a glTF scene to the space of a scan in this unit. An asset written for that scan gets its transforms back
/// bit for bit: they are divided by the scale of its root node.
pub(in crate::asset) fn from_metres(scene: &mut Scene, unit: Option<Unit>) -> Result<()> {
    match root_scale(unit) {
        Some(scale) => scaled(scene, |v| v / f64::from(scale)),
        None => Ok(()),
    }
}

/// Applies a function to the scales and translations of all instances.
fn scaled(scene: &mut Scene, change: impl Fn(f64) -> f64) -> Result<()> {
    let mut data = std::mem::take(scene).into_data();
    for instance in &mut data.instances {
        for column in &mut instance.world_from_object.columns {
            column[..3].iter_mut().for_each(|v| *v = change(*v));
        }
    }
    *scene = Scene::new(data)?;
    Ok(())
}

/// Returns `true` if a scene that should be in metres has the size of a model with this diagonal in `unit`: its unconverted
/// diagonal is closer to it than in metres.
pub(super) fn is_in_unit(scene: &Scene, unit: Unit, diagonal: f64) -> bool {
    let Some((own, scale)) = scene.bounds().zip(root_scale(Some(unit))) else { return false };
    // The ratio of the sizes, closest to 1 up to √scale.
    own.diagonal() / diagonal > f64::from(scale).sqrt()
}

/// A file of a scan of several.
pub(super) struct FileUnit<'a> {
    /// Its path.
    pub name: String,
    pub scene: &'a mut Scene,
    /// The unit that its format states, which is then the metre.
    pub stated: Option<Unit>,
}

/// Converts files that state their unit, and are thus in metres, to that of the others, and returns the unit of all.
///
/// # Errors
/// [`Error::Invalid`] if they state different units, or one seems not to be in metres.
pub(super) fn to_one_unit(files: Vec<FileUnit<'_>>, given: Option<Unit>) -> Result<Option<Unit>> {
    let (stated, others): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| file.stated.is_some());
    let (Some(first), Some(other)) = (stated.first(), others.first()) else {
        return Ok(given.or(stated.first().and_then(|file| file.stated)));
    };
    let Some(unit) = given else {
        let why = format!(
            "its unit is unknown, but {} is in metres, as its format states; state the unit of files like it with \
             --unit, such as --unit mm, or --unit m if it is in metres too",
            first.name
        );
        return Err(Error::invalid(&other.name, why));
    };
    let bounds = others.iter().filter_map(|file| file.scene.bounds());
    let diagonal = bounds.reduce(|all, own| all.united(&own)).map_or(0.0, |all| all.diagonal());
    for file in stated {
        if is_in_unit(file.scene, unit, diagonal) {
            let why = format!(
                "its format is in metres, but its size suggests {unit}, as the other files of the scan are; scale it to \
                 metres, or save it in a format without a unit, such as PLY",
                unit = unit.name()
            );
            return Err(Error::invalid(file.name, why));
        }
        from_metres(file.scene, given)?;
    }
    Ok(given)
}

/// Corrects faults and gaps of a scan according to the options, and notes them.
///
/// # Errors
/// Those of [`ScanOptions::check`].
pub(super) fn corrected(scene: Scene, options: &ScanOptions, warnings: &mut Warnings) -> Result<Scene> {
    let mut parts = scene.into_data();
    turn_triangles(&mut parts, options.unit, warnings)?;
    compute_normals(&mut parts, options, warnings)?;
    note_contradicting_normals(&parts, options.unit, warnings);
    set_green(&mut parts, options, warnings);
    Scene::new(parts)
}

/// The share of the surface above which normals contradicting the geometry cause a warning.
const CONTRADICTED: f64 = 0.005;

/// Triangles in several meshes, as spots.
#[derive(Default)]
struct Found {
    triangles: usize,
    spots: Vec<Spot>,
    /// The unit of their coordinates.
    unit: Option<Unit>,
}

/// Flips triangles that are wound opposite to the surface around them, and notes where. Triangles whose correct
/// orientation is unclear are noted and left unchanged.
///
/// # Errors
/// None for meshes that were checked.
fn turn_triangles(parts: &mut SceneData, unit: Option<Unit>, warnings: &mut Warnings) -> Result<()> {
    let (mut turned, mut doubtful) = (Found::with(unit), Found::with(unit));
    for i in 0..parts.meshes.len() {
        let opposed = Opposed::of(&parts.meshes[i]);
        turned.add(parts, i, &opposed.reversed);
        doubtful.add(parts, i, &opposed.doubtful);
        if !opposed.reversed.is_empty() {
            parts.meshes[i] = with_turned(std::mem::take(&mut parts.meshes[i]), &opposed.reversed)?;
        }
    }
    let text = |count, extent| {
        format!(
            "reversed winding of some triangles of the scan, flipped to match neighbours: {count} triangles, {extent}"
        )
    };
    turned.note(parts, text, warnings);
    let text = |count, extent| {
        format!(
            "parts of the scan face opposite ways, and it is unclear which is right: {count} triangles, {extent}; make \
             their winding consistent in a modelling program"
        )
    };
    doubtful.note(parts, text, warnings);
    Ok(())
}

/// Notes normals of the scan that point to the opposite side of their triangles.
fn note_contradicting_normals(parts: &SceneData, unit: Option<Unit>, warnings: &mut Warnings) {
    let mut found = Found::with(unit);
    for (i, mesh) in parts.meshes.iter().enumerate().filter(|(_, mesh)| !mesh.normals().is_empty()) {
        let turned: Vec<u32> = turned(mesh).into_iter().map(|t| t as u32).collect();
        found.add(parts, i, &turned);
    }
    let Some(extent) = found.extent(parts).filter(|extent| extent.share > CONTRADICTED) else { return };
    let advice = match extent.share > 0.5 {
        true => "the scan is inside out, or its normals are: reverse one of them",
        false => "recompute its normals in a modelling program, or export it without",
    };
    let text = format!("normals of the scan contradict its triangles, by more than 90°: {extent}; {advice}");
    warnings.note(text, 1);
}

/// Returns the triangles that face away from the mean of their corners' normals.
pub(in crate::asset) fn turned(mesh: &Mesh) -> Vec<usize> {
    parallel::filter(mesh.triangles().len(), |t| {
        let [a, b, c] = mesh.triangles()[t].map(|v| mesh.normals()[v as usize]);
        let [p, q, r] = mesh.corners(t).map(Vec3::to_f64);
        (q - p).cross(r - p).dot((a + b + c).to_f64()) < 0.0
    })
}

impl Found {
    fn with(unit: Option<Unit>) -> Self {
        Self { unit, ..Self::default() }
    }

    fn add(&mut self, parts: &SceneData, mesh: usize, triangles: &[u32]) {
        for m in if triangles.is_empty() { Vec::new() } else { placements(parts, mesh) } {
            self.triangles += triangles.len();
            let spot = |t: &u32| Spot::of_triangle(&parts.meshes[mesh], *t as usize, &m);
            self.spots.extend(triangles.iter().map(spot));
        }
    }

    fn extent(&self, parts: &SceneData) -> Option<Extent> {
        if self.spots.is_empty() { None } else { Extent::of(&self.spots, Whole::of(parts, self.unit)) }
    }

    fn note(&self, parts: &SceneData, text: impl Fn(usize, Extent) -> String, warnings: &mut Warnings) {
        if let Some(extent) = self.extent(parts) {
            warnings.note(text(self.triangles, extent), 1);
        }
    }
}

/// Returns a mesh with some of its triangles flipped. Normals that only they use and that would then contradict them
/// are negated too, along with the handedness of their tangents.
fn with_turned(mesh: Mesh, triangles: &[u32]) -> Result<Mesh> {
    let mut is_shared = vec![true; mesh.positions().len()];
    let mut data = mesh.into_data();
    for t in triangles {
        data.triangles[*t as usize].iter().for_each(|v| is_shared[*v as usize] = false);
        data.triangles[*t as usize].swap(1, 2);
    }
    let mut is_turned = vec![false; data.triangles.len()];
    triangles.iter().for_each(|t| is_turned[*t as usize] = true);
    let staying = data.triangles.iter().zip(&is_turned).filter(|(_, is_turned)| !**is_turned);
    staying.flat_map(|(triangle, _)| triangle).for_each(|v| is_shared[*v as usize] = true);
    for t in triangles {
        let corners = data.triangles[*t as usize];
        let facet = facet_normal(corners.map(|v| data.positions[v as usize]));
        for v in corners.map(|v| v as usize).into_iter().filter(|v| !is_shared[*v]) {
            let Some(normal) = data.normals.get_mut(v) else { break };
            if facet.is_some_and(|facet| facet.dot(*normal) < 0.0) {
                *normal = -*normal;
                if let Some(tangent) = data.tangents.get_mut(v) {
                    tangent[3] = -tangent[3];
                }
            }
        }
    }
    Mesh::new(data)
}

/// The changes made to the meshes of a scan.
#[derive(Default)]
struct Outcome {
    /// Meshes that had one normal per facet and are now smooth everywhere.
    smoothed: usize,
    /// Meshes to which the crease angle applied.
    affected: usize,
    /// The number of hard edges.
    hard: usize,
    /// The midpoints of the hard edges, by length.
    spots: Vec<Spot>,
    /// The length of all edges of the meshes that have hard ones.
    length: f64,
}

/// Computes normals of meshes that have none or one per facet, wherever they split at hard edges; elsewhere they are
/// removed, so that smooth ones are computed. Meshes with a tangent-space normal map keep theirs: the map is relative
/// to them. All changes are noted.
///
/// # Errors
/// Those of [`ScanOptions::check`].
fn compute_normals(parts: &mut SceneData, options: &ScanOptions, warnings: &mut Warnings) -> Result<()> {
    options.check()?;
    let is_mapped = mapped(parts);
    let mut outcome = Outcome::default();
    for (i, is_mapped) in is_mapped.into_iter().enumerate() {
        let mesh = &parts.meshes[i];
        let has_facets = is_faceted(mesh);
        if mesh.triangles().is_empty() || is_mapped || !(mesh.normals().is_empty() || has_facets) {
            continue;
        }
        outcome.affected += 1;
        let placed = placements(parts, i);
        let mesh = std::mem::take(&mut parts.meshes[i]);
        parts.meshes[i] = match options.crease_angle_deg {
            Some(angle) if angle <= 0.0 && has_facets => mesh,
            Some(angle) if angle <= 0.0 => Mesh::new(with_flat_normals(&mesh.into_data()))?,
            _ => outcome.with_normals(mesh, &placed, options)?,
        };
        outcome.smoothed += usize::from(has_facets && parts.meshes[i].normals().is_empty());
    }
    outcome.note(options, parts, warnings);
    Ok(())
}

/// Returns the transform of each instance of a mesh.
fn placements(parts: &SceneData, mesh: usize) -> Vec<Mat4> {
    let shown = parts.instances.iter().filter(|instance| instance.mesh == mesh);
    shown.map(|instance| instance.world_from_object).collect()
}

/// Returns for each mesh whether it has a tangent-space normal map.
fn mapped(parts: &SceneData) -> Vec<bool> {
    let mut is_mapped = vec![false; parts.meshes.len()];
    for instance in &parts.instances {
        let normal = parts.materials[instance.material].normal;
        is_mapped[instance.mesh] |= normal.is_some_and(|map| map.space == NormalSpace::Tangent);
    }
    is_mapped
}

impl Outcome {
    /// Returns a mesh with normals split at its hard edges; without normals if it has none.
    fn with_normals(&mut self, mesh: Mesh, placed: &[Mat4], options: &ScanOptions) -> Result<Mesh> {
        let smooth = |mesh: Mesh| {
            Mesh::new(MeshData { normals: Vec::new(), tangents: Vec::new(), ..mesh.into_data() })
        };
        if options.crease_angle_deg.is_none() && looks_scanned(&mesh)? {
            return smooth(mesh);
        }
        let bends = Bends::of(&mesh);
        let crease = options.crease_angle_deg.unwrap_or(MODELLED_CREASE_DEG).to_radians();
        let hard = match options.crease_angle_deg {
            Some(_) => bends.sharper_than(crease),
            None => bends.modelled(),
        };
        if hard.is_empty() {
            return smooth(mesh);
        }
        let total = bends.total_length();
        for m in placed {
            let scale = scalar::cbrt(m.determinant3().abs());
            self.length += scale * total;
            self.hard += hard.len();
            self.spots.extend(hard.iter().map(|edge| {
                let [a, b] = bends.ends(*edge);
                Spot { at: m.transform_point((a + b) * 0.5), amount: scale * bends.length(*edge) }
            }));
        }
        bends.split_at(&hard, crease)
    }

    fn note(&self, options: &ScanOptions, parts: &SceneData, warnings: &mut Warnings) {
        if options.crease_angle_deg.is_some() && self.affected == 0 {
            warnings.note("the crease angle has no effect: the scan has its own normals, which are kept", 1);
        }
        let smoothed =
            "flat-shaded scan: smooth normals computed; a crease angle keeps edges hard, 0 all facets";
        warnings.note(smoothed, self.smoothed);
        if self.spots.is_empty() {
            return;
        }
        let whole = Whole { amount: self.length, ..Whole::of(parts, options.unit) };
        let Some(extent) = Extent::of(&self.spots, whole) else { return };
        let crease = options.crease_angle_deg.unwrap_or(MODELLED_CREASE_DEG);
        let advice = match options.crease_angle_deg {
            Some(_) => "",
            None => "; set a crease angle of 180 to smooth all of them, or 0 to keep all facets",
        };
        let text = format!(
            "scan without smooth normals: smoothed below {crease}°, {} hard edges kept ({} of the length of its edges, most \
             of it around {}){advice}",
            self.hard,
            extent.percent(),
            extent.place()
        );
        warnings.note(text, 1);
    }
}

/// Returns the maximum number of vertices that computing normals may add to a scene as read, over all instances.
pub(super) fn added_vertices(scene: &Scene, options: &ScanOptions) -> u64 {
    /// The crease angle below which most vertices of a scan are split, degrees.
    const SPLITTING: f64 = 20.0;
    if options.crease_angle_deg.is_none_or(|angle| angle > SPLITTING) {
        return 0;
    }
    let added = |mesh: &Mesh| (3 * mesh.triangles().len()).saturating_sub(mesh.positions().len()) as u64;
    let meshes = scene.instances().iter().map(|instance| &scene.meshes()[instance.mesh]);
    meshes.filter(|mesh| mesh.normals().is_empty()).map(added).sum()
}

/// Returns `true` if the triangles of a mesh share nothing and each has one normal.
fn is_faceted(mesh: &Mesh) -> bool {
    let is_alone = |(t, triangle): (usize, &[u32; 3])| *triangle == [0, 1, 2].map(|i| 3 * t as u32 + i);
    let is_flat = |normals: &[Vec3]| normals[0] == normals[1] && normals[1] == normals[2];
    !mesh.normals().is_empty()
        && mesh.triangles().iter().enumerate().all(is_alone)
        && mesh.normals().chunks_exact(3).all(is_flat)
}

/// Sets the direction of green of all tangent-space normal maps that the scan uses. Without a choice by the caller,
/// maps whose pixels show that green points down are read as such, and noted.
fn set_green(parts: &mut SceneData, options: &ScanOptions, warnings: &mut Warnings) {
    let mut is_used = vec![false; parts.materials.len()];
    parts.instances.iter().for_each(|instance| is_used[instance.material] = true);
    let mut down: BTreeMap<usize, Option<f32>> = BTreeMap::new();
    let mut has_maps = false;
    let textures = &parts.textures;
    for (material, _) in parts.materials.iter_mut().zip(is_used).filter(|(_, is_used)| *is_used) {
        let is_tangent = |map: &&mut NormalMap| map.space == NormalSpace::Tangent;
        let Some(map) = material.normal.as_mut().filter(is_tangent) else { continue };
        has_maps = true;
        if let Some(green) = options.green {
            map.green = green;
            continue;
        }
        if map.green == GreenChannel::Down {
            continue;
        }
        let texture = map.texture.texture;
        let confidence = *down.entry(texture).or_insert_with(|| {
            let pixels = Pixels::of(textures[texture].bitmap());
            let is_down = pixels.green_by_pixels == Some(GreenVerdict::Down);
            pixels.green_confidence.filter(|_| is_down)
        });
        if let Some(confidence) = confidence {
            map.green = GreenChannel::Down;
            let name = if material.name.is_empty() { "a material without a name" } else { &material.name };
            let text = format!(
                "normal map of the scan with green pointing down (DirectX), {}; read as such: {name}; set the direction of \
                 green to up if it bakes inverted relief",
                surely(confidence)
            );
            warnings.note(text, 1);
        }
    }
    if options.green.is_some() && !has_maps {
        warnings.note("the direction of green has no effect: the scan has no tangent-space normal map", 1);
    }
}

/// Returns `true` if green points down in a normal map, which a glTF file cannot state: it was read so because of its
/// pixels or the options.
pub(super) fn has_green_down(scene: &Scene) -> bool {
    let is_down = |material: &Material| material.normal.is_some_and(|map| map.green == GreenChannel::Down);
    scene.materials().iter().any(is_down)
}

/// Returns a confidence in words; it is never certain.
fn surely(confidence: f32) -> String {
    format!("{:.1} % sure from its pixels", (100.0 * f64::from(confidence)).min(99.9))
}

/// Checks that positions are not rounded too coarsely for the size of a scan, in model units: single precision has about
/// seven digits.
///
/// # Errors
/// [`Error::Invalid`] if they are.
pub(super) fn check_rounding((mesh, path): (&Mesh, &Path), warnings: &mut Warnings) -> Result<()> {
    /// Fractions of the diagonal: angles suffer visibly beyond the first, and the shape beyond the second.
    const FINE: f64 = 1e-5;
    const COARSE: f64 = 1e-3;
    let (rounding, diagonal) = (f64::from(mesh.largest_coordinate() * f32::EPSILON), mesh.diagonal());
    if rounding <= diagonal * FINE || diagonal == 0.0 {
        return Ok(());
    }
    let center = mesh.positions().iter().fold(Vec3::<f64>::default(), |sum, p| sum + p.to_f64())
        / mesh.positions().len().max(1) as f64;
    // Few digits, but small compared with the scan: whole numbers, or decimals of a scan smaller than 1.
    let mut steps = 1.0;
    while steps * diagonal < 1.0 && steps < 1e15 {
        steps *= 10.0;
    }
    let [x, y, z] = center.to_array().map(|v| (v * steps).round() / steps);
    let percent = rounding / diagonal * 100.0;
    let what = format!(
        "its coordinates are too far from the origin: single precision rounds them by up to {percent:.2} % of its \
         diagonal; subtract a fixed offset, such as ({x}, {y}, {z}), from all of them first"
    );
    if rounding > diagonal * COARSE {
        let name = if path.as_os_str().is_empty() { "the scan".into() } else { path.to_string_lossy() };
        return Err(Error::invalid(name, what));
    }
    warnings.note(what, 1);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_to_subtract_suits_the_size_of_the_scan() {
        let advice = |radius: f64, away: f32| {
            let data = Mesh::sphere(radius, 16, 8).into_data();
            let moved = |p: &Vec3| Vec3::new(p.x + away, p.y, p.z);
            let positions = data.positions.iter().map(moved).collect();
            let mesh = Mesh::new(MeshData { positions, ..data }).unwrap();
            let mut warnings = Warnings::default();
            check_rounding((&mesh, Path::new("")), &mut warnings).unwrap();
            warnings.iter().map(|(what, _)| what.to_owned()).collect::<String>()
        };
        assert!(advice(1.0, 2000.0).contains("(2000, 0, 0)"), "{}", advice(1.0, 2000.0));
        assert!(advice(0.001, 0.5).contains("(0.5, 0, 0)"), "{}", advice(0.001, 0.5));
        assert_eq!(advice(1.0, 10.0), "");
    }

    #[test]
    fn transforms_come_back_to_the_bit() {
        for unit in [Unit::Millimetre, Unit::Centimetre, Unit::Metre, Unit::Inch] {
            let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
            let own = Mat4::translation(Vec3::new(0.1f32, -7.3, 1e-3).to_f64())
                * Mat4::scale(Vec3::splat(f64::from(0.123_456_7f32)));
            let root = Mat4::scale(Vec3::splat(f64::from(root_scale(Some(unit)).unwrap_or(1.0))));
            scene.edit(|scene| scene.instances[0].world_from_object = root * own).unwrap();
            from_metres(&mut scene, Some(unit)).unwrap();
            assert_eq!(scene.instances()[0].world_from_object, own, "{unit:?}");
        }
    }
}
