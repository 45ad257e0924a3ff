//! The large shape of a relief from a scan of the same object, whose pose is known.
//!
//! Heights integrated from normals are accurate from pixel to pixel, and drift over the picture; a scan does not. To the
//! heights are added a quadratic polynomial of the place, which fits the difference of both, and the rest of the difference,
//! smoothed over connected surfaces: it minimises the sum of its squared steps between neighbours and, times 1 / [`RANGE`]²,
//! of its squared distances from that rest (screened Poisson).

use crate::depth::Relief;
use crate::indirect::quantile;
use crate::materials::{Model, Pose, inverse, times};
use taotie_engine::error::{Error, Result};
use taotie_engine::parallel;

/// Pixels over which the scan's heights are smoothed: larger shapes are the scan's, smaller ones those of the normals.
const RANGE: f64 = 16.0;
/// Rounds in which scanned pixels that disagree lose weight.
const ROUNDS: usize = 3;
/// The most steps of conjugate gradients in a round.
const STEPS: usize = 400;
/// The residual at which they end, relative to the right side.
const PRECISE: f64 = 1e-6;

/// The heights of a scan in the pixels of the photographs.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanHeights {
    width: usize,
    /// Heights towards the camera in pixels, row by row; NaN where the scan has no surface.
    heights: Vec<f64>,
}

/// How a relief and a scan agree.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Anchoring {
    /// Pixels whose height the scan states.
    pub scanned: usize,
    /// Pixels of surfaces that are not connected to any of these: their distance from the others is unknown.
    pub unanchored: usize,
    /// Root mean square by which the scan moved the heights, in pixels.
    pub moved: f64,
    /// Median distance between scan and relief afterwards, in pixels.
    pub residual: f64,
}

impl ScanHeights {
    /// Looks at a scan through the camera of photographs of this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the camera states another size, or does not see the scan.
    pub fn new(scan: &Model, pose: &Pose, size: [u32; 2]) -> Result<Self> {
        if let Some(stated) = pose.lens.other_size(size) {
            let why = format!("the photographs have {}x{}; scale the camera", size[0], size[1]);
            return Err(Error::invalid(format!("the scan's camera has {stated} pixels"), why));
        }
        let projection = pose.lens.projection(size);
        let [width, height] = size.map(|v| v as usize);
        let eye = pose.world_from_view.axis(3);
        let depths: Vec<f64> = parallel::collect(width * height, |i| {
            let place = [i % width, i / width].map(|v| v as f64 + 0.5);
            // The direction's z is −1, so that distances along it are depths.
            let along = pose.world_from_view.transform_vector(projection.direction(place));
            scan.first(eye, along).map_or(f64::NAN, |hit| f64::from(hit.distance))
        });
        let seen: Vec<f64> = depths.iter().copied().filter(|depth| depth.is_finite()).collect();
        if seen.is_empty() {
            let why = "it must be in the coordinates of its camera, which looks along its −z axis";
            return Err(Error::invalid("the camera does not see the scan", why));
        }
        let middle = quantile(seen, 0.5);
        let pixel = projection.pixel(middle);
        let heights = depths.into_iter().map(|depth| (middle - depth) / pixel).collect();
        Ok(Self { width, heights })
    }
}

