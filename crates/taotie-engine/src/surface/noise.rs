//! Scanner noise: how far the vertices of a scan deviate at random from the surface around them, and its removal.
//!
//! Noise is what differs independently from vertex to vertex; relief is what neighbours have in common. A *patch* is a
//! vertex and all others within two edges of it. A polynomial surface is fitted to each, and its residuals are noise,
//! relief finer than the patch, or a crease. Noise is everywhere and the others are not, so the calmest patches measure
//! it. Its removal averages the fits of all patches around a vertex that noise explains.
//!
//! Noise that a scanner's software has smoothed over several edges looks like relief, and is neither measured nor
//! removed.

use super::normals::{angle, unit, vertex_normals};
use super::weld::{self, Classes};
use crate::error::{Error, Result};
use crate::groups::Groups;
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, MeshData};
use crate::names::Named;
use crate::parallel;
use crate::progress::Progress;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How the noise of a scan is handled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NoiseHandling {
    /// It is measured, and stays in the scan.
    Keep,
    /// It is measured, and removed before anything is made from the scan.
    Remove,
}

impl Named for NoiseHandling {
    const WHAT: &'static str = "handling of noise";
    const NAMES: &'static [(&'static str, Self)] = &[("keep", Self::Keep), ("remove", Self::Remove)];
}

/// The noise of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Noise {
    /// The standard deviation of vertices along the normals, model units.
    pub sigma: f64,
    /// The shortest wavelength that the vertices can represent, model units: twice the median edge. Noise has all
    /// wavelengths from it upwards; relief of twice this wavelength and three times `sigma` survives removal.
    pub scale: f64,
    /// The change by the removal; `None` if the noise was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed: Option<NoiseChange>,
}

/// The difference between a mesh and the same without noise.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct NoiseChange {
    /// The root mean square of the vertices' displacements, model units.
    pub rms: f64,
    /// The mean angle between their normals before and after, degrees.
    pub mean_deg: f64,
    /// The 95th percentile of that angle, degrees.
    pub p95_deg: f64,
}

/// A mesh without its noise.
#[derive(Debug, Clone)]
pub struct Denoised {
    /// The same vertices and triangles; only positions, normals and tangents differ.
    pub mesh: Mesh,
    /// The difference.
    pub change: NoiseChange,
    /// The angle between the normals of each vertex before and after, degrees.
    pub angles: Vec<f32>,
}

/// The maximum number of vertices of a patch: at poles of many triangles there is none.
const MOST: usize = 64;
/// The number of coefficients of a cubic polynomial, with which noise is measured.
const CUBIC: usize = 10;
/// The number of coefficients of a quadratic polynomial, with which it is removed.
const QUADRATIC: usize = 6;
/// The number of vertices a thread takes at a time.
const BLOCK: usize = 4096;

