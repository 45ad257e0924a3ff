//! Baking: each sample of each texel finds its point on the scan, and the texel averages the values there.

use super::appearance::{MaterialSample, under_mode};
use super::cage::Cage;
use super::fill::fill;
use super::layout::{BAND, Layout, TriangleSamples};
use super::maps::{BakeCounts, Baked, BakedMaps, BandMaps, MapKind, Maps, Plane, TexelStatus};
use super::projection::{Correspondence, ProjectionRay, groups, search, search_by};
use super::scan::{BATCH, Open, RayCaster, Scan, SkyPoint};
use super::sky::{Bevel, Seen, Sky};
use super::texel_sums::{MaterialSums, OF_POINTS, PointSums};
use super::texture_lookup::LookupPoint;
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::progress::Progress;
use crate::scene::{AlphaMode, NormalSpace};
use crate::shade::SubPixelVariance;
use crate::surface::{mean_curvatures, tangent_space_normal};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The settings of a bake.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeSettings {
    /// Texels across and down, 1 to 32768.
    pub size: [u32; 2],
    /// Samples per texel along each side, 1 to 8: 2 gives four per texel.
    pub side: u32,
    /// The maps to bake.
    pub maps: Maps,
    /// The space of normals and bent normals.
    pub space: NormalSpace,
    /// Rays over the hemisphere per texel, for occlusion, bent normals and thickness.
    pub sky_rays: u32,
    /// The distance within which surfaces block the rays of occlusion and bent normals, in model units; `None` for any
    /// distance.
    pub sky_distance: Option<f32>,
    /// The perceptual roughness that replaces that of the scan's materials; `None` uses theirs.
    pub roughness: Option<f32>,
    /// The radius of rounded edges, model units; `None` for 1 % of the scan's diagonal.
    pub bevel_radius: Option<f32>,
    /// `true` if rays for occlusion, bent normals, thickness and rounded edges see only the objects of the scan on which
    /// a correspondence may be.
    pub isolated: bool,
    /// The number of texels around each UV island that take the value of the nearest one; `None` fills the whole map.
    pub dilation: Option<u32>,
}

impl Default for BakeSettings {
    /// A tangent-space normal map of 2048² texels, four samples each.
    fn default() -> Self {
        Self {
            size: [2048; 2],
            side: 2,
            maps: Maps::default().with(MapKind::Normal),
            space: NormalSpace::Tangent,
            sky_rays: 64,
            sky_distance: None,
            roughness: None,
            bevel_radius: None,
            isolated: false,
            dilation: None,
        }
    }
}

/// The surfaces of a bake: the low-poly mesh, its cage and the scan.
#[derive(Clone, Copy)]
pub struct BakeInput<'a> {
    /// The low-poly mesh, with uvs, normals and tangents, as in [`crate::surface::with_frames`].
    pub low: &'a Mesh,
    /// The cage from which each of its points is projected onto the scan.
    pub cage: &'a Cage,
    /// The high-poly surface.
    pub scan: &'a Scan,
}

/// Returns the memory in bytes that threads need for bands of maps of this size, with `side` · `side` samples per
/// texel.
pub fn bytes_of_bands(size: [u32; 2], side: u32, maps: Maps) -> u64 {
    let at_once = rayon::current_num_threads().min(size[1].div_ceil(BAND) as usize) as u64;
    let owners = u64::from(side).pow(2) * size_of::<u32>() as u64;
    let materials = if maps.has_any(&OF_MATERIALS) { size_of::<MaterialSums>() as u64 } else { 0 };
    let points = if maps.has_any(&OF_POINTS) { size_of::<PointSums>() as u64 } else { 0 };
    let texel = size_of::<Cell>() as u64 + owners + materials + points;
    (at_once * u64::from(BAND)).saturating_mul(u64::from(size[0]) * texel)
}

