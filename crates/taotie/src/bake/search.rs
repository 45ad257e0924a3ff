//! Finds the points of a scan that correspond to all samples of a triangle in a tile, in one pass.

use super::layout::{Sample, TriangleSamples};
use super::projection::{Correspondence, ProjectionRay};
use super::scan::Scan;
use crate::math::Vec3;
use crate::mesh::blend;
use crate::trace::{Nearest, PacketView, Ray, RayPacket};

/// Up to this number, samples are faster to find one by one.
const FEW: usize = 6;

/// Directions that diverge more than this from the triangle's own do not form a packet: each ray would pass many
/// others.
const LEAST_COSINE: f32 = 0.9;

/// Returns the correspondence of each projection ray of a triangle in a tile, as [`Scan::project`] finds it.
///
/// Neighbouring samples look in nearly the same direction, so their projections form a packet: columns and rows are
/// those of the tile, and depths run along the mean direction.
pub(super) fn search(
    scan: &Scan,
    group: &TriangleSamples,
    corners: [Vec3; 3],
    projections: &[ProjectionRay],
) -> Vec<Option<Correspondence>> {
    let one_by_one = || projections.iter().map(|projection| scan.project(projection)).collect();
    if projections.len() <= FEW {
        return one_by_one();
    }
    let Some(view) = view(group, corners, projections) else { return one_by_one() };
    let (rays, mut nearest): (Vec<Ray>, Vec<Nearest<Vec3>>) = projections
        .iter()
        .map(|projection| {
            let (ray, interval) = projection.ray();
            (ray, Nearest::on(interval))
        })
        .unzip();
    let middle = middle(group).at.map(f32::from);
    let place = |sample: &Sample| [0, 1].map(|axis| f32::from(sample.at[axis]) - middle[axis]);
    let places: Vec<[f32; 2]> = group.samples.iter().map(place).collect();
    let Some(mut packet) = RayPacket::new(&rays, &places, view) else { return one_by_one() };
    scan.bvh().meet_all(&mut packet, |i, hit| {
        nearest[i].offer(hit, |hit| scan.facing(hit, &projections[i]));
        true
    });
    let found = |(projection, nearest): (&ProjectionRay, Nearest<Vec3>)| scan.visible_of(projection, nearest);
    projections.iter().zip(nearest).map(found).collect()
}

/// Returns the sample at which columns and rows are zero: near all others, so that coordinates have small rounding
/// errors.
fn middle(group: &TriangleSamples) -> &Sample {
    &group.samples[group.samples.len() / 2]
}

/// Returns the view of a ray packet along the projection rays of a triangle; `None` if it is seen edge-on.
///
/// A sample at column x and row y looks along origin + x · across + y · down + depth · direction.
fn view(group: &TriangleSamples, corners: [Vec3; 3], projections: &[ProjectionRay]) -> Option<PacketView> {
    let [corner, across, down] = group.weights.map(|weights| blend(corners, weights));
    let (across, down) = (across - corner, down - corner);
    let origin = blend(corners, middle(group).weights);
    let sum = projections.iter().fold(Vec3::default(), |sum, projection| sum + projection.direction);
    let mean = sum.normalize_or(projections[0].direction);
    let scale = 1.0 / across.cross(down).dot(mean);
    let axes = [down.cross(mean) * scale, mean.cross(across) * scale, across.cross(down) * scale];
    let parts =
        |projection: &ProjectionRay| projection.direction.dot(axes[2].normalize_or(mean)) < LEAST_COSINE;
    if !axes.iter().all(|axis| axis.is_finite()) || projections.iter().any(parts) {
        return None;
    }
    let mut slack = [0.0f32; 2];
    let mut depths = [f32::INFINITY, f32::NEG_INFINITY];
    let mut farthest = 0.0f32;
    for projection in projections {
        for way in [-projection.distance, projection.distance] {
            let end = projection.point + projection.direction * way;
            farthest = farthest.max((end - origin).length()).max(end.length());
            for k in 0..2 {
                slack[k] = slack[k].max((axes[k].dot(projection.direction) * way).abs());
            }
            let depth = axes[2].dot(end - origin);
            depths = [depths[0].min(depth), depths[1].max(depth)];
        }
    }
    // A generous bound on the rounding of positions and of their projections.
    let rounding = axes.map(|axis| axis.length() * farthest * 2e-6);
    Some(PacketView {
        origin,
        axes,
        slack: [slack[0] + rounding[0] + 1e-3, slack[1] + rounding[1] + 1e-3],
        depths: [depths[0] - rounding[2], depths[1] + rounding[2]],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Cage;
    use crate::bake::layout::Layout;
    use crate::math::Mat4;
    use crate::mesh::{Mesh, MeshData, Point};
    use crate::scene::{Instance, Material, Scene, SceneData};

    /// Returns a sphere with bumps as fine as its triangles, and a smaller one inside that also faces outward.
    fn rough() -> Scan {
        let mut data = MeshData::default();
        for (radius, bumps) in [(1.0, 0.02), (0.9, 0.0)] {
            let sphere = Mesh::sphere(radius, 90, 60).into_data();
            let first = data.positions.len() as u32;
            let bump = |i: usize| 1.0 + bumps * ((i * 7919 % 13) as f32 / 13.0 - 0.5);
            data.positions.extend(sphere.positions.iter().enumerate().map(|(i, p)| *p * bump(i)));
            data.triangles.extend(sphere.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        let data = SceneData {
            meshes: vec![Mesh::new(data).unwrap()],
            materials: vec![Material::default()],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        };
        Scan::new(Scene::new(data).unwrap()).unwrap()
    }

    #[test]
    fn triangles_find_what_samples_would_have_found() {
        let scan = rough();
        for (columns, rows, size) in [(6, 4, 64), (24, 12, 128), (60, 40, 64)] {
            let low = Mesh::sphere(1.0, columns, rows);
            for distance in [0.02, 0.15] {
                let cage = Cage::uniform(&low, distance).unwrap();
                let layout = Layout::new(&low, &low.uvs()[0], [size; 2], 2).unwrap();
                let (mut met, mut missed) = (0, 0);
                for band in 0..layout.band_count() {
                    layout.triangle_samples(band, |group| {
                        let corners = low.corners(group.triangle as usize);
                        let projection =
                            |weights| cage.projection_ray(&low, Point { triangle: group.triangle, weights });
                        let projections: Vec<ProjectionRay> =
                            group.samples.iter().map(|s| projection(s.weights)).collect();
                        let all = search(&scan, group, corners, &projections);
                        for (projection, found) in projections.iter().zip(all) {
                            let single = scan.project(projection);
                            // Rays of a packet are intersected in the packet's coordinates, which round differently.
                            let apart = match (single, found) {
                                (Some(a), Some(b)) => (a.height - b.height).abs(),
                                (None, None) => 0.0,
                                _ => f32::INFINITY,
                            };
                            let at_end = |m: Option<Correspondence>| {
                                m.is_some_and(|m| m.height.abs() > distance * 0.9999)
                            };
                            assert!(apart < 1e-5 || at_end(single) || at_end(found), "{single:?} {found:?}");
                            *(if found.is_some() { &mut met } else { &mut missed }) += 1;
                        }
                    });
                }
                assert!(met > 1000, "{met} met, {missed} missed");
            }
        }
    }
}