impl Noise {
    /// Measures the noise at up to 16,384 vertices, evenly distributed over the mesh's order. `None` if fewer than 32
    /// have enough neighbours.
    ///
    /// Each patch has a variance of residuals from a cubic, corrected for its degrees of freedom. If only noise
    /// contributed, a fifth of the patches would be below the 20 % quantile of a χ² distribution; the result is the
    /// standard deviation for which that is so. It is insensitive to relief and creases in the other patches.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        const SAMPLES: usize = 1 << 14;
        const ENOUGH: usize = 32;
        /// The share of patches assumed to be calm, and the same quantile of the normal distribution.
        const CALM: f64 = 0.2;
        const CALM_Z: f64 = -0.841_621_233_572_914_3;
        const LEAST_FREEDOM: usize = 4;
        let surroundings = Surroundings::of(mesh);
        let count = surroundings.places.firsts.len();
        let samples = count.min(SAMPLES);
        let measured = parallel::collect(samples, |i| {
            let place = (i as u64 * count as u64 / samples as u64) as u32;
            let mut around = Around::default();
            let frame = surroundings.look(place, &mut around)?;
            let fit = Fit::<CUBIC>::of(&surroundings, frame, &around.all)?;
            let spread = Spread::of(fit.freedom)?;
            (fit.freedom >= LEAST_FREEDOM)
                .then(|| (fit.variance / spread.quantile(CALM_Z)).max(0.0).sqrt())
                .map(|sigma| (sigma, surroundings.edges(place, &around.near)))
        });
        let (mut sigmas, edges): (Vec<f64>, Vec<Vec<f64>>) = measured.into_iter().flatten().unzip();
        (sigmas.len() >= ENOUGH).then(|| Self {
            sigma: quantile(&mut sigmas, CALM),
            scale: 2.0 * quantile(&mut edges.concat(), 0.5),
            removed: None,
        })
    }

    /// Removes this noise from the mesh that it was measured on.
    ///
    /// Each vertex moves along its normal to the mean of the quadrics fitted to the patches around it, each weighted by
    /// how well noise explains its residuals: patches across a crease or with finer relief do not count, and a vertex
    /// with no other patch stays. No vertex moves by more than three standard deviations. Normals and tangents turn
    /// with the surface.
    ///
    /// Polynomial surfaces around a vertex are those of Cazals and Pouget 2005, "Estimating differential quantities
    /// using polynomial fitting of osculating jets"; the mean of overlapping estimates is that of Katkovnik, Egiazarian
    /// and Astola 2006, "Local Approximation Techniques in Signal and Image Processing". The weights are our own.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn remove(&self, mesh: &Mesh, progress: Progress<'_>) -> Result<Denoised> {
        let surroundings = Surroundings::of(mesh);
        let fits = surroundings.collect(progress.part(0.0, 0.5), &|place, around| {
            let fit =
                surroundings.look(place, around).and_then(|frame| Fit::of(&surroundings, frame, &around.all));
            fit.map_or(Weighted::default(), |fit| Weighted { weight: self.weight(&fit), fit })
        })?;
        let normals = vertex_normals(mesh);
        let limit = 3.0 * self.sigma;
        let shifts = surroundings.collect(progress.part(0.5, 0.9), &|place, around| {
            let normal = normals[surroundings.places.firsts[place as usize] as usize].to_f64();
            surroundings.shift(place, around, &fits).dot(normal).clamp(-limit, limit)
        })?;
        drop(fits);
        let rms = (shifts.iter().map(|shift| shift * shift).sum::<f64>() / shifts.len().max(1) as f64).sqrt();
        progress.at(0.9)?;
        let moved = |v: usize| {
            let shift = shifts[surroundings.places.of[v] as usize];
            (mesh.positions()[v].to_f64() + normals[v].to_f64() * shift).to_f32()
        };
        let positions = parallel::collect(normals.len(), moved);
        denoised(mesh, positions, (&normals, rms))
    }

    /// Returns the weight of a fit, [0, 1]: 1 if its residuals are not above the median of those of noise, and 0 from
    /// 1.5 standard deviations above it.
    fn weight(&self, fit: &Fit<QUADRATIC>) -> f64 {
        const MOST_EXCESS: f64 = 1.5;
        let variance = self.sigma * self.sigma;
        match Spread::of(fit.freedom).filter(|_| variance > 0.0) {
            Some(spread) => (1.0 - spread.deviations(fit.variance / variance) / MOST_EXCESS).clamp(0.0, 1.0),
            None => 0.0,
        }
    }
}

/// Returns the bytes needed for removing the noise of a mesh, in addition to the mesh and the result.
pub fn denoising_bytes(triangles: u64, vertices: u64) -> u64 {
    /// The corners in groups by position.
    const TRIANGLE: u64 = 12;
    /// Classes of equal vertices, the starts of the groups, displacements, positions, normals before and after.
    const VERTEX: u64 = 24 + 8 + 8 + 12 + 24;
    triangles * TRIANGLE + vertices * (VERTEX + size_of::<Weighted>() as u64)
}

/// Returns the mesh with other positions, with its normals and tangents turned by as much as the surface does; given its
/// smooth normals before, and the root mean square of the displacements.
fn denoised(mesh: &Mesh, positions: Vec<Vec3>, (before, rms): (&[Vec3], f64)) -> Result<Denoised> {
    let shape = MeshData { positions, triangles: mesh.triangles().to_vec(), ..MeshData::default() };
    let shape = Mesh::new(shape)?;
    let after = vertex_normals(&shape);
    let mut data = mesh.clone().into_data();
    data.positions = shape.positions().to_vec();
    parallel::change(&mut data.normals, |v, normal| *normal = turned(*normal, before[v], after[v]));
    parallel::change(&mut data.tangents, |v, [x, y, z, _]| {
        [*x, *y, *z] = turned(Vec3::new(*x, *y, *z), before[v], after[v]).to_array();
    });
    let turn = |v: usize| angle(before[v].to_f64(), after[v].to_f64()).to_degrees();
    let angles = parallel::collect(before.len(), turn);
    let mean_deg = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    let p95_deg = quantile(&mut angles.clone(), 0.95);
    let change = NoiseChange { rms, mean_deg, p95_deg };
    let angles = angles.into_iter().map(|angle| angle as f32).collect();
    Ok(Denoised { mesh: Mesh::new(data)?, change, angles })
}

/// Returns a vector after the rotation that turns the unit vector `from` to `to` by the shorter way; unchanged if they
/// are opposite.
fn turned(v: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let (v, from, to) = (v.to_f64(), from.to_f64(), to.to_f64());
    let (axis, cosine) = (from.cross(to), from.dot(to));
    if cosine < -0.999_999 {
        return v.to_f32();
    }
    let once = axis.cross(v);
    (v + once + axis.cross(once) / (1.0 + cosine)).to_f32()
}

