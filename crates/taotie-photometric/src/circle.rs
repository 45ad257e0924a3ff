//! Circles in a picture: the outlines of balls, found by a Hough transform and refined on the edge itself.
//!
//! Each strong edge votes for the centres of all circles that it could belong to (Duda and Hart 1972, with the direction
//! of the gradient: Kimme, Ballard and Sklansky 1975). The edge of a candidate is then found to a fraction of a pixel
//! along 256 rays, and the circle fitted to it without outliers.

use crate::grey::GreyImage;
use serde::{Deserialize, Serialize};
use std::str::FromStr;
use taotie_engine::math::scalar;

/// A circle in a picture, in pixels: x to the right and y down from the top left corner. As JSON: `[x, y, radius]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[f64; 3]", into = "[f64; 3]")]
pub struct Circle {
    /// Its centre.
    pub center: [f64; 2],
    /// Its radius.
    pub radius: f64,
}

/// The smallest radius of a ball, pixels: a fifth of a pixel is then a degree of its light.
pub const LEAST_RADIUS: f64 = 8.0;

impl FromStr for Circle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("invalid circle `{text}`: expected X,Y,RADIUS in pixels, e.g. 310.5,220,64");
        let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some([x, y, radius]) if [x, y, radius].iter().all(|v| v.is_finite()) => {
                Self::try_from([*x, *y, *radius])
            }
            _ => Err(wrong()),
        }
    }
}

impl TryFrom<[f64; 3]> for Circle {
    type Error = String;

    fn try_from([x, y, radius]: [f64; 3]) -> Result<Self, String> {
        if ![x, y, radius].iter().all(|v| v.is_finite()) {
            return Err(format!(
                "circle `{x},{y},{radius}` is not finite: give its centre and radius in pixels"
            ));
        }
        match radius < LEAST_RADIUS {
            true => {
                Err(format!("circle `{x},{y},{radius}` is too small: its radius must be at least 8 pixels"))
            }
            false => Ok(Self { center: [x, y], radius }),
        }
    }
}

impl From<Circle> for [f64; 3] {
    fn from(Circle { center: [x, y], radius }: Circle) -> Self {
        [x, y, radius]
    }
}

impl Circle {
    /// Returns true if a pixel's centre is within `margin` pixels of the disc.
    pub fn holds(&self, [x, y]: [usize; 2], margin: f64) -> bool {
        let [dx, dy] = [x as f64 + 0.5 - self.center[0], y as f64 + 0.5 - self.center[1]];
        dx * dx + dy * dy < (self.radius + margin) * (self.radius + margin)
    }

    /// Returns true if the circle is within a picture of this size.
    pub fn is_within(&self, [width, height]: [usize; 2]) -> bool {
        let inside = |v: f64, side: usize| v >= self.radius && v + self.radius <= side as f64;
        inside(self.center[0], width) && inside(self.center[1], height)
    }

    /// Returns true if the circles are nearly the same. A ball that mirrors the horizon shows two around one centre.
    fn is_like(&self, other: &Self) -> bool {
        let [dx, dy] = [0, 1].map(|axis| self.center[axis] - other.center[axis]);
        let (less, more) = (self.radius.min(other.radius), self.radius.max(other.radius));
        (dx * dx + dy * dy).sqrt() < 0.5 * more && less > 0.8 * more
    }
}

/// A circle fitted to an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// The circle.
    pub circle: Circle,
    /// Root mean square distance of the edge points from it, pixels.
    pub residual: f64,
    /// The fraction of the rays whose edge is on the circle.
    pub share: f64,
}

/// The longest side of the picture in which circles are first looked for.
const COARSE: usize = 400;
/// The fraction of the pixels that count as edges.
const EDGES: f64 = 0.1;
/// The fraction of a circle that edges must cover.
const COVERED: f64 = 0.4;
/// The most candidates.
const MOST: usize = 24;
/// The smallest radius in the coarse picture.
const LEAST_COARSE: usize = 7;

