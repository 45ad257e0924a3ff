//! Baking: each sample of each texel finds its place on the scan, and the texel takes the mean of what is there.

use super::cage::{Cage, diagonal};
use super::curvature::mean_curvatures;
use super::fill::fill;
use super::layout::{BAND, Layout, Patch};
use super::maps::{MapKind, Maps};
use super::planes::{BandPlanes, Planes, Texel};
use super::projection::{Match, Probe};
use super::scan::{Scan, blend};
use super::sky::Sky;
use crate::error::{Error, Result};
use crate::math::{Vec3, sequence};
use crate::mesh::Mesh;
use crate::scene::NormalSpace;
use crate::shade::Hidden;
use crate::surface::tangent_space_normal;
use crate::trace::Shortlist;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How maps are baked.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeSettings {
    /// Texels across and down, 1 to 32768.
    pub size: [u32; 2],
    /// Samples a texel along each side, 1 to 8: 2 are four a texel.
    pub side: u32,
    /// Which maps.
    pub maps: Maps,
    /// The space of normals and bent normals.
    pub space: NormalSpace,
    /// Rays over the hemisphere a texel, for occlusion and bent normals.
    pub sky_rays: u32,
    /// How far what is in the way of these rays counts, model units; `None` for any distance.
    pub sky_reach: Option<f32>,
    /// The scan's own roughness, what artists set.
    pub roughness: f32,
    /// How many texels around each chart take the value of the nearest one; `None` fills the whole map.
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
            sky_reach: None,
            roughness: 0.6,
            dilation: None,
        }
    }
}

/// What became of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BakeCounts {
    /// Samples on the light mesh.
    pub samples: usize,
    /// Those whose line met nothing that faces the right way, so that the closest point of the scan was taken.
    pub missed: usize,
    /// Those of them whose closest point faces the wrong way too, or is too far away: they have the light mesh's normal.
    pub lost: usize,
    /// Samples under more than one triangle.
    pub shared: usize,
    /// Texels on the light mesh.
    pub texels: usize,
    /// Texels with a sample that missed.
    pub missed_texels: usize,
    /// Triangles of the light mesh whose uvs span no area.
    pub flat: usize,
}

impl BakeCounts {
    fn and(self, o: Self) -> Self {
        Self {
            samples: self.samples + o.samples,
            missed: self.missed + o.missed,
            lost: self.lost + o.lost,
            shared: self.shared + o.shared,
            texels: self.texels + o.texels,
            missed_texels: self.missed_texels + o.missed_texels,
            flat: self.flat + o.flat,
        }
    }
}

/// Baked maps and what became of their samples.
#[derive(Debug, Clone)]
pub struct Baked {
    /// The maps.
    pub planes: Planes,
    /// How it went.
    pub counts: BakeCounts,
}