/// Bakes the maps of a scan for a low-poly mesh.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Invalid`] if the mesh lacks uvs, normals or tangents, or a setting is out of range;
/// [`Error::Limit`] if uvs span too many copies of the map; those of the scan's device.
pub fn bake(input: BakeInput<'_>, settings: &BakeSettings, progress: Progress<'_>) -> Result<Baked> {
    let BakeInput { low, cage, scan } = input;
    check(low, settings)?;
    let layout = Layout::new(low, &low.uvs()[0], settings.size, settings.side)?;
    let mut maps = BakedMaps::new(settings.size, settings.maps);
    let wants = |kind| settings.maps.has(kind);
    let reads_materials = settings.maps.has_any(&OF_MATERIALS);
    let of_sky = [MapKind::Occlusion, MapKind::Bent, MapKind::Thickness];
    let job = Job {
        sky: settings.maps.has_any(&of_sky).then(|| sky(low, settings)),
        bevel: wants(MapKind::Bevel).then(|| bevel(scan.mesh(), settings)),
        curvatures: if maps.has(Plane::Curvature) { mean_curvatures(scan.mesh()) } else { Vec::new() },
        alpha_modes: if reads_materials { scan.alpha_modes(low, cage) } else { Vec::new() },
        without_hit: scan.surface().first_factors(),
        caster: scan.caster()?,
        layout,
        cage,
        scan,
        settings,
    };
    let counts = job.bands(maps.bands(BAND), progress)?;
    let counts = BakeCounts { flat: job.layout.flat, ..counts };
    fill(&mut maps, settings.dilation);
    Ok(Baked { maps, counts })
}

fn check(low: &Mesh, settings: &BakeSettings) -> Result<()> {
    let error = |what: &str, why: &str| Err(Error::invalid(what, why));
    match () {
        () if low.uvs().is_empty() => error("the low-poly mesh", "it has no uvs; unwrap it first"),
        () if low.normals().is_empty() || low.tangents().is_empty() => {
            error("the low-poly mesh", "it has no normals or no tangents; compute them first")
        }
        () if !settings.size.iter().all(|s| (1..=32_768).contains(s)) => {
            error("the size of the maps", "expected 1 to 32768 texels")
        }
        () if !(1..=8).contains(&settings.side) => error("samples per texel", "use 1 to 8 along each side"),
        () => Ok(()),
    }
}

fn sky(low: &Mesh, settings: &BakeSettings) -> Sky {
    let distance = settings.sky_distance.unwrap_or(f32::INFINITY);
    Sky::new(settings.sky_rays, settings.side * settings.side, distance, low.diagonal())
}

fn bevel(scan: &Mesh, settings: &BakeSettings) -> Bevel {
    Bevel::of_scan(scan, settings.bevel_radius, (settings.sky_rays, settings.side * settings.side))
}

/// The maps read from the scan's materials.
const OF_MATERIALS: [MapKind; 6] = [
    MapKind::Albedo,
    MapKind::Roughness,
    MapKind::MetallicRoughness,
    MapKind::Emission,
    MapKind::Alpha,
    MapKind::OcclusionMap,
];

/// Everything needed to bake a band.
struct Job<'a> {
    layout: Layout<'a>,
    cage: &'a Cage,
    scan: &'a Scan,
    settings: &'a BakeSettings,
    /// The device that casts rays; `None` for the CPU.
    caster: Option<&'a dyn RayCaster>,
    sky: Option<Sky>,
    bevel: Option<Bevel>,
    /// The curvature at the scan's vertices.
    curvatures: Vec<f32>,
    /// The alpha mode with which each triangle of the low-poly mesh is shown; empty if no materials are read.
    alpha_modes: Vec<AlphaMode>,
    /// The material of texels whose samples have no correspondence.
    without_hit: MaterialSample,
}

