//! Points on triangles: the mesh's values there, and points spread evenly over the area of a mesh.

use super::Mesh;
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3, integration::Sequence};
use crate::parallel;
use std::ops::{Add, Mul};

/// A point on a triangle of a mesh.
///
/// All vertex values of the mesh are interpolated linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Index of the triangle.
    pub triangle: u32,
    /// Barycentric weights of its corners, with sum 1; none is negative within the triangle.
    pub weights: [f32; 3],
}

/// The interpolated tangent frame at a point; its vectors are not normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentFrame {
    /// The normal, interpolated between those of the corners.
    pub normal: Vec3,
    /// The tangent, interpolated between those of the corners.
    pub tangent: Vec3,
    /// ±1: the bitangent is this times cross(normal, tangent). That of the first corner.
    pub handedness: f32,
}

/// The mean of three values with these weights, summed in the order of the corners.
#[inline]
pub(crate) fn blend<T: Mul<f32, Output = T> + Add<Output = T>>([a, b, c]: [T; 3], [u, v, w]: [f32; 3]) -> T {
    a * u + b * v + c * w
}

/// The values of three corners. Written out, since `map` over an array may become a call, which takes longer than the
/// rest of the function.
#[inline(always)]
pub(crate) fn each<I: Copy, T>([a, b, c]: [I; 3], value: impl Fn(I) -> T) -> [T; 3] {
    [value(a), value(b), value(c)]
}

/// Each method must be passed the mesh of the point.
///
/// # Panics
/// All methods panic if that mesh lacks the triangle; those that read an array, if the mesh lacks the array.
impl Point {
    /// The vertices of the triangle.
    #[inline]
    pub fn vertices(&self, mesh: &Mesh) -> [usize; 3] {
        each(mesh.triangles()[self.triangle as usize], |v| v as usize)
    }

    /// The position, in object space.
    #[inline]
    pub fn position(&self, mesh: &Mesh) -> Vec3 {
        blend(mesh.corners(self.triangle as usize), self.weights)
    }

    /// The interpolated normal, unit; if it vanishes, that of the first corner.
    #[inline]
    pub fn normal(&self, mesh: &Mesh) -> Vec3 {
        let normals = mesh.normals();
        let normals = each(self.vertices(mesh), |v| normals[v]);
        blend(normals, self.weights).normalize_or(normals[0])
    }

    /// The mean of the corners' normals with the point's weights, not normalised.
    #[inline]
    pub fn mean_normal(&self, mesh: &Mesh) -> Vec3 {
        let normals = mesh.normals();
        blend(each(self.vertices(mesh), |v| normals[v]), self.weights)
    }

    /// The interpolated tangent frame.
    #[inline]
    pub fn frame(&self, mesh: &Mesh) -> TangentFrame {
        let vertices = self.vertices(mesh);
        let tangents = mesh.tangents();
        let tangent = |v: usize| {
            let [x, y, z, _] = tangents[v];
            Vec3::new(x, y, z)
        };
        TangentFrame {
            normal: self.mean_normal(mesh),
            tangent: blend(each(vertices, tangent), self.weights),
            handedness: tangents[vertices[0]][3],
        }
    }

    /// The interpolated uv of a set.
    #[inline]
    pub fn uv(&self, mesh: &Mesh, set: usize) -> Vec2 {
        let uvs = &mesh.uvs()[set];
        blend(each(self.vertices(mesh), |v| uvs[v]), self.weights)
    }

    /// The interpolated vertex colour, linear RGB.
    #[inline]
    pub fn color(&self, mesh: &Mesh) -> Vec3 {
        let color = |v: usize| Vec3::new(mesh.colors()[v][0], mesh.colors()[v][1], mesh.colors()[v][2]);
        blend(each(self.vertices(mesh), color), self.weights)
    }
}

/// Returns a function from an index to one of `count` points spread evenly over a mesh's area; deterministic.
///
/// # Errors
/// [`crate::Error::Invalid`] if the mesh has no area.
pub fn sample_area(mesh: &Mesh, count: usize) -> Result<impl Fn(usize) -> Point + Sync + '_> {
    sample_triangles(mesh, Triangles::Every(1), count)
}

/// The triangles of a mesh to sample.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Triangles<'a> {
    /// The triangles 0, `step`, 2 · `step` and so on; `step` at least 1.
    Every(usize),
    /// The triangles with these indices.
    These(&'a [u32]),
}

