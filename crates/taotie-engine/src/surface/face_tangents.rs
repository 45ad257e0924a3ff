//! The tangents that each triangle gives its corners independently: the derivatives of position by uv, made
//! perpendicular to the corners' normals.

use super::normals;
use super::weld::{Classes, bits, by_position};
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use crate::mesh::Mesh;

/// The derivatives of position by uv over a triangle, in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvDerivatives {
    /// ∂p/∂u, in the plane of the triangle.
    pub dp_du: Vec3,
    /// ∂p/∂v, in the plane of the triangle. With the uv origin top left it points *down* the image.
    pub dp_dv: Vec3,
    /// The `w` of glTF's TANGENT: +1 if b = cross(n, t) points up the image, −1 if the uvs are mirrored.
    pub handedness: f32,
}

/// Solves the two edge equations e_i = Δu_i ∂p/∂u + Δv_i ∂p/∂v of a triangle; the uv origin is top left.
///
/// `None` if the uvs span no area: if the sine of the angle between the uv edges is below 1e-6, or a uv or the result
/// is infinite or NaN. The sign of the determinant is kept, since it indicates mirrored uvs.
pub fn uv_derivatives(corners: [Vec3; 3], uvs: [Vec2; 3]) -> Option<UvDerivatives> {
    let [a, b, c] = corners.map(Vec3::to_f64);
    let (e1, e2) = (b - a, c - a);
    let [(u1, v1), (u2, v2)] = uv_edges(uvs);
    let det = uv_determinant(uvs)?;
    let dp_du = ((e1 * v2 - e2 * v1) / det).to_f32();
    let dp_dv = ((e2 * u1 - e1 * u2) / det).to_f32();
    let handedness = if det < 0.0 { 1.0 } else { -1.0 };
    (dp_du.is_finite() && dp_dv.is_finite()).then_some(UvDerivatives { dp_du, dp_dv, handedness })
}

/// Twice the signed uv area, negative if the image is not mirrored (v points down); `None` without an area.
pub(super) fn uv_determinant(uvs: [Vec2; 3]) -> Option<f64> {
    const SMALLEST_SINE: f64 = 1e-6;
    let [(u1, v1), (u2, v2)] = uv_edges(uvs);
    let det = u1 * v2 - u2 * v1;
    let lengths = ((u1 * u1 + v1 * v1) * (u2 * u2 + v2 * v2)).sqrt();
    (det.abs() > SMALLEST_SINE * lengths && det.is_finite()).then_some(det)
}

fn uv_edges([a, b, c]: [Vec2; 3]) -> [(f64, f64); 2] {
    let edge = |to: Vec2| (f64::from(to.x) - f64::from(a.x), f64::from(to.y) - f64::from(a.y));
    [edge(b), edge(c)]
}

/// The unit part of `tangent` perpendicular to the unit normal; `None` if they are parallel or it is zero.
fn gram_schmidt(n: Vec3<f64>, tangent: Vec3<f64>) -> Option<Vec3<f64>> {
    let length = tangent.length();
    let t = tangent / length;
    let t = t - n * n.dot(t);
    let rest = t.length();
    (length > 0.0 && rest > 1e-6).then(|| t / rest)
}

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

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];

    #[test]
    fn derivatives_of_an_upright_picture() {
        let uvs = [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 0.0)];
        let d = uv_derivatives(CORNERS, uvs).unwrap();
        assert_eq!(d.dp_du, Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(d.dp_dv, Vec3::new(0.0, -3.0, 0.0));
        assert_eq!(d.handedness, 1.0);
        let mirrored = uvs.map(|uv| Vec2::new(1.0 - uv.x, uv.y));
        assert_eq!(uv_derivatives(CORNERS, mirrored).unwrap().handedness, -1.0);
    }

    #[test]
    fn uvs_without_area_have_no_derivatives() {
        let line = [Vec2::new(0.0, 0.0), Vec2::new(0.1, 0.1), Vec2::new(0.3, 0.3)];
        assert!(uv_derivatives(CORNERS, line).is_none());
        assert!(uv_derivatives(CORNERS, [Vec2::new(0.5, 0.5); 3]).is_none());
        assert!(uv_derivatives(CORNERS, [line[0], Vec2::new(f32::NAN, 0.0), Vec2::new(1.0, 1.0)]).is_none());
    }
}
