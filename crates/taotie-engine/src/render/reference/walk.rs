//! Paths from one surface to the next.

use super::super::batch::{BATCH, Batch, Run, get3, set3};
use super::super::draw::Draw;
use super::super::interpolate::Interpolation;
use super::super::surface_point::complete;
use super::super::tree::Footprint;
use super::EnvironmentSampling;
use super::bsdf::{BsdfBatch, BsdfQuery, evaluate, is_grooved};
use super::tracer::{Intersection, Tracer};
use crate::math::Vec3;
use crate::math::integration::{Sequence, hash};
use crate::shade::environment::EnvironmentSample;
use crate::shade::sampling::power_heuristic;
use crate::trace::Ray;

/// The number of surfaces after which paths that carry little light may be terminated by Russian roulette.
const ROULETTE_FROM: u32 = 3;

/// The minimum probability of continuing.
const LEAST_CHANCE: f32 = 0.05;

/// A path of light, traced backwards from the camera.
pub(super) struct Path {
    /// Its pixel in the tile.
    pub pixel: u32,
    /// Its index among the pixel's paths.
    pub index: u32,
    /// The pixel's random numbers.
    pub sequence: Sequence,
    /// The index at which the numbers of its shadow rays start.
    pub shadows: u32,
    pub origin: Vec3,
    /// The direction, unit.
    pub direction: Vec3,
    /// The length of the ray, in model units.
    pub limit: f32,
    /// The density with which its surface sampled the direction; 0 for camera rays.
    pub pdf: f32,
    /// `true` if it left below the facet from which it started.
    pub below: bool,
    /// The fraction of the light it meets that reaches the camera, linear RGB.
    pub throughput: Vec3,
    /// The light found so far, linear RGB.
    pub light: Vec3,
    /// The coverage of the pixel: 1 if the camera saw something.
    pub coverage: f32,
}

/// Scratch memory reused by the paths of a tile.
pub(super) struct PathScratch {
    batch: Box<Batch>,
    bsdf: Box<BsdfBatch>,
    origins: [Vec3; BATCH],
    sky: Vec<EnvironmentSample>,
    intersections: Vec<(u32, Intersection)>,
    /// The paths that continue.
    alive: Vec<u32>,
}

impl PathScratch {
    pub(super) fn new(sources: usize) -> Self {
        Self {
            batch: Batch::new(0),
            bsdf: BsdfBatch::new(sources),
            origins: [Vec3::default(); BATCH],
            sky: Vec::new(),
            intersections: Vec::new(),
            alive: Vec::new(),
        }
    }
}

/// The points where paths meet surfaces of one draw: a batch of them.
struct Stop<'s> {
    /// The number of surfaces that the paths have met before.
    depth: u32,
    draw: &'s Draw<'s>,
    /// The path's index, and where it is.
    intersections: &'s [(u32, Intersection)],
}

impl Stop<'_> {
    /// The path's index and the hit of entry `i` of a batch. Packs read up to the next multiple of eight, where the
    /// last entry is repeated.
    fn entry(&self, i: usize) -> &(u32, Intersection) {
        &self.intersections[i.min(self.intersections.len() - 1)]
    }
}

