//! The places on a scan of all samples of a patch at once.

use super::layout::Patch;
use super::projection::{Match, Probe};
use super::scan::Scan;
use crate::math::Vec3;
use crate::trace::{Hit, Nearest, Ray};

/// Fewer samples are found faster one by one.
const FEW: usize = 6;
/// If directions part so much that a triangle might be met from so many samples beside it, so are they.
const WIDEST: f32 = 12.0;

/// The match of each probe of a patch, as [`Scan::project`] finds it, to the bit.
///
/// Neighbouring samples look in nearly the same direction for triangles of about their own size. So instead of asking
/// for each sample which triangles it meets, each triangle near the patch is asked which samples may meet it: it is seen
/// along the mean direction as a shadow on the map, which is widened by as much as directions differ.
pub(super) fn search(scan: &Scan, patch: &Patch, corners: [Vec3; 3], probes: &[Probe]) -> Vec<Option<Match>> {
    let view = (probes.len() > FEW).then(|| View::new(patch, corners, probes)).flatten();
    match view {
        Some(view) => by_triangle(scan, patch, probes, &view),
        None => probes.iter().map(|probe| scan.project(probe)).collect(),
    }
}

fn by_triangle(scan: &Scan, patch: &Patch, probes: &[Probe], view: &View) -> Vec<Option<Match>> {
    let mut sought: Vec<(Ray, Nearest<Vec3>)> = probes
        .iter()
        .map(|probe| {
            let (ray, stretch) = probe.ray();
            (ray, Nearest::on(stretch))
        })
        .collect();
    let grid = Grid::new(patch);
    scan.bvh().near(view.bounds, |triangle, corners| {
        let Some([[left, right], [top, bottom]]) = view.shadow(corners, grid.size) else { return };
        for y in top..=bottom {
            for i in grid.row(y, left, right) {
                let (ray, nearest) = &mut sought[i];
                if let Some((distance, weights)) = ray.intersect(corners) {
                    let hit = Hit { triangle, weights, distance };
                    nearest.offer(hit, |hit| scan.facing(hit, &probes[i]));
                }
            }
        }
    });
    let found = |(probe, (_, nearest)): (&Probe, (Ray, Nearest<Vec3>))| {
        nearest.best().map(|(hit, normal)| probe.found(&hit, normal))
    };
    probes.iter().zip(sought).map(found).collect()
}

/// Which sample stands where in the tile.
struct Grid {
    size: [usize; 2],
    samples: Vec<u16>,
}

impl Grid {
    const NONE: u16 = u16::MAX;

    fn new(patch: &Patch) -> Self {
        let most = |axis: usize| patch.samples.iter().map(|s| s.at[axis]).max().unwrap_or_default();
        let size = [0, 1].map(|axis| usize::from(most(axis)) + 1);
        let mut samples = vec![Self::NONE; size[0] * size[1]];
        for (i, sample) in patch.samples.iter().enumerate() {
            let [x, y] = sample.at.map(usize::from);
            samples[y * size[0] + x] = i as u16;
        }
        Self { size, samples }
    }

    fn row(&self, y: usize, left: usize, right: usize) -> impl Iterator<Item = usize> + '_ {
        let row = &self.samples[y * self.size[0]..][left..=right];
        row.iter().filter(|i| **i != Self::NONE).map(|i| usize::from(*i))
    }
}

/// A patch seen along its mean direction: a place V is column · x + row · y + depth · d from the tile's corner.
struct View {
    origin: Vec3,
    /// Give column, row and depth of a place.
    column: Vec3,
    row: Vec3,
    depth: Vec3,
    /// How far samples beside a shadow may be and still meet what casts it.
    slack: [f32; 2],
    /// Between which depths probes look.
    depths: [f32; 2],
    /// The box around all probes.
    bounds: [Vec3; 2],
}

