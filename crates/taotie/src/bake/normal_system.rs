//! Least squares for normals at the corners of triangles and at the vertices of a mesh.

use crate::math::Vec3;
use crate::mesh::{Mesh, Point};

/// The weight of the mesh's original normals, relative to the mean weight of the points around a vertex.
const INERTIA: f64 = 0.02;
/// Number of conjugate gradient steps.
const STEPS: usize = 16;
/// The weight, in points, of a triangle's mean normal for its corners.
const FLATNESS: f64 = 0.03;

/// The normal of the scan at a point, and the point of the low-poly mesh that shows it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub at: Point,
    pub normal: Vec3,
}

impl Sample {
    /// Returns the distance between the sample's normal and the mesh's.
    pub fn distance(&self, low: &Mesh) -> f64 {
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
pub(super) struct FacetFits(Vec<FacetFit>);

impl FacetFits {
    pub fn new(low: &Mesh, samples: &[Sample]) -> Self {
        let mut fits = vec![FacetFit::default(); low.triangles().len()];
        for Sample { at, normal } in samples {
            fits[at.triangle as usize].add(at.weights.map(f64::from), normal.to_f64());
        }
        Self(fits)
    }

    /// Returns the unit normals at the corners of each triangle, fitted to its own samples; the mesh's if it has
    /// none.
    pub fn corner_normals(&self, low: &Mesh) -> Vec<[Vec3; 3]> {
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
pub(super) struct System<'a> {
    triangles: &'a [[u32; 3]],
    facets: &'a [FacetFit],
    /// Σ b n + μ x₀.
    right: Vec<Vec3<f64>>,
    /// μ.
    inertia: f64,
}

impl<'a> System<'a> {
    pub fn new(low: &'a Mesh, FacetFits(facets): &'a FacetFits) -> Self {
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
    pub fn solved(&self, start: &[Vec3]) -> Vec<Vec3<f64>> {
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