impl Tracer<'_> {
    /// Follows all paths to their ends.
    pub(super) fn walk(&self, paths: &mut [Path], work: &mut PathScratch) {
        work.alive.clear();
        work.alive.extend(0..paths.len() as u32);
        let mut depth = 0;
        while !work.alive.is_empty() {
            self.cast(depth, paths, work);
            work.alive.clear();
            let intersections = std::mem::take(&mut work.intersections);
            for same_draw in intersections.chunk_by(|(_, a), (_, b)| a.draw == b.draw) {
                let draw = &self.draws.all[same_draw[0].1.draw as usize];
                for intersections in same_draw.chunks(BATCH) {
                    self.meet(&Stop { depth, draw, intersections }, paths, work);
                }
            }
            work.intersections = intersections;
            depth += 1;
        }
    }

    /// Traces the rays of the living paths to the surfaces that they hit, sorted by draw.
    fn cast(&self, depth: u32, paths: &mut [Path], work: &mut PathScratch) {
        work.intersections.clear();
        for index in &work.alive {
            let path = &mut paths[*index as usize];
            let ray = Ray::new(path.origin, path.direction);
            match self.sight.nearest(&ray, path.limit, depth == 0, || path.chance(depth)) {
                // It passed through the surface from which it started.
                Some(intersection) if path.below && !intersection.front => {}
                Some(intersection) => work.intersections.push((*index, intersection)),
                None => self.escape(depth, path),
            }
        }
        work.intersections.sort_by_key(|(_, intersection)| intersection.draw);
    }

    /// Ends a path that hits no surface.
    fn escape(&self, depth: u32, path: &mut Path) {
        if depth == 0
            && let Some(ground) = &self.ground
        {
            let dark = ground.shadow_along(path.origin, path.direction);
            (path.throughput, path.coverage) = (path.throughput * (1.0 - dark), dark);
        }
        let Some(environment) = &self.environment else { return };
        let weight = match self.reference.environment {
            _ if depth == 0 => f32::from(u8::from(environment.visible)),
            EnvironmentSampling::Combined => power_heuristic(path.pdf, environment.pdf(path.direction)),
            EnvironmentSampling::ByLight => 0.0,
            EnvironmentSampling::BySurface => 1.0,
        };
        if weight > 0.0 {
            path.light += path.throughput.mul_elements(environment.radiance(path.direction)) * weight;
        }
        if depth == 0 && weight > 0.0 {
            path.coverage = 1.0;
        }
    }

    /// Gathers light at the hits of one draw, and continues the paths.
    fn meet(&self, stop: &Stop<'_>, paths: &mut [Path], work: &mut PathScratch) {
        if self.is_last(stop) && !stop.draw.shines() {
            return;
        }
        self.weigh_transmission(stop, paths);
        self.gather(stop, paths, work);
        self.complete(stop, paths, work);
        if stop.depth == 0 {
            stop.intersections.iter().for_each(|(index, _)| paths[*index as usize].coverage = 1.0);
        }
        if stop.draw.material.unlit {
            show_color(stop, paths, work);
        } else {
            self.light(stop, paths, work);
        }
    }

    /// Weights the paths that met a transmitting surface, which is rarer than its reflection is strong.
    fn weigh_transmission(&self, stop: &Stop<'_>, paths: &mut [Path]) {
        if !stop.draw.material.transmits() {
            return;
        }
        for (index, intersection) in stop.intersections {
            let place = Footprint::at(stop.draw, intersection.triangle, intersection.weights);
            let path = &mut paths[*index as usize];
            path.throughput = path.throughput * (1.0 / (1.0 - place.passed(self.draws.scene, stop.draw)));
        }
    }

    /// Returns true if only the light emitted by the surface counts.
    fn is_last(&self, stop: &Stop<'_>) -> bool {
        stop.depth > self.reference.bounces
    }

    /// Adds the light that surfaces emit and reflect, and continues the paths.
    fn light(&self, stop: &Stop<'_>, paths: &mut [Path], work: &mut PathScratch) {
        let last = self.is_last(stop);
        if !last {
            self.choose(stop, paths, work);
        }
        let query = BsdfQuery {
            depth: stop.depth,
            shading: self.settings.shading,
            material: stop.draw.material,
            sources: if last { &[] } else { &self.sources },
            ambient: if last { Vec3::default() } else { self.ambient },
            shadows: self.settings.shadows,
            sky: !last && !work.sky.is_empty(),
            onward: !last && self.goes_on(stop.depth),
            grooved: is_grooved(&self.reference, stop.draw),
        };
        evaluate(self.level, &query, &work.batch, &mut work.bsdf);
        for (i, (index, _)) in stop.intersections.iter().enumerate() {
            let path = &mut paths[*index as usize];
            self.gain(&query, i, path, work);
            if query.onward && self.send_on(stop.depth, i, path, work) {
                work.alive.push(*index);
            }
        }
    }

    /// Returns true if there may be light beyond the surface.
    fn goes_on(&self, depth: u32) -> bool {
        depth < self.reference.bounces || self.environment.is_some() || self.emitters
    }

    /// Fills the batch, and the origins of rays.
    fn gather(&self, stop: &Stop<'_>, paths: &[Path], work: &mut PathScratch) {
        let interpolation = Interpolation {
            level: self.level,
            scene: self.draws.scene,
            draw: stop.draw,
            specular_aa: false,
            takes_roughness: true,
        };
        let batch = &mut work.batch;
        batch.len = stop.intersections.len();
        batch.both_sides = stop.depth > 0;
        batch.points.runs.clear();
        for (i, (index, intersection)) in stop.intersections.iter().enumerate() {
            batch.points.runs.push(Run { triangle: intersection.triangle, start: i, end: i + 1 });
            set3(&mut batch.points.weights, i, Vec3::from_array(intersection.weights));
            set3(&mut batch.geometry.v, i, -paths[*index as usize].direction);
        }
        let eye = (stop.depth == 0).then_some(self.view.eye);
        interpolation.fill(eye, batch);
        work.origins = interpolation.origins(self.ray_offset, batch);
    }

    /// Fills the values of the batch that are not interpolated.
    fn complete(&self, stop: &Stop<'_>, paths: &[Path], work: &mut PathScratch) {
        if !is_grooved(&self.reference, stop.draw) {
            complete(self.level, &self.settings, stop.draw, &mut work.batch);
            return;
        }
        for i in work.batch.entries() {
            let path = &paths[stop.entry(i).0 as usize];
            work.bsdf.grooves.u[i] = path.at_surface(stop.depth)[3];
        }
        work.bsdf.grooves.complete(self.level, &self.settings, stop.draw, &mut work.batch);
    }

    /// Samples numbers and directions to the environment.
    fn choose(&self, stop: &Stop<'_>, paths: &[Path], work: &mut PathScratch) {
        work.sky.clear();
        let environment =
            self.environment.filter(|_| self.reference.environment != EnvironmentSampling::BySurface);
        for (i, (index, _)) in stop.intersections.iter().enumerate() {
            let path = &paths[*index as usize];
            let [u, around, a, b] = path.of_light(stop.depth);
            (work.bsdf.u[0][i], work.bsdf.u[1][i]) = (u, around);
            if let Some(environment) = environment {
                let sample = environment.sample([a, b]);
                set3(&mut work.bsdf.to_sky, i, sample.direction);
                work.sky.push(sample);
            }
        }
    }

    /// Adds the light that entry `i` emits and reflects from lights and environment.
    fn gain(&self, query: &BsdfQuery<'_>, i: usize, path: &mut Path, work: &PathScratch) {
        let origin = work.origins[i];
        let mut light = get3(&work.bsdf.own, i);
        for (number, (source, lit)) in query.sources.iter().zip(&work.bsdf.lit).enumerate() {
            let reflected = get3(lit, i);
            if reflected == Vec3::default() {
                continue;
            }
            let ray = Ray::new(origin, source.ray_from(origin));
            let chance = path.shadow(query.depth, 1 + number as u32);
            if !self.settings.shadows || self.sight.is_free(&ray, source.ray_limit(), chance) {
                light += reflected;
            }
        }
        if query.sky {
            light += self.sky_light(query.depth, i, path, work);
        }
        path.light += path.throughput.mul_elements(light);
    }

    fn sky_light(&self, depth: u32, i: usize, path: &Path, work: &PathScratch) -> Vec3 {
        let sample = &work.sky[i];
        let reflected = get3(&work.bsdf.from_sky, i).mul_elements(sample.radiance);
        let ray = Ray::new(work.origins[i], sample.direction);
        if reflected == Vec3::default() || !self.sight.is_free(&ray, f32::INFINITY, path.shadow(depth, 0)) {
            return Vec3::default();
        }
        let weight = match self.reference.environment {
            EnvironmentSampling::Combined => power_heuristic(sample.pdf, work.bsdf.sky_pdf[i]),
            _ => 1.0,
        };
        reflected * (weight / sample.pdf)
    }

    /// Redirects the path of entry `i`; returns true if it continues.
    fn send_on(&self, depth: u32, i: usize, path: &mut Path, work: &PathScratch) -> bool {
        let pdf = work.bsdf.onward_pdf[i];
        let reflected = get3(&work.bsdf.from_onward, i);
        if pdf <= 0.0 || reflected == Vec3::default() {
            return false;
        }
        path.throughput = path.throughput.mul_elements(reflected) * (1.0 / pdf);
        if depth >= ROULETTE_FROM {
            let most = path.throughput.x.max(path.throughput.y).max(path.throughput.z);
            let survives = most.clamp(LEAST_CHANCE, 1.0);
            let [u, ..] = path.at_surface(depth);
            if u >= survives {
                return false;
            }
            path.throughput = path.throughput * (1.0 / survives);
        }
        path.origin = work.origins[i];
        path.direction = get3(&work.bsdf.onward, i);
        path.limit = f32::INFINITY;
        path.pdf = pdf;
        path.below = get3(&work.batch.geometry.n_geom, i).dot(path.direction) < 0.0;
        true
    }
}

