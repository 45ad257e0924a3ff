//! Triangle meshes, validated once so that later code cannot fail.

pub mod deform;
mod point;
mod repair;

pub use point::{Point, TangentFrame, sample_area};
pub(crate) use point::{Triangles, blend, doubled_area, each, sample_triangles, triangle_weights};
pub use repair::{repair, with_flat_normals};

use crate::error::{Error, Result};
use crate::math::{Mat4, Vec2, Vec3, scalar};
use crate::parallel;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// The weight of normals, as unit vectors, when simplifying meshes whose relief is only in vertex normals. Measured
/// on five scans: weights of 1 to 8 are within 7 % of its mean angle as seen, 0 has 1.4 times as much.
pub const RELIEF_OF_VERTICES: f32 = 0.5;

/// The arrays from which a [`Mesh`] is created. Optional arrays are empty if absent.
#[derive(Debug, Clone, Default)]
pub struct MeshData {
    /// Points in object space, model units.
    pub positions: Vec<Vec3>,
    /// One normal per position, unit or empty.
    pub normals: Vec<Vec3>,
    /// One tangent (x, y, z, handedness ±1) per position, or empty.
    pub tangents: Vec<[f32; 4]>,
    /// Any number of uv sets, each one pair per position; the uv origin is top left, as in glTF.
    pub uvs: Vec<Vec<Vec2>>,
    /// One linear RGBA colour per position, or empty.
    pub colors: Vec<[f32; 4]>,
    /// Counter-clockwise triangles as indices into the arrays above.
    pub triangles: Vec<[u32; 3]>,
}

/// A triangle mesh: every index is in range, every position finite, every array as long as the positions. Copies
/// share the arrays.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    data: Arc<MeshData>,
}

/// Returns the elements `which`; nothing for an absent array.
fn gather<T: Copy>(from: &[T], which: &[usize]) -> Vec<T> {
    if from.is_empty() { Vec::new() } else { which.iter().map(|i| from[*i]).collect() }
}

impl MeshData {
    /// Returns only the vertices `which`, without triangles.
    pub fn gathered(&self, which: &[usize]) -> Self {
        Self {
            positions: gather(&self.positions, which),
            normals: gather(&self.normals, which),
            tangents: gather(&self.tangents, which),
            uvs: self.uvs.iter().map(|set| gather(set, which)).collect(),
            colors: gather(&self.colors, which),
            triangles: Vec::new(),
        }
    }

    /// Checks that a mesh can be created from the data.
    ///
    /// # Errors
    /// As for [`Mesh::new`].
    pub fn check(&self) -> Result<()> {
        let count = self.positions.len();
        if count > u32::MAX as usize {
            return Err(Error::limit(format!("a mesh of {count} vertices"), "at most 2^32 - 1; split it"));
        }
        check_length("normals", self.normals.len(), count)?;
        check_length("tangents", self.tangents.len(), count)?;
        check_length("colors", self.colors.len(), count)?;
        for (set, uvs) in self.uvs.iter().enumerate() {
            if uvs.len() != count {
                return Err(length_error(&format!("uv set {set}"), uvs.len(), count));
            }
        }
        if let Some(i) = first(&self.positions, |p| !p.is_finite()) {
            return Err(Error::invalid(format!("position {i}"), "it is infinite or NaN; fix the file"));
        }
        let beyond = |index: &u32| *index as usize >= count;
        match first(&self.triangles, |t| t.iter().any(beyond)) {
            Some(i) => {
                let index = self.triangles[i].into_iter().find(beyond).unwrap_or_default();
                let what = format!("it refers to vertex {index}, but there are {count}; fix the file");
                Err(Error::invalid(format!("triangle {i}"), what))
            }
            None => Ok(()),
        }
    }
}

impl Mesh {
    /// Validates `data`.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the first invalid array, its element and the reason: an array shorter or longer than
    /// the positions, a position that is infinite or NaN, or an index out of range.
    pub fn new(data: MeshData) -> Result<Self> {
        data.check()?;
        Ok(Self { data: Arc::new(data) })
    }

    /// The positions, in object space.
    pub fn positions(&self) -> &[Vec3] {
        &self.data.positions
    }

    /// The normals; empty if there are none.
    pub fn normals(&self) -> &[Vec3] {
        &self.data.normals
    }

    /// The tangents with handedness; empty if there are none.
    pub fn tangents(&self) -> &[[f32; 4]] {
        &self.data.tangents
    }

    /// The uv sets.
    pub fn uvs(&self) -> &[Vec<Vec2>] {
        &self.data.uvs
    }

    /// The linear RGBA vertex colours; empty if there are none.
    pub fn colors(&self) -> &[[f32; 4]] {
        &self.data.colors
    }

