//! The corners of triangles, and the tangents that each triangle gives them independently.

use super::frame::{gram_schmidt, uv_derivatives};
use super::normals;
use super::weld::{Classes, bits, by_position};
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use crate::mesh::Mesh;

/// A tangent (x, y, z, handedness) at each corner of a triangle, if one was found.
pub(super) type CornerTangents = [Option<[f32; 4]>; 3];

/// The corners of a mesh's triangles, with usable normals and uvs.
pub(super) struct Corners<'a> {
    mesh: &'a Mesh,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
}

impl<'a> Corners<'a> {
    /// Replaces unusable normals and uvs.
    ///
    /// # Errors
    /// As for [`super::with_tangents`].
    pub fn new(mesh: &'a Mesh, uv_set: usize) -> Result<Self> {
        if mesh.normals().is_empty() && !mesh.positions().is_empty() {
            return Err(Error::invalid("tangents", "the mesh has no normals; compute vertex normals first"));
        }
        if mesh.triangles().len() > (u32::MAX / 3) as usize {
            return Err(Error::limit("a mesh of 2^32 / 3 triangles for tangents", "split it"));
        }
        let uvs = mesh.uvs().get(uv_set).ok_or_else(|| {
            let count = mesh.uvs().len();
            Error::invalid(format!("uv set {uv_set} for tangents"), format!("the mesh has {count}"))
        })?;
        let normals = mesh.normals().iter().map(|n| usable_normal(*n)).collect();
        Ok(Self { mesh, normals, uvs: uvs.iter().map(|uv| usable_uv(*uv)).collect() })
    }

    /// The number of triangles.
    pub fn len(&self) -> usize {
        self.mesh.triangles().len()
    }

    /// The vertices of a triangle.
    pub fn triangle(&self, t: usize) -> [usize; 3] {
        self.mesh.triangles()[t].map(|v| v as usize)
    }

    /// The positions of a triangle's corners.
    pub fn positions(&self, t: usize) -> [Vec3; 3] {
        self.mesh.corners(t)
    }

    /// The unit normals of a triangle's corners.
    pub fn normals(&self, t: usize) -> [Vec3; 3] {
        self.triangle(t).map(|v| self.normals[v])
    }

    /// The finite uvs of a triangle's corners.
    pub fn uvs(&self, t: usize) -> [Vec2; 3] {
        self.triangle(t).map(|v| self.uvs[v])
    }

    /// The classes of equal positions, one class per vertex.
    pub fn places(&self) -> Classes {
        by_position(self.mesh.positions())
    }

    /// The classes of vertices that share a tangent: equal in position, normal and uv.
    pub fn shared(&self, places: &Classes) -> Classes {
        places
            .split_by(|v| bits(self.normals[v].to_array()))
            .split_by(|v| bits([self.uvs[v].x, self.uvs[v].y]))
    }
}

/// `n` if it is unit to a thousandth, else its unit vector, else the fallback.
fn usable_normal(n: Vec3) -> Vec3 {
    let squared = n.dot(n);
    if (squared - 1.0).abs() < 1e-3 {
        return n;
    }
    let wide = n.to_f64();
    let unit = (wide / wide.length()).to_f32();
    if unit.is_finite() { unit } else { normals::FALLBACK }
}

fn usable_uv(uv: Vec2) -> Vec2 {
    if uv.x.is_finite() && uv.y.is_finite() { uv } else { Vec2::new(0.0, 0.0) }
}

/// ∂p/∂u of triangle `t`, at each of its corners.
pub(super) fn face_tangent(corners: &Corners, t: usize) -> CornerTangents {
    match uv_derivatives(corners.positions(t), corners.uvs(t)) {
        Some(d) => corners.normals(t).map(|n| tangent_at(n, d.dp_du.to_f64(), d.handedness)),
        None => [None; 3],
    }
}

/// `tangent` made perpendicular to `n`.
pub(super) fn tangent_at(n: Vec3, tangent: Vec3<f64>, handedness: f32) -> Option<[f32; 4]> {
    gram_schmidt(n.to_f64(), tangent).map(|t| with_handedness(t, handedness))
}

/// The tangent in stored form.
pub(super) fn with_handedness(t: Vec3<f64>, handedness: f32) -> [f32; 4] {
    let t = t.to_f32();
    [t.x, t.y, t.z, handedness]
}
