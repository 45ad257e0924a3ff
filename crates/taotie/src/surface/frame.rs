//! The frame spanned by uvs on a triangle.

use crate::math::{Vec2, Vec3};

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
pub(super) fn gram_schmidt(n: Vec3<f64>, tangent: Vec3<f64>) -> Option<Vec3<f64>> {
    let length = tangent.length();
    let t = tangent / length;
    let t = t - n * n.dot(t);
    let rest = t.length();
    (length > 0.0 && rest > 1e-6).then(|| t / rest)
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
