//! The strength of incident light: distance and cone.

use crate::math::Lane;

/// The smallest squared distance, so that a point light on the surface itself stays finite.
const MIN_DISTANCE_SQUARED: f64 = 1e-12;

/// The smallest difference of cosines between inner and outer cone, so that equal cones are a hard edge.
const MIN_CONE: f64 = 1e-3;

/// The falloff of a point light.
///
/// E = I · 1/d²
///
/// `distance_squared` d² at least 0, in squared model units, taken as at least 1e-12.
#[inline(always)]
pub fn inverse_square<L: Lane>(distance_squared: L) -> L {
    let least = distance_squared.lit(MIN_DISTANCE_SQUARED);
    least.lit(1.0) / distance_squared.max(least)
}

/// The window that fades a light to zero at its range; multiplies [`inverse_square`].
///
/// w = max(min(1 − (d/range)⁴, 1), 0)
///
/// `distance_squared` d² at least 0, in squared model units; `range` above 0, in model units.
/// Law: 1 at d = 0, 0 from the range onwards, decreasing between (`laws::shade::light_falloff`).
/// Source: glTF extension KHR_lights_punctual, "Range Property".
#[inline(always)]
pub fn range_window<L: Lane>(distance_squared: L, range: L) -> L {
    let ratio2 = distance_squared / (range * range);
    (ratio2.lit(1.0) - ratio2 * ratio2).clamp(0.0, 1.0)
}

/// The fraction of a spot light's intensity at an angle to its axis.
///
/// a = clamp((cos θ − cos outer) / max(10⁻³, cos inner − cos outer), 0, 1), squared
///
/// `cos_angle` between the axis and the direction from the light to the point, [−1, 1]; `cos_inner` ≥ `cos_outer`,
/// the cosines of the angles from the axis where the light begins to fade and ends.
/// Law: 1 inside the inner cone, 0 outside the outer, decreasing between (`laws::shade::light_falloff`).
/// Source: glTF extension KHR_lights_punctual, "Inner and Outer Cone Angles": the reference code squares.
#[inline(always)]
pub fn spot_cone<L: Lane>(cos_angle: L, cos_inner: L, cos_outer: L) -> L {
    let width = (cos_inner - cos_outer).max(cos_inner.lit(MIN_CONE));
    ((cos_angle - cos_outer) / width).clamp(0.0, 1.0).squared()
}
