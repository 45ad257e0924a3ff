//! Irradiance: the light that a matt plane gathers, exactly.
//!
//! Nine numbers of spherical harmonics are close in the mean, but on the dark side of a room with few bright lamps they
//! are off by a quarter, and by a factor under a sun; so the integral itself is kept, for as many directions as its
//! smoothness asks for.

use super::octahedron::{self, Octahedron, place_of};
use super::picture::{Picture, direction_at};
use crate::math::{Vec3, scalar};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Texels along a side of the map: between them the irradiance bends by less than 0.2 %.
const SIDE: usize = 48;

/// The most parts of the picture that are summed, across and down; a lamp moves by half a part at most.
const PARTS: [usize; 2] = [128, 64];

/// The irradiance in every direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CosineMap(pub(super) Octahedron);

/// A part of the picture: where it is, and what it sends: radiance times solid angle.
struct Part {
    direction: Vec3,
    light: Vec3,
}

impl CosineMap {
    /// Of a picture whose texels each shine evenly.
    pub(super) fn new(picture: &Picture) -> Self {
        let parts = parts(picture);
        let normals: Vec<Vec3> = octahedron::directions(SIDE).collect();
        Self(Octahedron::new(SIDE, |texel| {
            let sum = parts.iter().fold(Vec3::default(), |sum, part| {
                sum + part.light * part.direction.dot(normals[texel]).max(0.0)
            });
            [sum.x, sum.y, sum.z, 1.0]
        }))
    }

    /// The irradiance on a plane with the unit normal `n`.
    #[inline]
    pub(super) fn at(&self, n: Vec3) -> Vec3 {
        self.0.at(place_of(n))
    }
}

/// The picture in parts of whole texels.
fn parts(picture: &Picture) -> Vec<Part> {
    let (width, height) = (picture.width(), picture.height());
    let [across, down] = [PARTS[0].min(width), PARTS[1].min(height)];
    let areas: Vec<f64> = (0..height).map(|y| area(y, width, height)).collect();
    let part = |i: usize| {
        let range = |k: usize, parts: usize, size: usize| k * size / parts..(k + 1) * size / parts;
        let (columns, rows) = (range(i % across, across, width), range(i / across, down, height));
        let middle = |range: &Range<usize>, size: usize| (range.start + range.end) as f64 / (2 * size) as f64;
        let (u, v) = (middle(&columns, width), middle(&rows, height));
        let mut light = Vec3::default();
        for y in rows {
            for x in columns.clone() {
                light += picture.texel(x, y).to_f64() * areas[y];
            }
        }
        Part { direction: direction_at(u, scalar::cos(v * PI)), light: light.to_f32() }
    };
    (0..across * down).into_par_iter().map(part).collect()
}

/// The solid angle of a texel in row `y`.
fn area(y: usize, width: usize, height: usize) -> f64 {
    let edge = |y: usize| scalar::cos(y as f64 * PI / height as f64);
    (edge(y) - edge(y + 1)) * TAU / width as f64
}