/// Like [`sample_area`], but on selected triangles only.
pub(crate) fn sample_triangles<'a>(
    mesh: &'a Mesh,
    some: Triangles<'a>,
    count: usize,
) -> Result<impl Fn(usize) -> Point + Sync + 'a> {
    /// Number of triangles that share one area sum, to save memory.
    const BLOCK: usize = 32;
    let triangles = match some {
        Triangles::Every(step) => mesh.triangles().len().div_ceil(step),
        Triangles::These(numbers) => numbers.len(),
    };
    let numbered = move |i: usize| match some {
        Triangles::Every(step) => i * step,
        Triangles::These(numbers) => numbers[i] as usize,
    };
    let areas = move |block: usize| {
        let block = block * BLOCK..((block + 1) * BLOCK).min(triangles);
        let area = move |i: usize| doubled_area(mesh, numbered(i));
        block.map(area).map(|area| if area.is_finite() { area } else { 0.0 })
    };
    // The cumulative area up to the end of each block.
    let mut sums: Vec<f64> = parallel::collect(triangles.div_ceil(BLOCK), |block| areas(block).sum());
    let mut sum = 0.0;
    for to_end in &mut sums {
        sum += *to_end;
        *to_end = sum;
    }
    if sum <= 0.0 {
        return Err(Error::invalid("the mesh", "its triangles have no area"));
    }
    let points = Sequence::new(0);
    Ok(move |i: usize| {
        // One point in each of `count` equal areas.
        let [jitter, u, v, _] = points.four(i as u32 % Sequence::MOST, (i as u32 / Sequence::MOST) * 2);
        let target = (i as f64 + f64::from(jitter)) / count as f64 * sum;
        let block = sums.partition_point(|s| *s <= target).min(sums.len() - 1);
        let mut before = if block == 0 { 0.0 } else { sums[block - 1] };
        let is_before = |area: &f64| {
            before += area;
            before <= target
        };
        let place = (block * BLOCK + areas(block).take_while(is_before).count()).min(triangles - 1);
        Point { triangle: numbered(place) as u32, weights: triangle_weights(u, v) }
    })
}

/// Barycentric weights in a triangle, uniform if (u, v) is uniform over [0, 1)².
///
/// Source: Osada et al. 2002, "Shape distributions", §4.2.
pub(crate) fn triangle_weights(u: f32, v: f32) -> [f32; 3] {
    let root = u.sqrt();
    [1.0 - root, root * (1.0 - v), root * v]
}

pub(crate) fn doubled_area(mesh: &Mesh, triangle: usize) -> f64 {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::to_f64);
    (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;

    #[test]
    fn everything_is_interpolated_with_the_same_weights() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let mesh = Mesh::new(MeshData {
            positions: vec![corner(0.0, 0.0), corner(4.0, 0.0), corner(0.0, 4.0)],
            normals: vec![Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)],
            tangents: vec![[1.0, 0.0, 0.0, -1.0], [0.0, 1.0, 0.0, -1.0], [0.0, 0.0, 1.0, -1.0]],
            uvs: vec![vec![Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)]],
            colors: vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]],
            triangles: vec![[0, 1, 2]],
        })
        .unwrap();
        let point = Point { triangle: 0, weights: [0.25, 0.25, 0.5] };
        assert_eq!(point.position(&mesh), corner(1.0, 2.0));
        assert_eq!(point.uv(&mesh, 0), Vec2::new(0.25, 0.5));
        assert_eq!(point.color(&mesh), Vec3::new(0.25, 0.25, 0.5));
        let frame = point.frame(&mesh);
        assert_eq!(frame.normal, Vec3::new(0.25, 0.5, 0.25));
        assert_eq!((frame.tangent, frame.handedness), (Vec3::new(0.25, 0.25, 0.5), -1.0));
        assert!((point.normal(&mesh).length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_normal_that_vanishes_is_that_of_the_first_corner() {
        let up = Vec3::new(0.0, 0.0, 1.0);
        let mesh = Mesh::new(MeshData {
            positions: vec![Vec3::default(); 3],
            normals: vec![up, -up, up],
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        })
        .unwrap();
        let point = Point { triangle: 0, weights: [0.25, 0.5, 0.25] };
        assert_eq!(point.normal(&mesh), up);
    }
}