impl Relief {
    /// Moves the heights so that large shapes are those of a scan; returns true for each pixel that a scanned one is connected
    /// to.
    pub fn anchor(&mut self, scan: &ScanHeights) -> (Vec<bool>, Anchoring) {
        let off = |(pixel, height): (&u32, &f64)| {
            let [x, y] = [*pixel as usize % self.grid.width, *pixel as usize / self.grid.width];
            scan.heights[y * scan.width + x] - height
        };
        let off: Vec<f64> = self.grid.pixels.iter().zip(&self.heights).map(off).collect();
        let mut screened = Screened { neighbours: self.connections(), weights: Vec::new() };
        let mut polynomial = vec![0.0; off.len()];
        let mut rest = vec![0.0; off.len()];
        let mut scale = f64::INFINITY;
        for _ in 0..ROUNDS {
            let sum: Vec<f64> = polynomial.iter().zip(&rest).map(|(a, b)| a + b).collect();
            screened.weights = weights(&off, &sum, scale);
            polynomial = self.polynomial(&off, &screened.weights);
            let left: Vec<f64> = off.iter().zip(&polynomial).map(|(off, v)| off - v).collect();
            screened.solve(&left, &mut rest);
            let residuals: Vec<f64> =
                left.iter().zip(&rest).map(|(a, b)| (a - b).abs()).filter(|v| v.is_finite()).collect();
            if residuals.is_empty() {
                break;
            }
            scale = (2.0 * quantile(residuals, 0.5)).max(1e-3);
        }
        let correction: Vec<f64> = polynomial.iter().zip(&rest).map(|(a, b)| a + b).collect();
        let anchored = connected(&screened.neighbours, |i| off[i].is_finite());
        let count = self.heights.len().max(1) as f64;
        let anchoring = Anchoring {
            scanned: off.iter().filter(|v| v.is_finite()).count(),
            unanchored: anchored.iter().filter(|is| !**is).count(),
            moved: (spread(&correction) / count).sqrt(),
            residual: if scale.is_finite() { 0.5 * scale } else { 0.0 },
        };
        self.heights.iter_mut().zip(&correction).for_each(|(height, correction)| *height += correction);
        let mean = self.heights.iter().sum::<f64>() / count;
        self.heights.iter_mut().for_each(|height| *height -= mean);
        (anchored, anchoring)
    }

    /// Returns the quadratic polynomial of the place that fits weighted numbers best, at all pixels.
    fn polynomial(&self, numbers: &[f64], weights: &[f64]) -> Vec<f64> {
        let size = self.grid.width.max(self.grid.height) as f64;
        let terms = |i: usize| {
            let [x, y] = self.grid.position(i).map(|v| v as f64 / size - 0.5);
            [1.0, x, y, x * x, x * y, y * y]
        };
        let (mut matrix, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
        for (i, (number, weight)) in
            numbers.iter().zip(weights).enumerate().filter(|(_, (_, weight))| **weight > 0.0)
        {
            let terms = terms(i);
            for a in 0..6 {
                right[a] += weight * terms[a] * number;
                (0..6).for_each(|b| matrix[a][b] += weight * terms[a] * terms[b]);
            }
        }
        let total = matrix[0][0];
        (0..6).for_each(|a| matrix[a][a] += 1e-9 * total + f64::MIN_POSITIVE);
        let factors = inverse(&matrix).map_or([0.0; 6], |inverse| times(&inverse, &right));
        let value = |i: usize| terms(i).iter().zip(&factors).map(|(term, factor)| term * factor).sum();
        (0..numbers.len()).map(value).collect()
    }

    /// Returns the pixels to the right and above to which the surface continues.
    fn connections(&self) -> Vec<[Option<u32>; 2]> {
        let of = |i: usize| {
            let [x, y] = self.grid.position(i).map(|v| v as i64);
            let [right, above] = self.continues[i];
            let at = |is: bool, x: i64, y: i64| self.grid.at(x, y).filter(|_| is).map(|i| i as u32);
            [at(right, x + 1, y), at(above, x, y - 1)]
        };
        (0..self.heights.len()).map(of).collect()
    }
}

/// Returns true for each pixel that is connected to one that `is`.
fn connected(neighbours: &[[Option<u32>; 2]], is: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut parts = taotie_engine::groups::DisjointSets::new(neighbours.len());
    for (i, others) in neighbours.iter().enumerate() {
        others.iter().flatten().for_each(|other| parts.join(i as u32, *other));
    }
    let parts = parts.into_lowest();
    let mut has = vec![false; neighbours.len()];
    (0..has.len()).filter(|i| is(*i)).for_each(|i| has[parts[i] as usize] = true);
    parts.iter().map(|part| has[*part as usize]).collect()
}

/// Returns the weights of the distances of a correction from the differences, which are NaN without a scan.
fn weights(off: &[f64], correction: &[f64], scale: f64) -> Vec<f64> {
    let weight = |(off, correction): (&f64, &f64)| {
        let left = (off - correction) / scale;
        if off.is_finite() { 1.0 / (RANGE * RANGE * (1.0 + left * left)) } else { 0.0 }
    };
    off.iter().zip(correction).map(weight).collect()
}

/// Returns the sum of squares about the mean.
fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|v| (v - mean) * (v - mean)).sum()
}