/// Bakes `scan` onto `low`, which has uvs, normals and tangents, as in [`crate::surface::with_frames`]. `go_on` is told
/// the fraction done, from any thread, and says whether to go on; where it declines, the result is `None`.
///
/// # Errors
/// [`Error::Invalid`] where the mesh lacks uvs, normals or tangents, or a setting is out of range; [`Error::Limit`] where
/// uvs span too many copies of the map.
pub fn bake(
    low: &Mesh,
    cage: &Cage,
    scan: &Scan,
    settings: &BakeSettings,
    go_on: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Option<Baked>> {
    check(low, settings)?;
    let layout = Layout::new(low, settings.size, settings.side)?;
    let wants = |kind| settings.maps.has(kind);
    let job = Job {
        sky: (wants(MapKind::Occlusion) || wants(MapKind::Bent)).then(|| sky(low, settings)),
        curvatures: if wants(MapKind::Curvature) { mean_curvatures(scan.mesh()) } else { Vec::new() },
        reach: cage.longest() * 4.0,
        layout,
        cage,
        scan,
        settings,
    };
    let mut planes = Planes::new(settings.size, settings.maps);
    let (done, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let bands = job.layout.band_count();
    let counts = planes
        .bands(BAND)
        .into_par_iter()
        .enumerate()
        .map(|(band, planes)| {
            if stopped.load(Ordering::Relaxed) {
                return BakeCounts::default();
            }
            let counts = job.band(band, planes);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if !go_on(done as f64 / bands as f64) {
                stopped.store(true, Ordering::Relaxed);
            }
            counts
        })
        .reduce(BakeCounts::default, BakeCounts::and);
    if stopped.into_inner() {
        return Ok(None);
    }
    let counts = BakeCounts { flat: job.layout.flat, ..counts };
    fill(&mut planes, settings.dilation);
    Ok(Some(Baked { planes, counts }))
}

fn check(low: &Mesh, settings: &BakeSettings) -> Result<()> {
    let error = |what: &str, why: &str| Err(Error::invalid(what, why));
    match () {
        () if low.uvs().is_empty() => error("the light mesh", "it has no uvs; unwrap it first"),
        () if low.normals().is_empty() || low.tangents().is_empty() => {
            error("the light mesh", "it has no normals or no tangents; make them first")
        }
        () if !settings.size.iter().all(|s| (1..=32_768).contains(s)) => {
            error("the size of the maps", "1 to 32768 texels")
        }
        () if !(1..=8).contains(&settings.side) => error("samples a texel", "1 to 8 along each side"),
        () => Ok(()),
    }
}

fn sky(low: &Mesh, settings: &BakeSettings) -> Sky {
    let rays = settings.sky_rays.div_ceil(settings.side * settings.side).max(1);
    Sky::new(rays as usize, settings.sky_reach.unwrap_or(f32::INFINITY), diagonal(low))
}

/// All that a band needs.
struct Job<'a> {
    layout: Layout<'a>,
    cage: &'a Cage,
    scan: &'a Scan,
    settings: &'a BakeSettings,
    sky: Option<Sky>,
    /// Of the scan's vertices.
    curvatures: Vec<f32>,
    /// How far away a closest point may be.
    reach: f32,
}

/// Sums over a texel's samples.
#[derive(Clone, Copy, Default)]
struct Cell {
    samples: u32,
    missed: u32,
    lost: u32,
    /// Of the scan.
    normal: Vec3,
    /// The light mesh's frame.
    n: Vec3,
    t: Vec3,
    handedness: f32,
    lift: f32,
    color: Vec3,
    open: f32,
    bent: Vec3,
    curvature: f32,
}

/// A sample's place on the light mesh.
struct Place {
    probe: Probe,
    n: Vec3,
    t: Vec3,
    handedness: f32,
}

impl Job<'_> {
    fn band(&self, band: usize, mut planes: BandPlanes<'_>) -> BakeCounts {
        let mut cells = vec![Cell::default(); planes.texels.len()];
        let mut list = Shortlist::default();
        let shared = self.layout.patches(band, |patch| self.patch(patch, &mut list, &mut cells));
        let mut counts = BakeCounts { shared, ..BakeCounts::default() };
        for (i, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.samples > 0) {
            self.store(i, cell, &mut planes);
            counts.samples += cell.samples as usize;
            counts.missed += cell.missed as usize;
            counts.lost += cell.lost as usize;
            counts.texels += 1;
            counts.missed_texels += usize::from(cell.missed > 0);
        }
        counts
    }

    /// Finds the places of a patch's samples on the scan.
    fn patch(&self, patch: &Patch, list: &mut Shortlist, cells: &mut [Cell]) {
        /// Fewer samples are found faster from the root of the tree than by listing the leaves around them.
        const FEW: usize = 12;
        /// A list longer than this is slower than the tree.
        const LONGEST: usize = 96;
        let places: Vec<Place> = patch.samples.iter().map(|(_, w)| self.place(patch.triangle, *w)).collect();
        let listed = places.len() > FEW && self.scan.bvh().shortlist(around(&places), LONGEST, list);
        let among = listed.then_some(&*list);
        for (i, ((texel, _), place)) in patch.samples.iter().zip(&places).enumerate() {
            let seed = sequence::hash(*texel, i as u32);
            self.sample(place, among, seed, &mut cells[*texel as usize]);
        }
    }

    fn place(&self, triangle: u32, weights: [f32; 3]) -> Place {
        let mesh = self.layout.mesh;
        let corners = mesh.triangles()[triangle as usize];
        let of = |values: &[Vec3]| blend(corners.map(|v| values[v as usize]), weights);
        let tangent = |v: u32| {
            let [x, y, z, _] = mesh.tangents()[v as usize];
            Vec3::new(x, y, z)
        };
        Place {
            probe: self.cage.probe(corners, of(mesh.positions()), weights),
            n: of(mesh.normals()),
            t: blend(corners.map(tangent), weights),
            handedness: mesh.tangents()[corners[0] as usize][3],
        }
    }

    fn sample(&self, place: &Place, among: Option<&Shortlist>, seed: u32, cell: &mut Cell) {
        let probe = &place.probe;
        cell.samples += 1;
        cell.n += place.n;
        cell.t += place.t;
        cell.handedness = place.handedness;
        let found = self.scan.project(probe, among).or_else(|| {
            cell.missed += 1;
            self.scan.closest(probe.point, probe.direction, self.reach)
        });
        match found {
            Some(found) => self.add(&found, seed, cell),
            None => {
                cell.lost += 1;
                cell.normal += place.n.normalize_or(probe.direction);
                cell.open += 1.0;
                cell.bent += probe.direction;
            }
        }
    }

    fn add(&self, found: &Match, seed: u32, cell: &mut Cell) {
        cell.normal += found.normal;
        cell.lift += found.height;
        if self.settings.maps.has(MapKind::Albedo) {
            cell.color += Vec3::from_array(self.scan.color(found.triangle, found.weights));
        }
        if !self.curvatures.is_empty() {
            let corners = self.scan.mesh().triangles()[found.triangle as usize];
            for (v, weight) in corners.into_iter().zip(found.weights) {
                cell.curvature += self.curvatures[v as usize] * weight;
            }
        }
        if let Some(sky) = &self.sky {
            let open = sky.open(self.scan, found.triangle, found.weights, seed);
            cell.open += open.part;
            cell.bent += open.direction;
        }
    }

    /// Writes the means.
    fn store(&self, i: usize, cell: &Cell, planes: &mut BandPlanes<'_>) {
        let share = 1.0 / cell.samples as f32;
        planes.texels[i] = match cell {
            cell if cell.lost > 0 => Texel::Lost,
            cell if cell.missed > 0 => Texel::Closest,
            _ => Texel::Met,
        };
        let set = |plane: &mut [f32], v: f32| plane.get_mut(i).into_iter().for_each(|texel| *texel = v);
        let set3 = |plane: &mut [[f32; 3]], v: Vec3| {
            plane.get_mut(i).into_iter().for_each(|texel| *texel = v.to_array());
        };
        set3(planes.normal, self.turned(cell, cell.normal));
        set3(planes.bent, self.turned(cell, cell.bent));
        set3(planes.albedo, cell.color * share);
        set(planes.lift, cell.lift * share);
        set(planes.occlusion, cell.open * share);
        set(planes.curvature, cell.curvature * share);
        let mean = cell.normal * share;
        let relief = (1.0 - mean.dot(mean)).clamp(0.0, 1.0);
        set(planes.roughness, Hidden { bend: 0.0, relief }.widened(self.settings.roughness));
    }

    /// A direction in the space asked for, unit.
    fn turned(&self, cell: &Cell, v: Vec3) -> Vec3 {
        let n = cell.n.normalize_or(Vec3::new(0.0, 0.0, 1.0));
        let v = v.normalize_or(n);
        match self.settings.space {
            NormalSpace::Object => v,
            NormalSpace::Tangent => {
                let share = 1.0 / f64::from(cell.samples);
                let [n, t] = [cell.n, cell.t].map(|sum| sum.to_f64() * share);
                tangent_space_normal(n, t, f64::from(cell.handedness), v.to_f64()).to_f32()
            }
        }
    }
}

/// The box around the lines of all places.
fn around(places: &[Place]) -> [Vec3; 2] {
    let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    for Place { probe, .. } in places {
        for end in [-probe.inward, probe.outward] {
            let p = probe.point + probe.direction * end;
            low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
            high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
        }
    }
    [low, high]
}
