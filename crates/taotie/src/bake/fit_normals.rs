//! Fits vertex normals of a low-poly mesh so that, interpolated, they match its scan's normals as closely as
//! possible.

use super::area_samples::sample_area;
use super::normal_system::{FacetFits, Sample, System};
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::error::Result;
use crate::math::Mat4;
use crate::mesh::{Mesh, MeshData};
use crate::parallel;
use crate::surface::{facet_normal, parted};
use crate::trace::Bvh;

/// Points of the scan for each triangle of the low-poly mesh, and the minimum and maximum total.
const POINTS_PER_TRIANGLE: usize = 12;
const LEAST_POINTS: usize = 60_000;
const MOST_POINTS: usize = 800_000;
/// Points farther from the low-poly mesh than this fraction of the diagonal belong to parts missing from it.
const REACH: f64 = 0.02;
/// The minimum cosine between the scan's normal and the facet it is fitted to, that of 75°: facets turned farther
/// belong to the other side of something thin.
const LEAST_COSINE: f32 = 0.26;

/// Returns the mesh with the vertex normals whose interpolation has the least squared distance to the normals of the
/// scan, bent by its normal maps, over its visible parts: each point of the scan is matched to the nearest one of the
/// mesh. Vertices are split if the scan's normals diverge at an edge. Vertices with no point nearby keep their
/// normals; tangents are dropped. The mesh is returned unchanged if its own normals are closer, as happens at creases
/// of a scan that was hardly simplified.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the scan has no area.
///
/// # Panics
/// If the mesh has no normals.
pub(crate) fn fit_normals(low: &Mesh, scan: &Scan) -> Result<Mesh> {
    let samples = samples(low, scan)?;
    let facets = FacetFits::new(low, &samples);
    let parted = parted(low, &facets.corner_normals(low))?;
    let fitted = System::new(&parted, &facets).solved(parted.normals()).into_iter().zip(parted.normals());
    let normals = fitted.map(|(normal, own)| normal.to_f32().normalize_or(*own)).collect();
    let fitted = Mesh::new(MeshData { normals, ..parted.into_data() })?;
    let distance = |mesh: &Mesh| -> f64 { samples.iter().map(|sample| sample.distance(mesh)).sum() };
    Ok(if distance(&fitted) < distance(low) { fitted } else { low.clone() })
}