    /// The triangles.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.data.triangles
    }

    /// Returns the triangles of several meshes as one, with normals if they all have them, and nothing else.
    ///
    /// # Errors
    /// [`Error::Limit`] for 2^32 vertices or more.
    pub fn joined<'a>(parts: impl IntoIterator<Item = &'a Self>) -> Result<Self> {
        let mut all = MeshData::default();
        for part in parts {
            let first = all.positions.len() as u32;
            all.positions.extend(part.positions());
            all.normals.extend(part.normals());
            all.triangles
                .extend(part.triangles().iter().map(|triangle| triangle.map(|v| v.wrapping_add(first))));
        }
        if all.normals.len() < all.positions.len() {
            all.normals.clear();
        }
        Self::new(all)
    }

    /// Returns the arrays of only the vertices `which`, without triangles.
    pub fn gathered(&self, which: &[usize]) -> MeshData {
        self.data.gathered(which)
    }

    /// Returns the arrays, for changing and validating them again; copied if another mesh shares them.
    pub fn into_data(self) -> MeshData {
        Arc::unwrap_or_clone(self.data)
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        let [a, b, c] = self.data.triangles[triangle];
        // Written out, since `map` over an array is a call, which takes longer than the rest of the function.
        [self.data.positions[a as usize], self.data.positions[b as usize], self.data.positions[c as usize]]
    }

    /// Returns true if the front of a triangle, from which its corners are counter-clockwise, faces `toward`.
    ///
    /// # Panics
    /// If the triangle does not exist.
    pub fn faces(&self, triangle: u32, toward: Vec3) -> bool {
        let [a, b, c] = self.corners(triangle as usize);
        (b - a).cross(c - a).dot(toward) > 0.0
    }

    /// Returns the largest coordinate of any position, without its sign; 0 if there are none.
    pub fn largest_coordinate(&self) -> f32 {
        let coordinates = self.data.positions.iter().flat_map(|p| p.to_array());
        coordinates.fold(0.0f32, |most, v| most.max(v.abs()))
    }

    /// Returns a bound of the rounding of positions and of distances from them in single precision, model units.
    pub fn rounding(&self) -> f32 {
        self.largest_coordinate() * 1e-6
    }

    /// The length of the diagonal of the bounding box of all positions; 0 if there are none.
    pub fn diagonal(&self) -> f64 {
        let positions = || self.data.positions.iter().map(|p| p.to_f64());
        let Some(first) = positions().next() else { return 0.0 };
        let pick = |of: fn(f64, f64) -> f64| {
            positions().fold(first, |a, p| Vec3::new(of(a.x, p.x), of(a.y, p.y), of(a.z, p.z)))
        };
        (pick(f64::max) - pick(f64::min)).length()
    }

    /// Returns the least and the largest y of its positions; zeros without any.
    pub fn vertical_extent(&self) -> [f32; 2] {
        let ends = |[least, most]: [f32; 2], p: &Vec3| [least.min(p.y), most.max(p.y)];
        let Some(first) = self.data.positions.first() else { return [0.0; 2] };
        self.data.positions.iter().fold([first.y; 2], ends)
    }

    /// The area of its triangles under a transform, in square world units.
    pub fn area(&self, world_from_object: &Mat4) -> f64 {
        let area = |triangle: usize| {
            let corners = self.corners(triangle);
            let [a, b, c] = corners.map(|corner| world_from_object.transform_point(corner.to_f64()));
            (b - a).cross(c - a).length() * 0.5
        };
        (0..self.data.triangles.len()).map(area).sum()
    }

    /// The number of triangles whose area is exactly zero.
    pub fn degenerate_triangles(&self) -> usize {
        parallel::count(self.data.triangles.len(), |i| {
            let [a, b, c] = self.corners(i).map(Vec3::to_f64);
            (b - a).cross(c - a).length() == 0.0
        })
    }
}

impl Mesh {
    /// A sphere around the origin, with normals and one uv set: u runs once around from +z over +x, v from the top
    /// down. Materials are shown and measured on it.
    ///
    /// `radius` above 0, in model units; `columns` at least 3 around, `rows` at least 2 from pole to pole: smaller
    /// values are raised to these. It has 2 · `columns` · (`rows` − 1) triangles.
    pub fn sphere(radius: f64, columns: usize, rows: usize) -> Self {
        let (columns, rows) = (columns.max(3), rows.max(2));
        let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
        for j in 0..=rows {
            for i in 0..=columns {
                let (u, v) = (i as f64 / columns as f64, j as f64 / rows as f64);
                let (theta, phi) = (PI * v, TAU * u);
                let ring = scalar::sin(theta);
                let n = Vec3::new(ring * scalar::sin(phi), scalar::cos(theta), ring * scalar::cos(phi));
                data.positions.push((n * radius).to_f32());
                data.normals.push(n.to_f32());
                data.uvs[0].push(Vec2::new(u as f32, v as f32));
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let at = |di: usize, dj: usize| ((j + dj) * (columns + 1) + i + di) as u32;
                let [a, b, c, d] = [at(0, 0), at(0, 1), at(1, 1), at(1, 0)];
                if j > 0 {
                    data.triangles.push([a, b, d]);
                }
                if j + 1 < rows {
                    data.triangles.push([d, b, c]);
                }
            }
        }
        Self { data: data.into() }
    }
}

/// The first invalid element.
pub fn first<T: Sync>(elements: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    parallel::first(elements.len(), |i| is_bad(&elements[i]))
}

fn check_length(name: &str, length: usize, count: usize) -> Result<()> {
    if length == 0 || length == count { Ok(()) } else { Err(length_error(name, length, count)) }
}

fn length_error(name: &str, length: usize, count: usize) -> Error {
    Error::invalid(name, format!("{length} elements for {count} positions; the counts must be equal"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_a_valid_mesh_that_faces_outwards() {
        let sphere = Mesh::sphere(2.0, 12, 7);
        assert_eq!(sphere.triangles().len(), 2 * 12 * 6);
        Mesh::new(sphere.clone().into_data()).unwrap();
        for triangle in sphere.triangles() {
            let [a, b, c] = triangle.map(|v| sphere.positions()[v as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }
}