/// Returns a quantile of values, which are sorted; 0 of none.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64).round() as usize).copied().unwrap_or(0.0)
}

/// The distribution of a variance estimated from normal samples, as a multiple of the true one: its cube root is nearly
/// normal.
///
/// Source: Wilson and Hilferty 1931, "The distribution of chi-square".
struct Spread {
    mean: f64,
    deviation: f64,
}

impl Spread {
    /// Returns the distribution for some degrees of freedom; `None` for none.
    fn of(freedom: usize) -> Option<Self> {
        let variance = 2.0 / (9.0 * freedom as f64);
        (freedom > 0).then(|| Self { mean: 1.0 - variance, deviation: variance.sqrt() })
    }

    /// Returns the quantile at a number of standard deviations of the normal distribution.
    fn quantile(&self, deviations: f64) -> f64 {
        let root = self.mean + deviations * self.deviation;
        root * root * root
    }

    /// Returns the number of standard deviations at which a value is.
    fn deviations(&self, value: f64) -> f64 {
        (scalar::cbrt(value) - self.mean) / self.deviation
    }
}

/// A mesh with the triangles at each position.
struct Surroundings<'a> {
    mesh: &'a Mesh,
    places: Classes,
    triangles: Groups<u32>,
}

/// The positions around one, in ascending order, itself included.
#[derive(Default)]
struct Around {
    /// Those within one edge.
    near: Vec<u32>,
    /// Those within two edges.
    all: Vec<u32>,
}

/// The local coordinates of a patch.
#[derive(Debug, Clone, Copy, Default)]
struct Frame {
    origin: Vec3<f64>,
    tangent: Vec3<f64>,
    normal: Vec3<f64>,
    /// The root mean square distance of its vertices from the origin.
    size: f64,
}

impl<'a> Surroundings<'a> {
    fn of(mesh: &'a Mesh) -> Self {
        let places = weld::by_position(mesh.positions());
        let corners =
            |(t, corners): (usize, &[u32; 3])| corners.map(|v| (places.of[v as usize] as usize, t as u32));
        let triangles =
            Groups::new(places.firsts.len(), || mesh.triangles().iter().enumerate().flat_map(corners));
        Self { mesh, places, triangles }
    }

    fn position(&self, place: u32) -> Vec3<f64> {
        self.mesh.positions()[self.places.firsts[place as usize] as usize].to_f64()
    }

    /// Finds the places around one, and the frame of its patch: its normal is the mean of the facets there, by area.
    /// `None` if the patch has no area or more than [`MOST`] vertices.
    fn look(&self, place: u32, Around { near, all }: &mut Around) -> Option<Frame> {
        let mut normal = Vec3::splat(0.0);
        self.add_corners(std::slice::from_ref(&place), near, &mut Vec3::splat(0.0))?;
        self.add_corners(near, all, &mut normal)?;
        let normal = unit(normal)?;
        let origin = self.position(place);
        let square = |other: &u32| (self.position(*other) - origin).dot(self.position(*other) - origin);
        let size = (all.iter().map(square).sum::<f64>() / all.len() as f64).sqrt();
        (size > 0.0).then(|| Frame { origin, tangent: normal.any_perpendicular(), normal, size })
    }

    /// Replaces `found` by the corners of all triangles at some places, and adds the doubled areas of these triangles.
    fn add_corners(&self, from: &[u32], found: &mut Vec<u32>, area: &mut Vec3<f64>) -> Option<()> {
        found.clear();
        for t in from.iter().flat_map(|place| self.triangles.of(*place as usize)) {
            let corners = self.mesh.triangles()[*t as usize].map(|v| self.places.of[v as usize]);
            let [a, b, c] = corners.map(|place| self.position(place));
            *area += (b - a).cross(c - a);
            found.extend(corners);
            if found.len() > 8 * MOST {
                return None;
            }
        }
        found.sort_unstable();
        found.dedup();
        (found.len() <= MOST).then_some(())
    }

    /// Returns the distances from a place to its neighbours.
    fn edges(&self, place: u32, near: &[u32]) -> Vec<f64> {
        let others = near.iter().filter(|other| **other != place);
        others.map(|other| (self.position(*other) - self.position(place)).length()).collect()
    }