/// The matrix of the least squares: differences of neighbours, and weights on the diagonal.
struct Screened {
    neighbours: Vec<[Option<u32>; 2]>,
    weights: Vec<f64>,
}

impl Screened {
    fn times(&self, v: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(v).zip(&self.weights).for_each(|((out, v), weight)| *out = weight * v);
        for (i, others) in self.neighbours.iter().enumerate() {
            for other in others.iter().flatten().map(|other| *other as usize) {
                let step = v[i] - v[other];
                out[i] += step;
                out[other] -= step;
            }
        }
    }

    /// Improves a solution for the weighted target by conjugate gradients.
    fn solve(&self, target: &[f64], v: &mut [f64]) {
        let mut residual: Vec<f64> =
            target.iter().zip(&self.weights).map(|(t, w)| if *w > 0.0 { w * t } else { 0.0 }).collect();
        let enough = PRECISE * PRECISE * dot(&residual, &residual);
        let mut applied = vec![0.0; v.len()];
        self.times(v, &mut applied);
        residual.iter_mut().zip(&applied).for_each(|(r, a)| *r -= a);
        let mut direction = residual.clone();
        let mut square = dot(&residual, &residual);
        for _ in 0..STEPS {
            if square <= enough {
                return;
            }
            self.times(&direction, &mut applied);
            let length = square / dot(&direction, &applied);
            if !length.is_finite() {
                return;
            }
            v.iter_mut().zip(&direction).for_each(|(v, d)| *v += length * d);
            residual.iter_mut().zip(&applied).for_each(|(r, a)| *r -= length * a);
            let next = dot(&residual, &residual);
            let turn = next / square;
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + turn * *d);
            square = next;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use taotie_engine::math::scalar;

    #[test]
    fn large_shapes_follow_the_scan_and_detail_does_not() {
        let side = 128;
        let large = |x: f64, y: f64| 8.0 * scalar::sin(0.04 * x) + 5.0 * scalar::cos(0.03 * y);
        let detail = |x: f64, y: f64| 0.5 * scalar::sin(1.1 * x) * scalar::sin(0.9 * y);
        let place = |i: usize| [i % side, i / side].map(|v| v as f64);
        // The relief is tilted and bent by a bias of its normals; the scan is noisy, has a hole, and misses the detail.
        let bias = |x: f64, y: f64| 0.05 * x - 0.03 * y + 0.0005 * x * x + 2.0 * scalar::sin(0.04 * y);
        let relief = |i: usize| {
            let [x, y] = place(i);
            large(x, y) + detail(x, y) + bias(x, y)
        };
        let scanned = |i: usize| {
            let [x, y] = place(i);
            let hole = (40.0..60.0).contains(&x) && (40.0..60.0).contains(&y);
            let noise = ((i * 7919) % 101) as f64 / 101.0 - 0.5;
            if hole { f64::NAN } else { large(x, y) + noise }
        };
        let is_inside = |i: usize| i % side < side - 8;
        let pixels: Vec<u32> = (0..side * side).map(|i| i as u32).collect();
        let mut found = Relief {
            grid: Grid::new(side, side, pixels),
            heights: (0..side * side).map(relief).collect(),
            // The last columns are a separate part, without a scan.
            continues: (0..side * side).map(|i| [i % side != side - 9, true]).collect(),
        };
        let heights = (0..side * side).map(|i| if is_inside(i) { scanned(i) } else { f64::NAN });
        let scan = ScanHeights { width: side, heights: heights.collect() };
        let error = |found: &Relief| {
            let inside = (0..side * side).filter(|i| is_inside(*i));
            let off: Vec<f64> = inside
                .map(|i| {
                    found.heights[i] - large(place(i)[0], place(i)[1]) - detail(place(i)[0], place(i)[1])
                })
                .collect();
            (spread(&off) / off.len() as f64).sqrt()
        };
        assert!(error(&found) > 3.0);
        let (anchored, anchoring) = found.anchor(&scan);
        assert!(error(&found) < 0.5, "{} {anchoring:?}", error(&found));
        assert_eq!(anchoring.unanchored, 8 * side);
        assert!((0..side * side).all(|i| anchored[i] == is_inside(i)));
    }
}