impl View {
    /// `None` where the patch is seen edge on, or directions differ too much.
    fn new(patch: &Patch, corners: [Vec3; 3], probes: &[Probe]) -> Option<Self> {
        let [origin, across, down] = patch.weights.map(|weights| super::scan::blend(corners, weights));
        let (across, down) = (across - origin, down - origin);
        let sum = probes.iter().fold(Vec3::default(), |sum, probe| sum + probe.direction);
        let mean = sum.normalize_or(probes[0].direction);
        let det = across.cross(down).dot(mean);
        let scale = 1.0 / det;
        let (column, row) = (down.cross(mean) * scale, mean.cross(across) * scale);
        let depth = across.cross(down) * scale;
        let is_edge_on = !(scale.is_finite() && column.is_finite() && row.is_finite() && depth.is_finite());
        let mut view = Self {
            origin,
            column,
            row,
            depth,
            slack: [0.0; 2],
            depths: [0.0; 2],
            bounds: [Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY)],
        };
        for probe in probes {
            view.take(probe);
        }
        // Rounding of places and of their shadows, generously.
        let rounding = |axis: Vec3| {
            let [low, high] = view.bounds;
            let reach = Vec3::new(
                low.x.abs().max(high.x.abs()),
                low.y.abs().max(high.y.abs()),
                low.z.abs().max(high.z.abs()),
            );
            axis.length() * reach.length() * 2e-6 + 1e-3
        };
        view.slack = [view.slack[0] + rounding(column), view.slack[1] + rounding(row)];
        let deep = rounding(depth);
        view.depths = [view.depths[0] - deep, view.depths[1] + deep];
        (!is_edge_on && view.slack.iter().all(|slack| *slack < WIDEST)).then_some(view)
    }

    /// Makes room for a probe.
    fn take(&mut self, probe: &Probe) {
        for way in [-probe.inward, probe.outward] {
            let aside = [self.column, self.row].map(|axis| (axis.dot(probe.direction) * way).abs());
            self.slack = [self.slack[0].max(aside[0]), self.slack[1].max(aside[1])];
            let depth = self.depth.dot(probe.direction) * way;
            self.depths = [self.depths[0].min(depth), self.depths[1].max(depth)];
            let end = probe.point + probe.direction * way;
            let [low, high] = self.bounds;
            self.bounds = [
                Vec3::new(low.x.min(end.x), low.y.min(end.y), low.z.min(end.z)),
                Vec3::new(high.x.max(end.x), high.y.max(end.y), high.z.max(end.z)),
            ];
        }
    }

    /// First and last column and row of the samples that may meet a triangle.
    fn shadow(&self, corners: [Vec3; 3], size: [usize; 2]) -> Option<[[usize; 2]; 2]> {
        let [a, b, c] = [corners[0] - self.origin, corners[1] - self.origin, corners[2] - self.origin];
        let range = |axis: Vec3| {
            let (p, q, r) = (axis.dot(a), axis.dot(b), axis.dot(c));
            [p.min(q).min(r), p.max(q).max(r)]
        };
        let [low, high] = range(self.depth);
        if low > self.depths[1] || high < self.depths[0] {
            return None;
        }
        let samples = |[low, high]: [f32; 2], slack: f32, size: usize| {
            let (first, last) =
                ((low - slack).ceil().max(0.0), (high + slack).floor().min((size - 1) as f32));
            (first <= last).then_some([first as usize, last as usize])
        };
        let columns = samples(range(self.column), self.slack[0], size[0])?;
        Some([columns, samples(range(self.row), self.slack[1], size[1])?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Cage;
    use crate::bake::layout::Layout;
    use crate::math::Mat4;
    use crate::mesh::{Mesh, MeshData};
    use crate::scene::{Instance, Material, Scene};

    /// A sphere with bumps as fine as its triangles, and a smaller one inside that faces out too.
    fn rough() -> Scan {
        let mut data = MeshData::default();
        for (radius, bumps) in [(1.0, 0.02), (0.9, 0.0)] {
            let sphere = Mesh::sphere(radius, 90, 60).into_data();
            let first = data.positions.len() as u32;
            let bump = |i: usize| 1.0 + bumps * ((i * 7919 % 13) as f32 / 13.0 - 0.5);
            data.positions.extend(sphere.positions.iter().enumerate().map(|(i, p)| *p * bump(i)));
            data.triangles.extend(sphere.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        Scan::new(Scene {
            meshes: vec![Mesh::new(data).unwrap()],
            materials: vec![Material::default()],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..Scene::default()
        })
        .unwrap()
    }

    #[test]
    fn triangles_find_what_samples_would_have_found() {
        let scan = rough();
        for (columns, rows, size) in [(6, 4, 64), (24, 12, 128), (60, 40, 64)] {
            let low = Mesh::sphere(1.0, columns, rows);
            for distance in [0.02, 0.15] {
                let cage = Cage::uniform(&low, distance).unwrap();
                let layout = Layout::new(&low, [size; 2], 2).unwrap();
                let (mut met, mut missed) = (0, 0);
                for band in 0..layout.band_count() {
                    layout.patches(band, |patch| {
                        let corners = low.corners(patch.triangle as usize);
                        let triangle = low.triangles()[patch.triangle as usize];
                        let probe = |weights| {
                            cage.probe(triangle, crate::bake::scan::blend(corners, weights), weights)
                        };
                        let probes: Vec<Probe> = patch.samples.iter().map(|s| probe(s.weights)).collect();
                        let all = search(&scan, patch, corners, &probes);
                        for (probe, found) in probes.iter().zip(all) {
                            assert_eq!(found, scan.project(probe));
                            *(if found.is_some() { &mut met } else { &mut missed }) += 1;
                        }
                    });
                }
                assert!(met > 1000, "{met} met, {missed} missed");
            }
        }
    }
}
