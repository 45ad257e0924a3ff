//! Fits vertex normals of a low-poly mesh so that, interpolated, they match its scan's normals as closely as
//! possible: least squares at the corners of triangles and at the vertices of the mesh.

use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::error::Result;
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, MeshData, Point, sample_area};
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
pub fn fit_normals(low: &Mesh, scan: &Scan) -> Result<Mesh> {
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
    let facets = parallel::collect(low.triangles().len(), |t| facet_normal(low.corners(t)));
    let reach = (low.diagonal() * REACH) as f32;
    let sample = |i: usize| {
        let at = point(i);
        let normal = surface.normal(LookupPoint { point: at, width }, at.normal(mesh)).normal;
        let faces = |t: u32| facets[t as usize].is_some_and(|facet| facet.dot(normal) >= LEAST_COSINE);
        let closest = tree.closest_of(at.position(mesh), reach, faces)?;
        scan.is_seen_from_anywhere(at).then(|| Sample { at: closest.point(), normal })
    };
    Ok(parallel::collect(count, sample).into_iter().flatten().collect())
}

/// The weight of the mesh's original normals, relative to the mean weight of the points around a vertex.
const INERTIA: f64 = 0.02;
/// Number of conjugate gradient steps.
const STEPS: usize = 16;
/// The weight, in points, of a triangle's mean normal for its corners.
const FLATNESS: f64 = 0.03;

/// The normal of the scan at a point, and the point of the low-poly mesh that shows it.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at: Point,
    normal: Vec3,
}

impl Sample {
    /// Returns the distance between the sample's normal and the mesh's.
    fn distance(&self, low: &Mesh) -> f64 {
        f64::from((self.at.normal(low) - self.normal).length())
    }
}

/// The samples of a triangle, as its normal equations: Σ b bᵀ x = Σ b n, with the barycentric weights b and the
/// normal n of each.
#[derive(Debug, Clone, Copy, Default)]
struct FacetFit {
    /// Σ b bᵀ: the diagonal, then the products of corners 0 and 1, 1 and 2, 2 and 0.
    squares: [f64; 6],
    /// Σ b n.
    right: [Vec3<f64>; 3],
    count: f64,
}

/// The samples of all triangles.
struct FacetFits(Vec<FacetFit>);

impl FacetFits {
    fn new(low: &Mesh, samples: &[Sample]) -> Self {
        let mut fits = vec![FacetFit::default(); low.triangles().len()];
        for Sample { at, normal } in samples {
            fits[at.triangle as usize].add(at.weights.map(f64::from), normal.to_f64());
        }
        Self(fits)
    }

    /// Returns the unit normals at the corners of each triangle, fitted to its own samples; the mesh's if it has
    /// none.
    fn corner_normals(&self, low: &Mesh) -> Vec<[Vec3; 3]> {
        let own = low.triangles().iter().map(|triangle| triangle.map(|v| low.normals()[v as usize]));
        self.0.iter().zip(own).map(|(fit, own)| fit.corner_normals().unwrap_or(own)).collect()
    }
}

impl FacetFit {
    fn add(&mut self, [u, v, w]: [f64; 3], normal: Vec3<f64>) {
        let products = [u * u, v * v, w * w, u * v, v * w, w * u];
        self.squares.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        self.right.iter_mut().zip([u, v, w]).for_each(|(sum, weight)| *sum += normal * weight);
        self.count += 1.0;
    }

    /// Solves (Σ b bᵀ + λ) x = Σ b n + λ m with the mean normal m, by Cramer's rule.
    fn corner_normals(&self) -> Option<[Vec3; 3]> {
        let weight = FLATNESS * self.count;
        let mean = self.right[0] + self.right[1] + self.right[2];
        let mean = if mean.length() > 0.0 { mean * (1.0 / mean.length()) } else { return None };
        let [r0, r1, r2] = self.right.map(|right| right + mean * weight);
        let [uu, vv, ww, uv, vw, wu] = self.squares;
        let [uu, vv, ww] = [uu, vv, ww].map(|square| square + weight);
        let minors = [vv * ww - vw * vw, wu * vw - uv * ww, uv * vw - wu * vv];
        let [c, d, e] = [uu * ww - wu * wu, uv * wu - uu * vw, uu * vv - uv * uv];
        let determinant = uu * minors[0] + uv * minors[1] + wu * minors[2];
        let solved = [
            r0 * minors[0] + r1 * minors[1] + r2 * minors[2],
            r0 * minors[1] + r1 * c + r2 * d,
            r0 * minors[2] + r1 * d + r2 * e,
        ];
        let unit = |v: Vec3<f64>| (v * (1.0 / determinant)).to_f32().normalize_or(mean.to_f32());
        (determinant > 0.0).then(|| solved.map(unit))
    }
}

/// The normal equations of a fit, (Σ b bᵀ + μ) x = Σ b n + μ x₀, with the barycentric weights b and the normal n of
/// each sample, and the original normals x₀.
struct System<'a> {
    triangles: &'a [[u32; 3]],
    facets: &'a [FacetFit],
    /// Σ b n + μ x₀.
    right: Vec<Vec3<f64>>,
    /// μ.
    inertia: f64,
}

impl<'a> System<'a> {
    fn new(low: &'a Mesh, FacetFits(facets): &'a FacetFits) -> Self {
        let (triangles, start) = (low.triangles(), low.normals());
        let count: f64 = facets.iter().map(|facet| facet.count).sum();
        let inertia = INERTIA * count / start.len().max(1) as f64;
        let mut right: Vec<Vec3<f64>> = start.iter().map(|normal| normal.to_f64() * inertia).collect();
        for (corners, facet) in triangles.iter().zip(facets) {
            corners.iter().zip(facet.right).for_each(|(corner, part)| right[*corner as usize] += part);
        }
        Self { triangles, facets, right, inertia }
    }

    fn product(&self, x: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let mut product: Vec<Vec3<f64>> = x.iter().map(|v| *v * self.inertia).collect();
        for (corners, FacetFit { squares: [uu, vv, ww, uv, vw, wu], .. }) in
            self.triangles.iter().zip(self.facets)
        {
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
        for (corners, facet) in self.triangles.iter().zip(self.facets) {
            corners
                .iter()
                .zip(facet.squares)
                .for_each(|(corner, square)| diagonal[*corner as usize] += square);
        }
        diagonal
    }

    /// Solves by conjugate gradients with the diagonal as preconditioner. Source: Shewchuk 1994, "An introduction to
    /// the conjugate gradient method without the agonizing pain", B3.
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