/// Adds the light that unlit surfaces emit.
fn show_color(stop: &Stop<'_>, paths: &mut [Path], work: &PathScratch) {
    let [r, g, b, _] = stop.draw.material.base_color;
    for (i, (index, _)) in stop.intersections.iter().enumerate() {
        let path = &mut paths[*index as usize];
        let color = get3(&work.batch.material.tint, i).mul_elements(Vec3::new(r, g, b));
        path.light += path.throughput.mul_elements(color);
    }
}

impl Path {
    /// Numbers of the path's way to surface `depth`: whether it continues from there (at first, its position in the
    /// pixel), another number for that position, which blended surfaces exist for the ray that leads to it, and which
    /// facet of a groove it hits.
    fn at_surface(&self, depth: u32) -> [f32; 4] {
        self.sequence.four(self.index, 2 * depth)
    }

    /// Numbers of the light at surface `depth`: two for the direction in which the path continues, two for the
    /// environment.
    fn of_light(&self, depth: u32) -> [f32; 4] {
        self.sequence.four(self.index, 2 * depth + 1)
    }

    /// Decides which blended surfaces exist for the ray that leads to surface `depth`.
    fn chance(&self, depth: u32) -> f32 {
        self.at_surface(depth)[2]
    }

    /// The index of the numbers of one of the shadow rays from surface `depth`.
    fn shadow(&self, depth: u32, ray: u32) -> u32 {
        hash(hash(self.shadows, depth), ray)
    }
}