/// Returns samples spread evenly over the visible parts of the scan near the low-poly mesh.
fn samples(low: &Mesh, scan: &Scan) -> Result<Vec<Sample>> {
    let count = (low.triangles().len() * POINTS_PER_TRIANGLE).clamp(LEAST_POINTS, MOST_POINTS);
    let (surface, mesh) = (scan.surface(), scan.mesh());
    let point = sample_area(mesh, count)?;
    let width = (mesh.area(&Mat4::IDENTITY) / count as f64).sqrt() as f32;
    let tree = Bvh::of(low.triangles().len(), |t| low.corners(t));
    let reach = (low.diagonal() * REACH) as f32;
    let sample = |i: usize| {
        let at = point(i);
        let normal = surface.normal(LookupPoint { point: at, width }, at.normal(mesh)).normal;
        let faces = |t: u32| {
            facet_normal(low.corners(t as usize)).is_some_and(|facet| facet.dot(normal) >= LEAST_COSINE)
        };
        let closest = tree.closest_of(at.position(mesh), reach, faces)?;
        scan.is_seen_from_anywhere(at).then(|| Sample { at: closest.point(), normal })
    };
    Ok(parallel::collect(count, sample).into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::scene::{Material, Scene};

    fn scan(mesh: &Mesh) -> Scan {
        Scan::new(Scene::of_mesh(mesh.clone(), Material::default()).unwrap()).unwrap()
    }

    /// A ball whose normals are perturbed by waves that its shape does not have.
    fn wavy_normals(columns: usize, rows: usize) -> Mesh {
        let ball = Mesh::sphere(1.0, columns, rows);
        let turned = |p: &Vec3| {
            (*p + Vec3::new(0.2 * crate::math::scalar::sin(4.0 * f64::from(p.y)) as f32, 0.0, 0.1 * p.x))
                .normalize()
        };
        let normals = ball.positions().iter().map(turned).collect();
        Mesh::new(MeshData { normals, ..ball.into_data() }).unwrap()
    }

    fn mean_distance(low: &Mesh, scan: &Scan) -> f64 {
        let samples = samples(low, scan).unwrap();
        let sum: f64 = samples.iter().map(|sample| sample.distance(low)).sum();
        sum / samples.len() as f64
    }

    #[test]
    fn a_fit_is_nearer_than_the_scans_normals_at_the_vertices() {
        let (fine, coarse) = (scan(&wavy_normals(256, 128)), wavy_normals(24, 12));
        let shape_alone = Mesh::sphere(1.0, 24, 12);
        let fitted = fit_normals(&shape_alone, &fine).unwrap();
        let [own, at_vertices, fit] = [&shape_alone, &coarse, &fitted].map(|low| mean_distance(low, &fine));
        assert!(fit < 0.75 * at_vertices && at_vertices < 0.3 * own, "{own} {at_vertices} {fit}");
        assert_eq!(fitted.positions(), shape_alone.positions());
    }

    #[test]
    fn normals_that_are_those_of_the_scan_stay() {
        let mesh = wavy_normals(64, 32);
        assert_eq!(fit_normals(&mesh, &scan(&mesh)).unwrap().normals(), mesh.normals());
    }

    #[test]
    fn hard_edges_of_the_scan_stay_hard() {
        // A box of many triangles, whose faces do not share vertices.
        let face = |axis: usize, side: f32| {
            let at = |i: usize, j: usize| {
                let [u, v] = [i, j].map(|k| k as f32 / 8.0 - 0.5);
                let mut p = [u * side, v, 0.0];
                p[2] = 0.5 * side;
                p.rotate_right(axis);
                Vec3::from_array(p)
            };
            let square =
                move |i: usize| [[i, i + 1, i + 10], [i, i + 10, i + 9]].map(|t| t.map(|v| v as u32));
            let positions: Vec<Vec3> = (0..81).map(|i| at(i % 9, i / 9)).collect();
            let triangles: Vec<[u32; 3]> = (0..64).flat_map(|i| square(i / 8 * 9 + i % 8)).collect();
            (positions, triangles)
        };
        let mut data = MeshData::default();
        for (axis, side) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let first = data.positions.len() as u32;
            let (positions, triangles) = face(axis, side);
            data.positions.extend(positions);
            data.triangles.extend(triangles.into_iter().map(|t| t.map(|v| v + first)));
        }
        data.normals = vec![Vec3::splat(0.0); data.positions.len()];
        for triangle in &data.triangles {
            let facet = {
                let [a, b, c] = triangle.map(|v| data.positions[v as usize]);
                (b - a).cross(c - a).normalize()
            };
            triangle.iter().for_each(|v| data.normals[*v as usize] = facet);
        }
        let high = scan(&Mesh::new(data.clone()).unwrap());
        // The low-poly mesh has one vertex per corner of the box.
        let corner =
            |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - Vec3::splat(0.5);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        let low = MeshData { positions: (0..8).map(corner).collect(), triangles, ..MeshData::default() };
        let low = crate::surface::with_normals(&Mesh::new(low).unwrap()).unwrap().into_owned();
        let fitted = fit_normals(&low, &high).unwrap();
        assert_eq!(fitted.positions().len(), 24);
        assert!(mean_distance(&fitted, &high) < 1e-3, "{}", mean_distance(&fitted, &high));
    }

    /// The outside of a shell is not fitted to its inside.
    #[test]
    fn hidden_surfaces_do_not_count() {
        let outer = wavy_normals(96, 48);
        let inner = Mesh::sphere(0.995, 96, 48);
        let both = {
            let (mut data, more) = (outer.clone().into_data(), inner.into_data());
            let first = data.positions.len() as u32;
            data.positions.extend(more.positions);
            data.normals.extend(more.normals);
            data.triangles.extend(more.triangles.iter().map(|t| t.map(|v| v + first)));
            data.uvs.clear();
            data.tangents.clear();
            Mesh::new(data).unwrap()
        };
        let low = Mesh::sphere(1.0, 24, 12);
        let [single, with_shell] = [&outer, &both].map(|mesh| fit_normals(&low, &scan(mesh)).unwrap());
        let turned = |(a, b): (&Vec3, &Vec3)| f64::from((*a - *b).length());
        let most = single.normals().iter().zip(with_shell.normals()).map(turned).fold(0.0, f64::max);
        assert!(most < 0.02, "{most}");
    }
}