/// Returns the circles that edges suggest, the clearest first, in pixels of the whole picture.
pub fn candidates(image: &GreyImage) -> Vec<Circle> {
    let size = image.width.max(image.height).div_ceil(COARSE);
    let coarse = image.reduced(size);
    let edges = edges(&coarse);
    let most = coarse.width.min(coarse.height) / 2;
    let mut found: Vec<(f64, Circle)> = Vec::new();
    for radius in LEAST_COARSE..most {
        let votes = votes(&coarse, &edges, radius as f64);
        let around = std::f64::consts::TAU * radius as f64;
        for y in 1..coarse.height.saturating_sub(1) {
            for x in 1..coarse.width.saturating_sub(1) {
                let near = |y: usize| votes[y * coarse.width + x - 1..=y * coarse.width + x + 1].iter();
                let sum: u32 = (y - 1..=y + 1).flat_map(near).map(|v| u32::from(*v)).sum();
                let score = f64::from(sum) / around;
                if score > COVERED {
                    let scale = size as f64;
                    let center = [x, y].map(|v| (v as f64 + 0.5) * scale);
                    found.push((score, Circle { center, radius: radius as f64 * scale }));
                }
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Circle> = Vec::new();
    for (_, circle) in found {
        if kept.len() < MOST && !kept.iter().any(|other| other.is_like(&circle)) {
            kept.push(circle);
        }
    }
    kept
}

/// An edge pixel and its direction.
struct Edge {
    at: [f64; 2],
    direction: [f64; 2],
}

fn edges(image: &GreyImage) -> Vec<Edge> {
    let gradients = image.gradients();
    let length = |[x, y]: &[f64; 2]| (x * x + y * y).sqrt();
    let mut lengths: Vec<f64> = gradients.iter().map(length).collect();
    let at = ((1.0 - EDGES) * (lengths.len() - 1) as f64) as usize;
    let least = lengths.select_nth_unstable_by(at, f64::total_cmp).1.max(f64::MIN_POSITIVE);
    let edge = |(i, g): (usize, &[f64; 2])| {
        let length = length(g);
        (length >= least).then(|| Edge {
            at: [i % image.width, i / image.width].map(|v| v as f64),
            direction: g.map(|v| v / length),
        })
    };
    gradients.iter().enumerate().filter_map(edge).collect()
}

/// Returns the votes for each centre of circles of one radius.
fn votes(image: &GreyImage, edges: &[Edge], radius: f64) -> Vec<u16> {
    let mut votes = vec![0_u16; image.values.len()];
    for edge in edges {
        for side in [radius, -radius] {
            let [x, y] = [0, 1].map(|axis| (edge.at[axis] + side * edge.direction[axis] + 0.5).floor());
            if x >= 0.0 && y >= 0.0 && x < image.width as f64 && y < image.height as f64 {
                let vote = &mut votes[y as usize * image.width + x as usize];
                *vote = vote.saturating_add(1);
            }
        }
    }
    votes
}

/// Rays across the edge.
const RAYS: usize = 256;
/// Steps of a pixel along a ray.
const STEP: f64 = 0.25;

/// Fits a circle to the edge near it; `None` if most of the edge is elsewhere.
pub fn refined(image: &GreyImage, start: Circle) -> Option<Outline> {
    let mut outline = Outline { circle: start, residual: 0.0, share: 0.0 };
    // The coarse circle is right to two coarse pixels; then the edge is where the fit says.
    let coarse = image.width.max(image.height).div_ceil(COARSE) as f64;
    for reach in [2.5 * coarse + 1.0, 2.5, 2.0, 2.0] {
        let points: Vec<[f64; 2]> =
            (0..RAYS).filter_map(|i| edge_on_ray(image, &outline.circle, (i, reach))).collect();
        outline = fitted(&points, outline.circle)?;
    }
    (outline.share > 0.5).then_some(outline)
}

/// Returns the point of the steepest step along ray `i` within `reach` pixels of the circle.
fn edge_on_ray(image: &GreyImage, circle: &Circle, (i, reach): (usize, f64)) -> Option<[f64; 2]> {
    let angle = std::f64::consts::TAU * i as f64 / RAYS as f64;
    let direction = [scalar::cos(angle), scalar::sin(angle)];
    let point = |r: f64| [0, 1].map(|axis| circle.center[axis] + r * direction[axis]);
    let steps = (2.0 * reach / STEP).ceil() as usize;
    let r = |k: usize| circle.radius - reach + k as f64 * STEP;
    // Differences over a pixel, which is the width of an edge.
    let step = |k: usize| (image.at(point(r(k) + 0.5)) - image.at(point(r(k) - 0.5))).abs();
    let steps: Vec<f64> = (0..=steps).map(step).collect();
    let best = (0..steps.len()).max_by(|a, b| steps[*a].total_cmp(&steps[*b]))?;
    if best == 0 || best + 1 == steps.len() || steps[best] <= 0.0 {
        return None;
    }
    // The centre of the step: less sensitive to noise than its highest value.
    let (mut sum, mut total) = (0.0, 0.0);
    for k in best.saturating_sub(5)..(best + 6).min(steps.len()) {
        let weight = (steps[k] - 0.4 * steps[best]).max(0.0);
        sum += weight * r(k);
        total += weight;
    }
    Some(point(sum / total))
}

/// Fits a circle to points by Gauss-Newton on their distances, with Tukey's biweight.
fn fitted(points: &[[f64; 2]], start: Circle) -> Option<Outline> {
    if points.len() < RAYS / 4 {
        return None;
    }
    let mut circle = start;
    let distance = |circle: &Circle, p: &[f64; 2]| {
        let [dx, dy] = [p[0] - circle.center[0], p[1] - circle.center[1]];
        let length = (dx * dx + dy * dy).sqrt();
        (length - circle.radius, taotie_engine::math::Vec3::new(dx / length, dy / length, 1.0))
    };
    let mut reach = f64::INFINITY;
    for _ in 0..12 {
        let mut sums = crate::symmetric::Sym3::default();
        let mut right = taotie_engine::math::Vec3::splat(0.0);
        for point in points {
            let (residual, along) = distance(&circle, point);
            let weight = crate::block::weight(residual, 1.0 / reach);
            sums.add(along, weight);
            right += along * (weight * residual);
        }
        let step = sums.inverse()?.times(right);
        circle.center = [circle.center[0] + step.x, circle.center[1] + step.y];
        circle.radius += step.z;
        let mut sizes: Vec<f64> = points.iter().map(|p| distance(&circle, p).0.abs()).collect();
        let middle = sizes.len() / 2;
        let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        reach = (3.0 * 1.4826 * median).max(0.15);
    }
    let sound =
        circle.radius.is_finite() && circle.radius > 0.5 * start.radius && circle.radius < 2.0 * start.radius;
    if !sound {
        return None;
    }
    let inside: Vec<f64> =
        points.iter().map(|p| distance(&circle, p).0).filter(|d| d.abs() < reach).collect();
    let squares: f64 = inside.iter().map(|d| d * d).sum();
    Some(Outline {
        circle,
        residual: (squares / inside.len().max(1) as f64).sqrt(),
        share: inside.len() as f64 / RAYS as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws discs on a background with stripes, each pixel the mean of 8 × 8 points.
    fn drawn(discs: &[(Circle, f32)], [width, height]: [usize; 2]) -> GreyImage {
        let value = |x: f64, y: f64| {
            let inside = discs.iter().find(|(c, _)| {
                let [dx, dy] = [x - c.center[0], y - c.center[1]];
                dx * dx + dy * dy < c.radius * c.radius
            });
            inside.map_or(0.4 + 0.1 * scalar::sin(0.3 * x + 0.2 * y) as f32, |(_, grey)| *grey)
        };
        let pixel = |i: usize| {
            let at = |k: usize, j: usize| {
                value(
                    (i % width) as f64 + (k as f64 + 0.5) / 8.0,
                    (i / width) as f64 + (j as f64 + 0.5) / 8.0,
                )
            };
            (0..64).map(|k| at(k % 8, k / 8)).sum::<f32>() / 64.0
        };
        GreyImage { width, height, values: (0..width * height).map(pixel).collect() }
    }

    #[test]
    fn drawn_balls_are_found_to_a_tenth_of_a_pixel() {
        for (size, scale) in [([260, 200], 1.0), ([900, 700], 3.4)] {
            let circle =
                |x: f64, y: f64, r: f64| Circle { center: [x * scale, y * scale], radius: r * scale };
            let balls = [(circle(41.3, 60.8, 22.37), 0.05), (circle(200.6, 121.4, 17.7), 0.8)];
            let image = drawn(&balls, size);
            let found = candidates(&image);
            for (ball, _) in balls {
                let near = found.iter().find(|c| c.is_like(&ball)).expect("a candidate");
                let outline = refined(&image, *near).unwrap();
                let Circle { center: [x, y], radius } = outline.circle;
                let off = [x - ball.center[0], y - ball.center[1], radius - ball.radius];
                assert!(off.iter().all(|v| v.abs() < 0.1), "{off:?} {outline:?}");
                assert!(outline.share > 0.9 && outline.residual < 0.1, "{outline:?}");
            }
        }
    }

    #[test]
    fn circles_are_read_from_text() {
        assert_eq!("310.5, 220,64".parse(), Ok(Circle { center: [310.5, 220.0], radius: 64.0 }));
        for wrong in ["", "1,2", "1,2,3,4", "a,2,30", "1,2,inf", "nan,2,30"] {
            assert!(wrong.parse::<Circle>().unwrap_err().contains("expected X,Y,RADIUS"), "{wrong}");
        }
        assert!("5,5,2".parse::<Circle>().unwrap_err().contains("at least 8"));
    }
}
