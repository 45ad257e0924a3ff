//! Reflectance, the light that a surface reflects to the viewer: pure functions of numbers, each formula written once
//! over [`Lane`].
//!
//! [`fresnel`] and [`microfacets`] are the parts, free to combine; [`reflect`] evaluates the named models of
//! [`Shading`], and [`furnace`] integrates their reflection. Nothing here depends on a scene: the caller samples
//! textures into a [`MaterialSample`], creates [`Angles`] from its directions and multiplies the result by the
//! irradiance, for which [`lights`] has the formulas.

mod layers;
mod models;
mod relief;

pub mod dfg;
pub mod environment;
pub mod fresnel;
pub mod furnace;
pub mod microfacets;
pub mod sampling;

pub(crate) use layers::COAT_F0;
pub use layers::{AnisotropicLobe, coat_fresnel, coat_lobe};
pub use models::{
    Compensation, Energy, EnvironmentWeights, MaterialSample, Shading, compensation, environment_weights,
    reflect, reflect_anisotropic, specular_occlusion,
};
pub use relief::{Facets, SubPixelVariance, curvature_variance};

use crate::math::{Lane, Mask, Vec3};

/// Sheen, the reflection of fibres perpendicular to a surface, as of velvet.
pub mod sheen {
    pub use super::layers::{d_charlie, v_neubelt};
}

/// The smallest n·v passed to formulas: a perturbed or interpolated normal may face away from a viewer who still sees
/// the triangle, and several models divide by n·v.
const MIN_N_DOT_V: f64 = 1e-4;

/// |l + v|² below which the half vector has no direction: the light is behind the point as seen by the viewer.
const MIN_HALF_SQUARED: f64 = 1e-12;

/// Cosines between the normal n, the viewer v, the light l, the half vector h = (l + v)/|l + v| and the mirrored
/// light r = 2(n·l)n − l. Symmetric in v and l except for `n_dot_v`, which is clamped, and `r_dot_v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angles<L> {
    /// n·l, [−1, 1]; models are black unless it is above 0.
    pub n_dot_l: L,
    /// n·v, clamped to [1e-4, 1].
    pub n_dot_v: L,
    /// n·h, [0, 1].
    pub n_dot_h: L,
    /// sin² of the angle between n and h, [0, 1], from |n × h|²: near a highlight, where n·h is 1 up to a few
    /// rounding errors, 1 − (n·h)² has no correct digit in `f32`, while this is fully accurate.
    pub sin2_h: L,
    /// v·h = l·h, [5e-7, 1].
    pub v_dot_h: L,
    /// r·v, [−1, 1].
    pub r_dot_v: L,
}

impl<L: Lane> Angles<L> {
    /// The cosines of unit vectors `n`, `v` (to the viewer) and `l` (to the light).
    ///
    /// For v = −l, h has no direction; n·h is then 0, so that no model shows a highlight, and v·h is 5e-7.
    #[inline(always)]
    pub fn new(n: Vec3<L>, v: Vec3<L>, l: Vec3<L>) -> Self {
        let n_dot_l = n.dot(l).clamp(-1.0, 1.0);
        let n_dot_v = n.dot(v).clamp(-1.0, 1.0);
        let sum = l + v;
        let squared = sum.dot(sum);
        let kept = squared.max(squared.lit(MIN_HALF_SQUARED));
        let length = kept.sqrt();
        let cross = n.cross(sum);
        // Facets that face away or have no direction: the normal and h count as perpendicular.
        let towards = n.dot(sum);
        let hidden = towards.le(squared.lit(0.0)).or(squared.lt(kept));
        let sin2_h = (cross.dot(cross) / kept).clamp(0.0, 1.0);
        Self {
            n_dot_l,
            n_dot_v: n_dot_v.clamp(MIN_N_DOT_V, 1.0),
            n_dot_h: L::select(hidden, squared.lit(0.0), (towards / length).clamp(0.0, 1.0)),
            sin2_h: L::select(hidden, squared.lit(1.0), sin2_h),
            v_dot_h: (length * length.lit(0.5)).clamp(0.0, 1.0),
            r_dot_v: (n_dot_l * n_dot_v * n_dot_l.lit(2.0) - l.dot(v)).clamp(-1.0, 1.0),
        }
    }
}

/// The strength of incident light: distance and cone.
pub mod lights {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: Vec3<f64> = Vec3::new(0.0, 0.0, 1.0);

    #[test]
    fn mirror_directions_put_the_half_vector_on_the_normal() {
        let a = Angles::new(N, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.6, 0.0, 0.8));
        assert!((a.n_dot_h - 1.0).abs() < 1e-15 && a.sin2_h < 1e-30);
        assert!((a.v_dot_h - 0.8).abs() < 1e-15 && (a.r_dot_v - 1.0).abs() < 1e-15);
    }

    #[test]
    fn opposite_directions_give_no_nan() {
        let v = Vec3::new(0.6, 0.0, -0.8);
        let a = Angles::new(N, v, -v);
        assert_eq!((a.n_dot_h, a.sin2_h, a.n_dot_v), (0.0, 1.0, 1e-4));
        assert!(a.v_dot_h > 0.0 && a.v_dot_h < 1e-6);
    }

    #[test]
    fn sine_keeps_its_digits_near_the_highlight() {
        let tilt = 1e-4_f64;
        let length = (1.0 + tilt * tilt).sqrt();
        let v = Vec3::new(tilt / length, 0.0, 1.0 / length);
        let exact = Angles::new(N, v, v).sin2_h;
        let single = Angles::new(N.to_f32(), v.to_f32(), v.to_f32()).sin2_h;
        assert!((f64::from(single) / exact - 1.0).abs() < 1e-6);
    }
}