/// Sums over a texel's samples.
#[derive(Clone, Copy, Default)]
struct Cell {
    samples: u32,
    missed: u32,
    lost: u32,
    /// Sum of the scan's normals.
    normal: Vec3,
    /// Sums of the low-poly mesh's frame.
    n: Vec3,
    t: Vec3,
    handedness: f32,
    heights: f32,
    /// Sums over directions of the hemisphere: all, and open ones.
    looked: f32,
    open: f32,
    bent: Vec3,
    curvature: f32,
    /// Sum of the variances of the scan's normals within the lookup width.
    variance: f32,
    /// Samples within one texel of an edge of the low-poly mesh.
    edges: u32,
}

/// The sums of all texels of a band.
struct Cells {
    surfaces: Vec<Cell>,
    /// Sums of the scan's materials; empty if no map of them is baked.
    materials: Vec<MaterialSums>,
    /// Sums of the scan's points; empty if no map of them is baked.
    points: Vec<PointSums>,
}

impl Cells {
    fn new(texels: usize, maps: Maps) -> Self {
        let of = |kinds: &[MapKind]| if maps.has_any(kinds) { texels } else { 0 };
        Self {
            surfaces: vec![Cell::default(); texels],
            materials: vec![MaterialSums::default(); of(&OF_MATERIALS)],
            points: vec![PointSums::default(); of(&OF_POINTS)],
        }
    }
}

/// Points whose sky is sampled, and their texels.
#[derive(Default)]
struct SkyPoints {
    texels: Vec<u32>,
    points: Vec<SkyPoint>,
}

/// Triangles in tiles whose rays a device casts together.
#[derive(Default)]
struct Batch<'a> {
    triangles: Vec<TriangleSamples>,
    /// The projection rays of all their samples.
    rays: Vec<ProjectionRay<'a>>,
}

/// Adds the open parts of hemispheres to their texels.
fn add_open(texels: &[u32], open: Vec<Open>, cells: &mut [Cell]) {
    for (texel, open) in texels.iter().zip(open) {
        let cell = &mut cells[*texel as usize];
        cell.looked += open.looked;
        cell.open += open.seen;
        cell.bent += open.direction;
    }
}

