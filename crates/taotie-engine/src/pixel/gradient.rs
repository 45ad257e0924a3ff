//! The derivatives of a pixel's radiance, by running the whole pixel program on dual numbers.

use super::light::Incidence;
use super::program::{IncidentLight, PixelInputs};
use crate::math::{Dual, Number, Vec3};
use crate::surface::SurfaceMethod;
use std::array::from_fn;

/// Radiance with its derivatives.
///
/// The derivative with respect to a number is the change of the radiance, linear RGB, per unit of that number; with
/// respect to a vector or colour there are three, in the order x, y, z or red, green, blue. Vectors vary freely, not
/// only on the sphere, so the effect of a change of length is included.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient<L> {
    /// Radiance to the viewer, linear RGB.
    pub radiance: Vec3<L>,
    /// By [`MaterialValues::roughness`](super::MaterialValues::roughness).
    pub roughness: Vec3<L>,
    /// By the factor [`MaterialUniforms::base_color`](super::MaterialUniforms::base_color).
    pub base_color: [Vec3<L>; 3],
    /// By the authored F0, or, if there is none, by that of the dielectric part, which is `dielectric_f0` times
    /// [`MaterialValues::specular_color`](super::MaterialValues::specular_color).
    pub f0: [Vec3<L>; 3],
    /// By the interpolated normal; for [`SurfaceMethod::Facet`] by the facet's.
    pub normal: [Vec3<L>; 3],
    /// By the shading normal before it is turned to the visible side: [`PixelInputs::front_normal`].
    pub shading_normal: [Vec3<L>; 3],
    /// By the direction to each light, [`Incidence::l`](super::Incidence::l).
    pub lights: Vec<[Vec3<L>; 3]>,
}

/// The variables, in their order.
const ROUGHNESS: usize = 0;
const BASE_COLOR: usize = 1;
const F0: usize = 4;
const NORMAL: usize = 7;
const SHADING_NORMAL: usize = 10;
const LIGHT: usize = 13;
const ALL: usize = 16;

/// A number with its derivatives by all variables.
type Derived<L> = Dual<L, ALL>;

/// The variables numbered from `first`.
fn variables<L: Number>(values: Vec3<L>, first: usize) -> Vec3<Derived<L>> {
    let [x, y, z] = values.to_array();
    Vec3::new(Dual::variable(x, first), Dual::variable(y, first + 1), Dual::variable(z, first + 2))
}

/// The derivatives of a colour with respect to a variable.
fn partial<L: Number>(color: &Vec3<Derived<L>>, variable: usize) -> Vec3<L> {
    color.map(|channel| channel.partials[variable])
}

/// The derivatives of a colour with respect to three variables.
fn partials<L: Number>(color: &Vec3<Derived<L>>, first: usize) -> [Vec3<L>; 3] {
    from_fn(|i| partial(color, first + i))
}

impl<L: Number> PixelInputs<L> {
    /// Returns the radiance with its derivatives, exact except for rounding. At kinks, such as the nodes of a table, they
    /// are one-sided.
    ///
    /// ```
    /// use taotie_engine::math::Vec3;
    /// use taotie_engine::pixel::{Incidence, IncidentLight, PixelInputs};
    /// use taotie_engine::shade::Shading;
    ///
    /// let up = Vec3::new(0.0, 0.0, 1.0);
    /// let mut pixel = PixelInputs::smooth(Shading::Ggx, up, up);
    /// pixel.values.roughness = 0.5;
    /// let light = Incidence { l: Vec3::new(0.6, 0.0, 0.8), irradiance: Vec3::splat(3.0) };
    /// let light = IncidentLight { arriving: vec![light], ambient: Vec3::splat(0.0), environment: None };
    /// let gradient = pixel.gradient(&light);
    /// assert_eq!(gradient.radiance, pixel.radiance(&light));
    /// // A redder base reflects more red light, and no more blue light.
    /// assert!(gradient.base_color[0].x > 0.0 && gradient.base_color[0].z == 0.0);
    /// // The surface gets brighter as its normal turns towards the half vector.
    /// assert!(gradient.shading_normal[0].x > 0.0);
    /// ```
    pub fn gradient(&self, light: &IncidentLight<'_, L>) -> Gradient<L> {
        let inputs = self.with_variables();
        let origin = Vec3::splat(self.values.roughness.lit(0.0));
        let front = inputs.front_normal() + variables(origin, SHADING_NORMAL);
        let pixel = inputs.shaded(front);
        let light = light.map(Dual::constant);
        let mut radiance = pixel.without_lights(&light);
        let lights = light.arriving.iter().map(|arriving| {
            let l = variables(arriving.l.map(|component| component.value), LIGHT);
            let lit = pixel.lit(&Incidence { l, ..*arriving });
            radiance += lit;
            partials(&lit, LIGHT)
        });
        let lights = lights.collect();
        Gradient { lights, ..Gradient::of(&radiance) }
    }

    /// Converts the inputs to dual numbers, with the variables marked.
    fn with_variables(&self) -> PixelInputs<Derived<L>> {
        let mut inputs = self.map(Dual::constant);
        let one = Dual::constant(self.values.roughness.lit(1.0));
        inputs.values.roughness = Dual::variable(self.values.roughness, ROUGHNESS);
        inputs.uniforms.base_color = variables(self.uniforms.base_color, BASE_COLOR);
        match self.uniforms.f0 {
            Some(f0) => inputs.uniforms.f0 = Some(variables(f0, F0)),
            None => {
                let f0 = self.values.specular_color * self.uniforms.dielectric_f0;
                inputs.values.specular_color = variables(f0, F0);
                inputs.uniforms.dielectric_f0 = one;
            }
        }
        match self.method {
            SurfaceMethod::Facet => inputs.geometry.n_geom = variables(self.geometry.n_geom, NORMAL),
            _ => inputs.geometry.normal = variables(self.geometry.normal, NORMAL),
        }
        inputs
    }
}

impl<L: Number> Gradient<L> {
    /// Collects the derivatives, except those with respect to lights.
    fn of(radiance: &Vec3<Derived<L>>) -> Self {
        Self {
            radiance: radiance.map(|channel| channel.value),
            roughness: partial(radiance, ROUGHNESS),
            base_color: partials(radiance, BASE_COLOR),
            f0: partials(radiance, F0),
            normal: partials(radiance, NORMAL),
            shading_normal: partials(radiance, SHADING_NORMAL),
            lights: Vec::new(),
        }
    }
}