    /// Returns the value of each place.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    fn collect<T: Send + Default + Clone>(
        &self,
        progress: Progress<'_>,
        value: &(dyn Fn(u32, &mut Around) -> T + Sync),
    ) -> Result<Vec<T>> {
        let count = self.places.firsts.len();
        let mut values = vec![T::default(); count];
        let (done, is_stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
        parallel::pieces(&mut values, BLOCK, &|block, part| {
            let before = done.fetch_add(part.len(), Ordering::Relaxed) as f64 / count as f64;
            if is_stopped.load(Ordering::Relaxed) || progress.at(before).is_err() {
                is_stopped.store(true, Ordering::Relaxed);
                return;
            }
            let mut around = Around::default();
            for (i, out) in part.iter_mut().enumerate() {
                *out = value((block * BLOCK + i) as u32, &mut around);
            }
        });
        if is_stopped.into_inner() { Err(Error::Cancelled) } else { Ok(values) }
    }

    /// Returns the displacement of a place to the weighted mean of all fits around it.
    fn shift(&self, place: u32, around: &mut Around, fits: &[Weighted]) -> Vec3<f64> {
        if self.look(place, around).is_none() {
            return Vec3::splat(0.0);
        }
        let (mut sum, mut total) = (Vec3::splat(0.0), 0.0);
        for Weighted { fit, weight } in around.all.iter().map(|other| &fits[*other as usize]) {
            if *weight > 0.0 {
                sum += fit.frame.normal * (-weight * fit.residual(self.position(place)));
                total += weight;
            }
        }
        if total > 0.0 { sum / total } else { sum }
    }
}

impl Frame {
    /// Returns the tangential coordinates of a point, as multiples of the patch's size, and its height.
    fn coordinates(&self, point: Vec3<f64>) -> [f64; 3] {
        let (v, bitangent) = (point - self.origin, self.normal.cross(self.tangent));
        [v.dot(self.tangent) / self.size, v.dot(bitangent) / self.size, v.dot(self.normal)]
    }
}

/// A polynomial surface of `N` coefficients fitted to a patch.
#[derive(Debug, Clone, Copy)]
struct Fit<const N: usize> {
    frame: Frame,
    coefficients: [f64; N],
    /// The degrees of freedom of its residuals.
    freedom: usize,
    /// The unbiased variance of its residuals.
    variance: f64,
}

/// A fit and its weight.
#[derive(Debug, Clone, Copy, Default)]
struct Weighted {
    fit: Fit<QUADRATIC>,
    weight: f64,
}

impl<const N: usize> Default for Fit<N> {
    fn default() -> Self {
        Self { frame: Frame::default(), coefficients: [0.0; N], freedom: 0, variance: 0.0 }
    }
}

impl<const N: usize> Fit<N> {
    /// Fits the heights of some places by least squares. `None` if they do not determine it, or leave no degree of
    /// freedom.
    fn of(surroundings: &Surroundings<'_>, frame: Frame, places: &[u32]) -> Option<Self> {
        let freedom = places.len().checked_sub(N).filter(|freedom| *freedom > 0)?;
        let (mut squares, mut products) = ([[0.0; N]; N], [0.0; N]);
        for place in places {
            let [u, v, height] = frame.coordinates(surroundings.position(*place));
            let terms = terms::<N>(u, v);
            for i in 0..N {
                (0..=i).for_each(|j| squares[i][j] += terms[i] * terms[j]);
                products[i] += terms[i] * height;
            }
        }
        let coefficients = solved(squares, products)?;
        let fit = Self { frame, coefficients, freedom, variance: 0.0 };
        let residuals = places.iter().map(|place| fit.residual(surroundings.position(*place)));
        let variance = residuals.map(|residual| residual * residual).sum::<f64>() / freedom as f64;
        Some(Self { variance, ..fit })
    }

    /// Returns the height of a point above the fitted surface.
    fn residual(&self, point: Vec3<f64>) -> f64 {
        let [u, v, height] = self.frame.coordinates(point);
        let terms = terms::<N>(u, v);
        height - terms.iter().zip(&self.coefficients).map(|(term, factor)| term * factor).sum::<f64>()
    }
}

/// Returns the first `N` monomials of a cubic.
fn terms<const N: usize>(u: f64, v: f64) -> [f64; N] {
    let all = [1.0, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v];
    std::array::from_fn(|i| all[i])
}

/// Solves a system with a symmetric positive definite matrix, given by its lower triangle, by Cholesky's decomposition.
/// `None` if it is singular, except for rounding.
fn solved<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    const SINGULAR: f64 = 1e-9;
    for i in 0..N {
        for j in 0..=i {
            let product: f64 = (0..j).map(|k| a[i][k] * a[j][k]).sum();
            let rest = a[i][j] - product;
            if i != j {
                a[i][j] = rest / a[j][j];
            } else if rest > SINGULAR * a[i][i] {
                a[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
        let product: f64 = (0..i).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - product) / a[i][i];
    }
    for i in (0..N).rev() {
        let product: f64 = (i + 1..N).map(|k| a[k][i] * b[k]).sum();
        b[i] = (b[i] - product) / a[i][i];
    }
    Some(b)
}