impl Job<'_> {
    /// Bakes all bands.
    fn bands(&self, bands: Vec<BandMaps<'_>>, progress: Progress<'_>) -> Result<BakeCounts> {
        let done = AtomicUsize::new(0);
        let bands: Vec<Mutex<BandMaps<'_>>> = bands.into_iter().map(Mutex::new).collect();
        let report = || progress.at(done.load(Ordering::Relaxed) as f64 / bands.len() as f64);
        let counts = parallel::try_tasks(bands.len(), &|band| {
            // Each is locked only once.
            let mut maps = bands[band].lock().unwrap_or_else(PoisonError::into_inner);
            let counts = self.band(band, &mut maps, &report)?;
            done.fetch_add(1, Ordering::Relaxed);
            report().map(|()| counts)
        })?;
        Ok(counts.into_iter().fold(BakeCounts::default(), BakeCounts::and))
    }

    /// Bakes a band; `report` fails if the work is cancelled.
    fn band(
        &self,
        band: usize,
        maps: &mut BandMaps<'_>,
        report: &dyn Fn() -> Result<()>,
    ) -> Result<BakeCounts> {
        let mut cells = Cells::new(maps.texels.len(), self.settings.maps);
        let shared = match self.caster {
            None => self.layout.triangle_samples(band, |group| self.add_samples(group, &mut cells)),
            Some(caster) => {
                let (mut batch, mut done) = (Batch::default(), Ok(()));
                let mut add =
                    |batch: Batch<'_>| report().and_then(|()| self.add_batch(caster, batch, &mut cells));
                let shared = self.layout.triangle_samples(band, |group| {
                    if done.is_err() {
                        return;
                    }
                    batch.rays.extend(self.projections(group));
                    batch.triangles.push(group.clone());
                    if batch.rays.len() >= BATCH {
                        done = add(std::mem::take(&mut batch));
                    }
                });
                done.and_then(|()| add(batch))?;
                shared
            }
        };
        let mut counts = BakeCounts { shared, ..BakeCounts::default() };
        for (i, cell) in cells.surfaces.iter().enumerate().filter(|(_, cell)| cell.samples > 0) {
            self.store(i, &cells, maps);
            counts.samples += cell.samples as usize;
            counts.missed += cell.missed as usize;
            counts.lost += cell.lost as usize;
            counts.texels += 1;
            counts.missed_texels += usize::from(cell.missed > 0);
        }
        Ok(counts)
    }

    /// Returns the projection rays of a triangle in a tile.
    fn projections(&self, group: &TriangleSamples) -> impl Iterator<Item = ProjectionRay<'_>> {
        group.samples.iter().map(|sample| self.cage.projection_ray(self.layout.mesh, group.point(sample)))
    }

    /// Adds the scan's values at the samples of a triangle in a tile.
    fn add_samples(&self, group: &TriangleSamples, cells: &mut Cells) {
        let projections: Vec<ProjectionRay<'_>> = self.projections(group).collect();
        let corners = self.layout.mesh.corners(group.triangle as usize);
        let found = search(self.scan, group, corners, &projections);
        let SkyPoints { texels, points } = self.add_found(group, &projections, found, cells);
        if let Some(sky) = self.sky.as_ref().filter(|_| !points.is_empty()) {
            add_open(&texels, sky.open(self.seen(&projections), &points), &mut cells.surfaces);
        }
    }

    /// The same for many triangles, with the rays of projections and occlusion cast by a device.
    fn add_batch(&self, caster: &dyn RayCaster, batch: Batch<'_>, cells: &mut Cells) -> Result<()> {
        let found = search_by(caster, self.scan, &batch.rays)?;
        let (mut done, mut all) = (0, SkyPoints::default());
        for group in &batch.triangles {
            let own = done..done + group.samples.len();
            done = own.end;
            let points = self.add_found(group, &batch.rays[own.clone()], found[own].to_vec(), cells);
            all.texels.extend(points.texels);
            all.points.extend(points.points);
        }
        if let Some(sky) = self.sky.as_ref().filter(|_| !all.points.is_empty()) {
            let open = sky.open_by(caster, &all.points, groups(&batch.rays))?;
            add_open(&all.texels, open, &mut cells.surfaces);
        }
        Ok(())
    }

    /// Returns the surfaces that rays around the correspondences of a triangle's projection rays see. All of them have the
    /// same objects.
    fn seen<'s>(&'s self, projections: &[ProjectionRay<'s>]) -> Seen<'s> {
        let among = projections.first().and_then(|projection| projection.among);
        Seen { scan: self.scan, among: among.filter(|_| self.settings.isolated) }
    }

    /// Adds the scan's values at the correspondences of a triangle's samples. Returns the points whose sky is sampled.
    fn add_found(
        &self,
        group: &TriangleSamples,
        projections: &[ProjectionRay<'_>],
        found: Vec<Option<Correspondence>>,
        cells: &mut Cells,
    ) -> SkyPoints {
        let width = group.spacing(self.layout.mesh.corners(group.triangle as usize));
        let draws_edges = self.settings.maps.has(MapKind::Wireframe);
        let edges = draws_edges.then(|| group.edges(self.layout.side));
        let opens = self.settings.maps.has_any(&[MapKind::Occlusion, MapKind::Bent]);
        let mut sky_points = SkyPoints::default();
        let seen = self.seen(projections);
        for ((sample, projection), found) in group.samples.iter().zip(projections).zip(found) {
            let cell = &mut cells.surfaces[sample.texel as usize];
            let point = group.point(sample);
            self.add_frame(point, cell);
            cell.edges += u32::from(edges.as_ref().is_some_and(|edges| edges.is_near(sample)));
            let Some(found) = self.found((point, projection), found, cell) else { continue };
            self.add(&found, width, cell);
            if let Some(sums) = cells.materials.get_mut(sample.texel as usize) {
                let mode = self.alpha_modes[group.triangle as usize];
                sums.add(self.material(LookupPoint { point: found.point, width }, mode));
            }
            let points = cells.points.get_mut(sample.texel as usize);
            let [x, y] = sample.at.map(|v| u32::from(v) % self.layout.side);
            let class = y * self.layout.side + x;
            let sky_point = self.sky.as_ref().map(|sky| (sky, sky.point(seen, &found, class)));
            if let Some(sums) = points {
                sums.add(self.scan, found.point);
                sums.add_way(found.point.position(self.scan.mesh()) - projection.point);
                if let Some(bevel) = &self.bevel {
                    sums.add_bevel(bevel.normal(seen, &found, class));
                }
                if let Some((sky, sky_point)) = &sky_point
                    && self.settings.maps.has(MapKind::Thickness)
                {
                    sums.add_depth(sky.depth(seen, sky_point));
                }
            }
            if let Some((_, sky_point)) = sky_point.filter(|_| opens) {
                sky_points.texels.push(sample.texel);
                sky_points.points.push(sky_point);
            }
        }
        sky_points
    }

    /// Adds the low-poly mesh's frame at a sample.
    fn add_frame(&self, point: Point, cell: &mut Cell) {
        let frame = point.frame(self.layout.mesh);
        cell.samples += 1;
        cell.n += frame.normal;
        cell.t += frame.tangent;
        cell.handedness = frame.handedness;
    }

    /// Returns the correspondence of a sample: the intersection of its projection ray, else the closest point of the
    /// scan. Without either, the low-poly mesh shows its own normal.
    fn found(
        &self,
        (point, projection): (Point, &ProjectionRay<'_>),
        met: Option<Correspondence>,
        cell: &mut Cell,
    ) -> Option<Correspondence> {
        let found = met.or_else(|| {
            cell.missed += 1;
            self.cage.fallback(self.scan, projection)
        });
        if found.is_none() {
            cell.lost += 1;
            let normal = point.normal(self.layout.mesh);
            cell.normal += normal;
            cell.bent += normal;
        }
        found
    }

    /// Adds the shape of the scan at a correspondence, its relief maps sampled with this lookup width.
    fn add(&self, found: &Correspondence, width: f32, cell: &mut Cell) {
        let mapped = self.scan.mapped_normal(found, width);
        cell.normal += mapped.normal;
        cell.variance += mapped.variance;
        cell.heights += found.height;
        if !self.curvatures.is_empty() {
            let vertices = found.point.vertices(self.scan.mesh());
            for (v, weight) in vertices.into_iter().zip(found.point.weights) {
                cell.curvature += self.curvatures[v] * weight;
            }
        }
    }

    /// Returns the scan's material at a point, its alpha converted to the mode that it is shown with.
    fn material(&self, at: LookupPoint, shown: AlphaMode) -> MaterialSample {
        let sample = self.scan.sample(at);
        let own = self.scan.surface().material(at.point.triangle).alpha;
        MaterialSample { alpha: under_mode(sample.alpha, own, shown), ..sample }
    }

    /// Writes the means.
    fn store(&self, i: usize, cells: &Cells, maps: &mut BandMaps<'_>) {
        let cell = &cells.surfaces[i];
        let share = 1.0 / cell.samples as f32;
        maps.texels[i] = match cell {
            cell if cell.lost > 0 => TexelStatus::Lost,
            cell if cell.missed > 0 => TexelStatus::Closest,
            _ => TexelStatus::Met,
        };
        if maps.has(Plane::Normal) {
            maps.set_vector(Plane::Normal, i, self.turned(cell, cell.normal));
        }
        if maps.has(Plane::Bent) {
            maps.set_vector(Plane::Bent, i, self.turned(cell, cell.bent));
        }
        if maps.has(Plane::WorldNormal) {
            let up = Vec3::new(0.0, 0.0, 1.0);
            maps.set_vector(Plane::WorldNormal, i, cell.normal.normalize_or(cell.n.normalize_or(up)));
        }
        maps.set(Plane::Wireframe, i, cell.edges as f32 * share);
        // Only samples with a correspondence have heights and curvatures.
        let of_found = 1.0 / (cell.samples - cell.lost).max(1) as f32;
        maps.set(Plane::Height, i, cell.heights * of_found);
        maps.set(Plane::Curvature, i, cell.curvature * of_found);
        maps.set(Plane::Occlusion, i, if cell.looked > 0.0 { cell.open / cell.looked } else { 1.0 });
        if let Some(sums) = cells.points.get(i) {
            sums.store(i, maps);
            if maps.has(Plane::Bevel) {
                maps.set_vector(Plane::Bevel, i, self.turned(cell, sums.bevel()));
            }
            if maps.has(Plane::VectorDisplacement) {
                let missing = Vec3::splat(f32::NAN);
                let way = sums.way().map_or(missing, |way| self.in_space(cell, way));
                maps.set_vector(Plane::VectorDisplacement, i, way);
            }
        }
        if let Some(sums) = cells.materials.get(i) {
            self.store_material(i, &sums.mean().unwrap_or(self.without_hit), maps);
        }
        if self.settings.maps.has(MapKind::Roughness) {
            let mean = cell.normal * share;
            let normal_variance = (1.0 - mean.dot(mean) * (1.0 - cell.variance * share)).clamp(0.0, 1.0);
            let own = self.settings.roughness.unwrap_or(maps.number(Plane::Roughness, i));
            let variance = SubPixelVariance { curvature: 0.0f32, normal_variance };
            maps.set(Plane::Roughness, i, variance.widened(own));
        }
    }

    /// Writes the material of a texel.
    fn store_material(&self, i: usize, mean: &MaterialSample, maps: &mut BandMaps<'_>) {
        maps.set_vector(Plane::Albedo, i, mean.color);
        maps.set(Plane::Roughness, i, mean.roughness);
        maps.set(Plane::Metallic, i, mean.metallic);
        maps.set_vector(Plane::Emission, i, mean.emission);
        maps.set(Plane::Alpha, i, mean.alpha);
        // Occlusion found by rays overrides the texture's.
        if !self.settings.maps.has(MapKind::Occlusion) {
            maps.set(Plane::Occlusion, i, mean.occlusion);
        }
    }

    /// Returns a vector in the requested space; in tangent space, along the axes of the low-poly mesh's frame.
    fn in_space(&self, cell: &Cell, v: Vec3) -> Vec3 {
        if self.settings.space == NormalSpace::Object {
            return v;
        }
        let n = cell.n.normalize_or(Vec3::new(0.0, 0.0, 1.0));
        let t = (cell.t - n * n.dot(cell.t)).normalize_or(n.any_perpendicular());
        Vec3::new(v.dot(t), v.dot(n.cross(t)) * cell.handedness, v.dot(n))
    }

    /// Returns a unit direction in the requested space.
    fn turned(&self, cell: &Cell, v: Vec3) -> Vec3 {
        let n = cell.n.normalize_or(Vec3::new(0.0, 0.0, 1.0));
        let v = v.normalize_or(n);
        match self.settings.space {
            NormalSpace::Object => v,
            NormalSpace::Tangent => {
                let share = 1.0 / cell.samples as f32;
                tangent_space_normal(cell.n * share, cell.t * share, cell.handedness, v)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_maps_of_materials_and_points_pay_for_their_sums() {
        let of = |maps: &[MapKind]| Cells::new(64, maps.iter().copied().collect());
        let [bare, full] = [of(&[MapKind::Normal]), of(&[MapKind::Albedo, MapKind::Position])];
        assert_eq!((bare.surfaces.len(), bare.materials.capacity(), bare.points.capacity()), (64, 0, 0));
        assert_eq!((full.surfaces.len(), full.materials.len(), full.points.len()), (64, 64, 64));
        // 12 numbers of vectors, 4 counts, 6 numbers.
        assert_eq!(size_of::<Cell>(), 4 * (12 + 4 + 6));
    }
}
