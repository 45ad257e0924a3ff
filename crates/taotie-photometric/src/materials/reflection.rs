//! The engine's pixel program as a model of a texel's samples, on dual numbers.

use super::sight::Incident;
use taotie_engine::math::{Dual, Number, Vec3};
use taotie_engine::pixel::{Incidence, MaterialUniforms, MaterialValues, PixelInputs};
use taotie_engine::scene::Material;
use taotie_engine::shade::{Shading, SubPixelVariance};

/// Variables of a texel: red, green and blue of the base colour, roughness, metallic.
pub const VARIABLES: usize = 5;
/// The index of the roughness.
pub const ROUGHNESS: usize = 3;
/// The index of the metallic.
pub const METALLIC: usize = 4;
/// The smallest and largest value of each variable.
pub const BOUNDS: [[f64; VARIABLES]; 2] = [[1e-4, 1e-4, 1e-4, 0.04, 0.0], [4.0, 4.0, 4.0, 1.0, 1.0]];

/// The variables of a texel.
pub type Values = [f64; VARIABLES];

/// The properties of a material that are not fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflection {
    dielectric_f0: f64,
    specular: f64,
    specular_color: [f64; 3],
}

impl Reflection {
    /// Takes those of a material.
    pub fn new(material: &Material) -> Self {
        Self {
            dielectric_f0: f64::from(MaterialUniforms::new(material).dielectric_f0),
            specular: f64::from(material.specular.factor),
            specular_color: material.specular.color.map(f64::from),
        }
    }

    /// Returns the radiance that a texel with this normal reflects to the camera, linear RGB. Normals that vary within the sample
    /// widen the lobe.
    pub fn radiance<L: Number>(
        &self,
        values: &[L; VARIABLES],
        normal: Vec3<f64>,
        light: &Incident,
    ) -> Vec3<L> {
        let zero = values[0].lit(0.0);
        let vector = |v: Vec3<f64>| v.map(|v| zero.lit(v));
        let normal = vector(normal);
        let variance = SubPixelVariance {
            curvature: zero.lit(light.variance.curvature),
            normal_variance: zero.lit(light.variance.normal_variance),
        };
        let mut inputs = PixelInputs::smooth(Shading::Ggx, normal, vector(light.v));
        inputs.uniforms.dielectric_f0 = zero.lit(self.dielectric_f0);
        inputs.values = MaterialValues {
            tint: Vec3::new(values[0], values[1], values[2]),
            metallic: values[METALLIC],
            roughness: variance.widened(values[ROUGHNESS]),
            specular: zero.lit(self.specular),
            specular_color: vector(Vec3::from_array(self.specular_color)),
            ..inputs.values
        };
        inputs.shaded(normal).lit(&Incidence { l: vector(light.l), irradiance: vector(light.irradiance) })
    }

    /// Returns the radiance with its derivatives by all variables.
    pub fn derived(
        &self,
        values: &Values,
        normal: Vec3<f64>,
        light: &Incident,
    ) -> Vec3<Dual<f64, VARIABLES>> {
        let variables = std::array::from_fn(|i| Dual::variable(values[i], i));
        self.radiance(&variables, normal, light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        let reflection = Reflection::new(&Material::default());
        let unit = |x: f64, y: f64| Vec3::new(x, y, 1.0).normalize();
        let light = Incident {
            v: unit(0.1, 0.3),
            l: unit(-0.2, 0.1),
            irradiance: Vec3::new(3.0, 2.0, 1.0),
            variance: SubPixelVariance { curvature: 2e-3, normal_variance: 1e-2 },
        };
        let values = [0.6, 0.4, 0.3, 0.35, 0.6];
        let found = reflection.derived(&values, unit(0.0, 0.1), &light);
        for variable in 0..VARIABLES {
            let moved = |by: f64| {
                let mut values = values;
                values[variable] += by;
                reflection.radiance(&values, unit(0.0, 0.1), &light)
            };
            let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            let off = Vec3::from_array(found.to_array().map(|channel| channel.partials[variable])) - slope;
            assert!(off.length() < 1e-5, "{variable}: {off:?}");
        }
    }
}
