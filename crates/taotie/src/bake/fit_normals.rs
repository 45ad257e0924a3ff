//! Vertex normals of a low-poly mesh that, interpolated, come as near to its scan's as they can.

use super::area_samples::sample_area;
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::error::Result;
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, MeshData, Point};
use crate::parallel;
use crate::surface::facet_normal;
use crate::trace::Bvh;

/// Points of the scan for each triangle of the low-poly mesh, and the least and greatest number of all.
const POINTS_PER_TRIANGLE: usize = 12;
const LEAST_POINTS: usize = 60_000;
const MOST_POINTS: usize = 800_000;
/// Points farther from the low-poly mesh than this part of the diagonal belong to parts that it lacks.
const REACH: f64 = 0.02;
/// The least cosine between the scan's normal and the facet that it is fitted to, that of 75°: facets that are turned
/// farther are the other side of something thin.
const LEAST_COSINE: f32 = 0.26;
/// The weight of the normals that the mesh had, beside the mean weight of the points around a vertex.
const INERTIA: f64 = 0.02;
/// Steps of the conjugate gradients. The largest change of a normal after 16 is below 0.01° on the ten shared scans.
const STEPS: usize = 16;

/// Returns the mesh with the vertex normals whose interpolation has the least square distance from the normals of the scan,
/// bent by its normal maps, over what can be seen of it: each point of the scan looks at the nearest one of the mesh.
/// Vertices that no point is near keep their normals; tangents are dropped. The mesh is returned as it is if its own normals
/// are nearer, as those of a scan that was hardly simplified are at creases.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the scan has no area.
///
/// # Panics
/// If the mesh has no normals.
pub(crate) fn fit_normals(low: &Mesh, scan: &Scan) -> Result<Mesh> {
    let samples = samples(low, scan)?;
    let fitted = System::new(low, &samples).solved(low.normals());
    let fitted = fitted.into_iter().zip(low.normals());
    let normals: Vec<Vec3> = fitted.map(|(normal, own)| normal.to_f32().normalize_or(*own)).collect();
    let distance =
        |normals: &[Vec3]| -> f64 { samples.iter().map(|sample| sample.distance(low, normals)).sum() };
    if distance(&normals) >= distance(low.normals()) {
        return Ok(low.clone());
    }
    Mesh::new(MeshData { normals, tangents: Vec::new(), ..low.clone().into_data() })
}

/// The normal of the scan at a point, and the place of the low-poly mesh that shows it.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at: Point,
    normal: Vec3,
}

impl Sample {
    /// Returns the distance between the sample's normal and the one interpolated between `normals`.
    fn distance(&self, low: &Mesh, normals: &[Vec3]) -> f64 {
        let [a, b, c] = self.at.vertices(low).map(|vertex| normals[vertex]);
        let [u, v, w] = self.at.weights;
        let away = (a * u + b * v + c * w).normalize_or(a) - self.normal;
        f64::from(away.length())
    }
}

/// Returns samples spread evenly over what can be seen of the scan near the low-poly mesh.
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

/// The normal equations of a fit, (Σ b bᵀ + μ) x = Σ b n + μ x₀, with the barycentric weights b and the normal n of each
/// sample, and the normals x₀ before.
struct System<'a> {
    triangles: &'a [[u32; 3]],
    /// Σ b bᵀ of each triangle: the diagonal, then the products of corners 0 and 1, 1 and 2, 2 and 0.
    blocks: Vec<[f64; 6]>,
    /// Σ b n + μ x₀.
    right: Vec<Vec3<f64>>,
    /// μ.
    inertia: f64,
}

impl<'a> System<'a> {
    fn new(low: &'a Mesh, samples: &[Sample]) -> Self {
        let (triangles, start) = (low.triangles(), low.normals());
        let inertia = INERTIA * samples.len() as f64 / start.len().max(1) as f64;
        let mut right: Vec<Vec3<f64>> = start.iter().map(|normal| normal.to_f64() * inertia).collect();
        let mut blocks = vec![[0.0; 6]; triangles.len()];
        for Sample { at, normal } in samples {
            let [u, v, w] = at.weights.map(f64::from);
            for (vertex, weight) in at.vertices(low).into_iter().zip([u, v, w]) {
                right[vertex] += normal.to_f64() * weight;
            }
            let products = [u * u, v * v, w * w, u * v, v * w, w * u];
            let block = &mut blocks[at.triangle as usize];
            block.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
        Self { triangles, blocks, right, inertia }
    }

    fn product(&self, x: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let mut product: Vec<Vec3<f64>> = x.iter().map(|v| *v * self.inertia).collect();
        for (corners, [uu, vv, ww, uv, vw, wu]) in self.triangles.iter().zip(&self.blocks) {
            let [i, j, k] = corners.map(|corner| corner as usize);
            let [a, b, c] = [x[i], x[j], x[k]];
            product[i] += a * *uu + b * *uv + c * *wu;
            product[j] += a * *uv + b * *vv + c * *vw;
            product[k] += a * *wu + b * *vw + c * *ww;
        }
        product
    }

    fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![self.inertia; self.right.len()];
        for (corners, block) in self.triangles.iter().zip(&self.blocks) {
            corners.iter().zip(block).for_each(|(corner, square)| diagonal[*corner as usize] += square);
        }
        diagonal
    }

    /// Solves by conjugate gradients with the diagonal as preconditioner. Source: Shewchuk 1994, "An introduction to the
    /// conjugate gradient method without the agonizing pain", B3.
    fn solved(&self, start: &[Vec3]) -> Vec<Vec3<f64>> {
        let diagonal = self.diagonal();
        let conditioned = |residual: &[Vec3<f64>]| -> Vec<Vec3<f64>> {
            residual.iter().zip(&diagonal).map(|(r, d)| *r * (1.0 / d)).collect()
        };
        let mut x: Vec<Vec3<f64>> = start.iter().map(|normal| normal.to_f64()).collect();
        let mut residual = self.right.clone();
        add(&mut residual, &self.product(&x), -1.0);
        let mut direction = conditioned(&residual);
        let mut size = dot(&residual, &direction);
        for _ in 0..STEPS {
            let product = self.product(&direction);
            let curvature = dot(&direction, &product);
            if curvature <= 0.0 {
                break;
            }
            add(&mut x, &direction, size / curvature);
            add(&mut residual, &product, -size / curvature);
            let mut next = conditioned(&residual);
            let next_size = dot(&residual, &next);
            add(&mut next, &direction, next_size / size);
            (direction, size) = (next, next_size);
        }
        x
    }
}

/// Adds `factor` times `more` to `sum`.
fn add(sum: &mut [Vec3<f64>], more: &[Vec3<f64>], factor: f64) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += *more * factor);
}

fn dot(a: &[Vec3<f64>], b: &[Vec3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Scene};

    fn scan(mesh: &Mesh) -> Scan {
        Scan::new(Scene::of_mesh(mesh.clone(), Material::default()).unwrap()).unwrap()
    }

    /// A ball whose normals are turned by waves that its shape does not have.
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
        let sum: f64 = samples.iter().map(|sample| sample.distance(low, low.normals())).sum();
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

    /// The inside of a shell is not what its outside is fitted to.
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
        let [alone, with_shell] = [&outer, &both].map(|mesh| fit_normals(&low, &scan(mesh)).unwrap());
        let turned = |(a, b): (&Vec3, &Vec3)| f64::from((*a - *b).length());
        let most = alone.normals().iter().zip(with_shell.normals()).map(turned).fold(0.0, f64::max);
        assert!(most < 0.02, "{most}");
    }
}
