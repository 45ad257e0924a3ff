//! The engine's pixel program as a model of a pixel's samples, on dual numbers: the formulas that render also fit.

use std::f64::consts::FRAC_1_PI;
use taotie_engine::math::{Dual, Vec3};
use taotie_engine::pixel::{Incidence, PixelInputs, ShadedPixel};
use taotie_engine::shade::Shading;

/// The highlight of a surface.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Finish {
    /// The roughness as artists set it, [0, 1].
    pub roughness: f64,
    /// Reflectance at normal incidence, [0, 1].
    pub f0: f64,
}

/// A surface: unit normal and base colour, and the highlight if it is not matt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Unit normal.
    pub normal: Vec3<f64>,
    /// Two unit vectors at right angles to it and each other.
    pub tangents: [Vec3<f64>; 2],
    /// The base colour, at least 0.
    pub color: f64,
    /// Its highlight; `None` if it is matt (Lambert).
    pub finish: Option<Finish>,
}

/// Variables of each pixel: shifts of the normal along both tangents, and the base colour.
pub const OWN: usize = 3;
/// Those, the roughness and F0.
pub const ALL: usize = 5;

/// A surface under any light, with derivatives by the first `N` variables.
pub struct Lit<const N: usize> {
    pixel: ShadedPixel<Dual<f64, N>>,
    irradiance: Vec3<Dual<f64, N>>,
}

impl Surface {
    /// Prepares the surface for light with this irradiance on a plane that faces it.
    pub fn under<const N: usize>(&self, irradiance: f64) -> Lit<N> {
        let constant = Dual::<f64, N>::constant;
        let vector = |v: Vec3<f64>| v.map(constant);
        let shift = |axis: usize| vector(self.tangents[axis]) * Dual::variable(0.0, axis);
        let normal = (vector(self.normal) + shift(0) + shift(1)).normalize();
        let (zero, one) = (constant(0.0), constant(1.0));
        let finish = self.finish.unwrap_or(Finish { roughness: 1.0, f0: 0.0 });
        let shading = if self.finish.is_some() { Shading::Ggx } else { Shading::Lambert };
        let mut inputs = PixelInputs::smooth(shading, normal, Vec3::new(zero, zero, one));
        inputs.uniforms.base_color = Vec3::splat(Dual::variable(self.color, 2));
        inputs.uniforms.f0 = Some(Vec3::splat(Dual::variable(finish.f0, 4)));
        inputs.values.roughness = Dual::variable(finish.roughness, 3);
        Lit { pixel: inputs.shaded(normal), irradiance: Vec3::splat(constant(irradiance)) }
    }
}

impl<const N: usize> Lit<N> {
    /// Returns the sample under a light in direction `l` (unit), with its derivatives.
    #[inline]
    pub fn sample(&self, l: Vec3<f64>) -> Dual<f64, N> {
        self.pixel.lit(&Incidence { l: l.map(Dual::constant), irradiance: self.irradiance }).x
    }

    /// Returns the diffuse part of a sample divided by n · l.
    pub fn diffuse(&self) -> f64 {
        let sample = &self.pixel.point.material.sample;
        let kept = sample.compensation.map_or(1.0, |compensation| compensation.transmitted.value);
        kept * sample.base_color.x.value * self.irradiance.x.value * FRAC_1_PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::tangents;

    fn surface(normal: Vec3<f64>, finish: Option<Finish>) -> Surface {
        Surface { normal, tangents: tangents(normal), color: 0.4, finish }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let normal = Vec3::new(0.3, -0.2, 1.0).normalize();
        let l = Vec3::new(-0.2, 0.4, 1.0).normalize();
        let finish = Finish { roughness: 0.4, f0: 0.06 };
        let here = surface(normal, Some(finish));
        let found = here.under::<ALL>(3.0).sample(l);
        let step = 1e-6;
        let moved = |variable: usize, by: f64| {
            let mut surface = here;
            let mut finish = finish;
            match variable {
                0 | 1 => surface.normal = (normal + here.tangents[variable] * by).normalize(),
                2 => surface.color += by,
                3 => finish.roughness += by,
                _ => finish.f0 += by,
            }
            Surface { finish: Some(finish), ..surface }.under::<OWN>(3.0).sample(l).value
        };
        for variable in 0..ALL {
            let slope = (moved(variable, step) - moved(variable, -step)) / (2.0 * step);
            assert!((found.partials[variable] - slope).abs() < 1e-5, "{variable}: {found:?} {slope}");
        }
    }

    #[test]
    fn a_matt_surface_is_linear_in_normal_and_colour() {
        let normal = Vec3::new(0.3, -0.2, 1.0).normalize();
        let l = Vec3::new(-0.2, 0.4, 1.0).normalize();
        let lit = surface(normal, None).under::<OWN>(3.0);
        assert!((lit.sample(l).value - lit.diffuse() * normal.dot(l)).abs() < 1e-12);
        assert!((lit.diffuse() - 0.4 * 3.0 * FRAC_1_PI).abs() < 1e-12);
    }
}
