//! Outlines of scan and asset from all sides.

use super::overview::{SIDE, VIEWS, View};
use super::pair::Pair;
use crate::bake::sphere_directions;
use crate::mesh::Mesh;
use crate::parallel;

/// The deviation of an asset's outlines from those of its scan over 32 fixed views, the object filling 512² pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SilhouetteFigures {
    /// The mean distance of the asset's outline from the scan's and back, pixels.
    pub mean_pixels: f64,
    /// The largest, pixels.
    pub max_pixels: f64,
    /// The largest, model units.
    pub max_length: f64,
}

/// Compares the outlines of both surfaces.
pub fn silhouettes(pair: &Pair<'_>) -> SilhouetteFigures {
    let directions = sphere_directions(VIEWS);
    let views = parallel::tasks(VIEWS, &|i| {
        let view = View::fitting(pair, directions[i]);
        let [scan, asset] = [pair.scan, pair.asset].map(|side| Mask::of(side.surface.mesh(), &view));
        let found = scan.outline_distances(&asset).into_iter().chain(asset.outline_distances(&scan));
        let mut sums = Sums::default();
        found.for_each(|distance| sums.add(distance));
        (sums, f64::from(view.pixel))
    });
    let mut figures = SilhouetteFigures::default();
    let (mut sum, mut count) = (0.0, 0);
    for (sums, pixel) in views {
        (sum, count) = (sum + sums.sum, count + sums.count);
        figures.max_pixels = figures.max_pixels.max(sums.most);
        figures.max_length = figures.max_length.max(sums.most * pixel);
    }
    figures.mean_pixels = sum / f64::from(count.max(1));
    figures
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    sum: f64,
    most: f64,
    count: u32,
}

impl Sums {
    fn add(&mut self, distance: f64) {
        (self.sum, self.most, self.count) = (self.sum + distance, self.most.max(distance), self.count + 1);
    }
}

/// The pixels whose middles a mesh covers in a view.
struct Mask {
    is_covered: Vec<bool>,
}

impl Mask {
    fn of(mesh: &Mesh, view: &View) -> Self {
        let place = |p: crate::math::Vec3| {
            let away = p - view.corner;
            view.axes.map(|axis| axis.dot(away) / view.pixel - 0.5)
        };
        let places: Vec<[f32; 2]> = mesh.positions().iter().map(|p| place(*p)).collect();
        let mut mask = Self { is_covered: vec![false; SIDE * SIDE] };
        for triangle in mesh.triangles() {
            mask.cover(triangle.map(|v| places[v as usize]));
        }
        mask
    }

    /// Covers the pixels whose middles, whole numbers, lie in a triangle or on its border.
    fn cover(&mut self, [a, b, c]: [[f32; 2]; 3]) {
        let bounds = |k: usize| {
            let [low, high] = [a[k].min(b[k]).min(c[k]).ceil(), a[k].max(b[k]).max(c[k]).floor()];
            (low.max(0.0) as usize, high.min(SIDE as f32 - 1.0))
        };
        let ((left, right), (top, bottom)) = (bounds(0), bounds(1));
        if right < left as f32 || bottom < top as f32 {
            return;
        }
        let edge = |p: [f32; 2], q: [f32; 2], x: f32, y: f32| {
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        };
        for y in top..=bottom as usize {
            for x in left..=right as usize {
                let (px, py) = (x as f32, y as f32);
                let sides = [edge(a, b, px, py), edge(b, c, px, py), edge(c, a, px, py)];
                if sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0) {
                    self.is_covered[y * SIDE + x] = true;
                }
            }
        }
    }

    fn at(&self, x: isize, y: isize) -> bool {
        let side = SIDE as isize;
        (0..side).contains(&x) && (0..side).contains(&y) && self.is_covered[(y * side + x) as usize]
    }

    /// Returns `true` for a covered pixel with a neighbour that is not.
    fn is_outline(&self, x: isize, y: isize) -> bool {
        self.at(x, y) && !(self.at(x - 1, y) && self.at(x + 1, y) && self.at(x, y - 1) && self.at(x, y + 1))
    }

    fn outline(&self) -> Vec<[isize; 2]> {
        let side = SIDE as isize;
        let pixels = (0..side).flat_map(|y| (0..side).map(move |x| [x, y]));
        pixels.filter(|[x, y]| self.is_outline(*x, *y)).collect()
    }

    /// Returns how far each pixel of the outline lies from the outline of another mask, pixels; as far as the picture is
    /// wide if that has none.
    fn outline_distances(&self, other: &Self) -> Vec<f64> {
        let others = other.outline();
        let distance = |[x, y]: [isize; 2]| {
            other.near_outline([x, y]).or_else(|| {
                let squared = others.iter().map(|[u, v]| (u - x).pow(2) + (v - y).pow(2)).min()?;
                Some((squared as f64).sqrt())
            })
        };
        self.outline().into_iter().map(|at| distance(at).unwrap_or(SIDE as f64)).collect()
    }

    /// Returns the distance of the outline from a pixel, if it is no more than a few pixels.
    fn near_outline(&self, [x, y]: [isize; 2]) -> Option<f64> {
        const REACH: isize = 4;
        let around = (-REACH..=REACH).flat_map(|v| (-REACH..=REACH).map(move |u| [u, v]));
        let near = around.filter(|[u, v]| u * u + v * v <= REACH * REACH && self.is_outline(x + u, y + v));
        near.map(|[u, v]| u * u + v * v).min().map(|squared| (squared as f64).sqrt())
    }
}
