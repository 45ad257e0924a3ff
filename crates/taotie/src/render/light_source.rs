//! Lights made ready for shading.

use super::columns::splat3;
use crate::math::{Pack, Vec3, scalar};
use crate::scene::{Falloff, Light, LightKind};
use crate::shade::lights;

/// A light made ready for shading.
#[derive(Debug, Clone, Copy)]
pub(super) struct LightSource {
    color: Vec3,
    /// The position, or for directional lights the unit direction to the light.
    place: Vec3,
    at_infinity: bool,
    falloff: Falloff,
    /// Axis of the cone and the cosines of its angles.
    cone: Option<(Vec3, f32, f32)>,
}

impl LightSource {
    pub(super) fn new(light: &Light) -> Self {
        let (place, at_infinity, cone) = match light.kind {
            LightKind::Point { position } => (position, false, None),
            LightKind::Directional { direction } => (-direction, true, None),
            LightKind::Spot { position, direction, inner, outer } => {
                // In the 32 bits that files hold, so that an angle and its decimals are one light.
                let cos = |angle: f64| scalar::cos(f64::from(angle as f32)) as f32;
                (position, false, Some((direction, cos(inner), cos(outer))))
            }
        };
        Self { color: light.color, place, at_infinity, falloff: light.falloff, cone }
    }

    /// Returns the vector from a point to the light; not normalised.
    pub(super) fn ray_from(&self, point: Vec3) -> Vec3 {
        if self.at_infinity { self.place } else { self.place - point }
    }

    /// The limit of a shadow ray along [`Self::ray_from`], in its lengths.
    pub(super) fn ray_limit(&self) -> f32 {
        if self.at_infinity { f32::INFINITY } else { 1.0 }
    }

    /// The unit direction to the light and the irradiance on a plane that faces it.
    #[inline(always)]
    pub(super) fn incidence<P: Pack>(&self, token: P::Token, position: Vec3<P>) -> (Vec3<P>, Vec3<P>) {
        let color = splat3(token, self.color);
        let place = splat3(token, self.place);
        if self.at_infinity {
            return (place, color);
        }
        let to_light = place - position;
        let distance_squared = to_light.dot(to_light).max(P::splat(token, 1e-12));
        let distance = distance_squared.sqrt();
        let l = to_light * (P::splat(token, 1.0) / distance);
        let mut attenuation = match self.falloff {
            Falloff::None => P::splat(token, 1.0),
            Falloff::InverseSquare => lights::inverse_square(distance_squared),
            Falloff::Windowed(range) => {
                lights::inverse_square(distance_squared)
                    * lights::range_window(distance_squared, P::splat(token, range))
            }
        };
        if let Some((axis, cos_inner, cos_outer)) = self.cone {
            let cos = -splat3(token, axis).dot(l);
            let (inner, outer) = (P::splat(token, cos_inner), P::splat(token, cos_outer));
            attenuation = attenuation * lights::spot_cone(cos, inner, outer);
        }
        (l, color * attenuation)
    }
}
