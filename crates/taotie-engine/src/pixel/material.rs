//! The material at a point: the meaning of its texels, its sample in the terms of every model, and the parts of a
//! surface that each reflectance model supports.

use crate::math::{Lane, Vec3, scalar};
use crate::scene::{Anisotropy, Material};
use crate::shade::dfg::Dfg;
use crate::shade::{self, MaterialSample, Shading, fresnel, microfacets};

/// The smallest α from which shininess and slope are derived.
const LEAST_ALPHA: f64 = 0.02;

/// The factors of a material, the same at all points. A factor that is `None` is not authored and follows from the
/// metallic-roughness values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialUniforms<L> {
    /// Multiplies [`MaterialValues::tint`], linear RGB.
    pub base_color: Vec3<L>,
    /// Reflectance at normal incidence, linear RGB.
    pub f0: Option<Vec3<L>>,
    /// Reflectance at 82°, linear RGB.
    pub f82: Option<Vec3<L>>,
    /// F0 of the dielectric part, ((η − 1)/(η + 1))²; 1 for the index 0, which means total reflection.
    pub dielectric_f0: L,
    /// k_a, linear RGB; multiplies the tint.
    pub ambient: Option<Vec3<L>>,
    /// k_d, linear RGB; multiplies the tint.
    pub diffuse: Option<Vec3<L>>,
    /// k_s, linear RGB.
    pub specular: Option<Vec3<L>>,
    /// Beckmann's rms slope, above 0.
    pub slope: Option<L>,
    /// Phong and Blinn-Phong exponent, at least 0.
    pub shininess: Option<L>,
}

impl MaterialUniforms<f32> {
    /// Returns the factors of a scene's material.
    pub fn new(material: &Material) -> Self {
        let [r, g, b, _] = material.base_color;
        let ratio = (material.ior - 1.0) / (material.ior + 1.0);
        let classic = &material.classic;
        Self {
            base_color: Vec3::new(r, g, b),
            f0: material.f0.map(Vec3::from_array),
            f82: material.f82.map(Vec3::from_array),
            dielectric_f0: ratio * ratio,
            ambient: classic.ambient.map(Vec3::from_array),
            diffuse: classic.diffuse.map(Vec3::from_array),
            specular: classic.specular.map(Vec3::from_array),
            slope: classic.slope,
            shininess: classic.shininess,
        }
    }
}

impl<N: Copy> MaterialUniforms<N> {
    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> MaterialUniforms<L> {
        let vector = |vector: Vec3<N>| vector.map(&f);
        MaterialUniforms {
            base_color: vector(self.base_color),
            f0: self.f0.map(vector),
            f82: self.f82.map(vector),
            dielectric_f0: f(self.dielectric_f0),
            ambient: self.ambient.map(vector),
            diffuse: self.diffuse.map(vector),
            specular: self.specular.map(vector),
            slope: self.slope.map(&f),
            shininess: self.shininess.map(&f),
        }
    }
}

/// The values of a material at a point: textures and vertex colours with their factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialValues<L> {
    /// Base colour texture times vertex colour, linear RGB.
    pub tint: Vec3<L>,
    /// [0, 1].
    pub metallic: L,
    /// The roughness as artists set it, widened by detail within the pixel, [0, 1].
    pub roughness: L,
    /// The strength of a dielectric's reflection, [0, 1].
    pub specular: L,
    /// Multiplies the dielectric's F0, linear RGB, at least 0.
    pub specular_color: Vec3<L>,
    /// The unoccluded share of the hemisphere, [0, 1].
    pub occlusion: L,
    /// Emitted radiance, linear RGB.
    pub emissive: Vec3<L>,
    /// The variance of normals within the pixel: [`shade::SubPixelVariance::variance`].
    pub variance: L,
}

impl<L: Lane> MaterialUniforms<L> {
    /// Returns the factors of white material with the index of refraction 1.5, from any number.
    pub fn white(like: L) -> Self {
        Self {
            base_color: Vec3::splat(like.lit(1.0)),
            f0: None,
            f82: None,
            dielectric_f0: like.lit(0.04),
            ambient: None,
            diffuse: None,
            specular: None,
            slope: None,
            shininess: None,
        }
    }
}

impl<L: Lane> MaterialValues<L> {
    /// Returns the values of a rough dielectric without texture, light or occlusion, from any number.
    pub fn rough(like: L) -> Self {
        let (zero, one) = (like.lit(0.0), like.lit(1.0));
        Self {
            tint: Vec3::splat(one),
            metallic: zero,
            roughness: one,
            specular: one,
            specular_color: Vec3::splat(one),
            occlusion: one,
            emissive: Vec3::splat(zero),
            variance: zero,
        }
    }
}

impl<N: Copy> MaterialValues<N> {
    /// Converts the numbers.
    #[inline(always)]
    pub fn map<L>(&self, f: impl Fn(N) -> L) -> MaterialValues<L> {
        MaterialValues {
            tint: self.tint.map(&f),
            metallic: f(self.metallic),
            roughness: f(self.roughness),
            specular: f(self.specular),
            specular_color: self.specular_color.map(&f),
            occlusion: f(self.occlusion),
            emissive: self.emissive.map(&f),
            variance: f(self.variance),
        }
    }
}

/// The material at a point, in the terms of every model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialPoint<L> {
    /// The parameters of reflectance.
    pub sample: MaterialSample<L>,
    /// k_a, linear RGB.
    pub ambient: Vec3<L>,
    /// Emitted radiance, linear RGB.
    pub emissive: Vec3<L>,
    /// The unoccluded share of the hemisphere, [0, 1].
    pub occlusion: L,
}

impl<L: Lane> MaterialPoint<L> {
    /// Combines factors and values. `dfg`, the directional albedos of the lobe, adds multiple scattering, if the model
    /// supports it.
    #[inline(always)]
    pub fn new(
        shading: Shading,
        uniforms: &MaterialUniforms<L>,
        values: &MaterialValues<L>,
        dfg: Option<Dfg<L>>,
    ) -> Self {
        let MaterialValues { tint, metallic, roughness, .. } = *values;
        let one = metallic.lit(1.0);
        let base_color = tint.mul_elements(uniforms.base_color);
        let (f0, f90) = match uniforms.f0 {
            Some(f0) => (f0, one),
            None => normal_and_grazing(uniforms, values, base_color),
        };
        let f82_drop = match uniforms.f82 {
            Some(f82) => fresnel::f82_drop(f0, f82),
            None => Vec3::splat(one.lit(0.0)),
        };
        let diffuse = match uniforms.diffuse {
            Some(diffuse) => diffuse.mul_elements(tint),
            None => base_color * (one - metallic),
        };
        let specular = match uniforms.specular {
            Some(specular) => specular,
            None if takes_fresnel(shading) => Vec3::splat(one),
            None => f0,
        };
        let (slope, shininess) = classic_widths(uniforms, values);
        let ambient = match uniforms.ambient {
            Some(ambient) => ambient.mul_elements(tint),
            None => diffuse + f0,
        };
        let dfg = dfg.filter(|_| takes_compensation(shading));
        let compensation = dfg.map(|dfg| shade::compensation(&dfg, f0, f90, f82_drop));
        let sample = MaterialSample {
            base_color,
            metallic,
            roughness,
            f0,
            f90,
            f82_drop,
            diffuse,
            specular,
            shininess,
            slope,
            compensation,
        };
        Self { sample, ambient, emissive: values.emissive, occlusion: values.occlusion }
    }

    /// Returns the point of a thin surface that lets this share of the light pass instead of scattering it.
    ///
    /// Source: KHR_materials_transmission.
    #[inline(always)]
    pub fn transmitting(self, shading: Shading, transmission: L) -> Self {
        let one = transmission.lit(1.0);
        let kept = one - transmission;
        let MaterialSample { base_color, diffuse, metallic, .. } = self.sample;
        // Models scatter by one of them. Metals let nothing pass, but scatter in two models.
        let kept_base = match shading {
            Shading::Lambert | Shading::GgxPrinted => one - transmission * (one - metallic),
            _ => kept,
        };
        let sample =
            MaterialSample { base_color: base_color * kept_base, diffuse: diffuse * kept, ..self.sample };
        // The ambient colour may be authored without a diffuse part.
        let ambient = (self.ambient - diffuse * transmission).map(|v| v.max(one.lit(0.0)));
        Self { sample, ambient, ..self }
    }
}

/// The values on which the light that passes through a thin surface depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassedLight<L> {
    /// The transmission, [0, 1].
    pub transmission: L,
    /// [0, 1]; metals let nothing pass.
    pub metallic: L,
    /// Linear RGB.
    pub base_color: Vec3<L>,
    /// F0 of the dielectric part for white light, [0, 1].
    pub f0: L,
}

/// The share of light that passes a surface from which it casts no shadow.
pub const CLEAR: f32 = 0.5;

impl<L: Lane> PassedLight<L> {
    /// Returns the share of light from behind that passes, at most 0.99. Surfaces are composited with one opacity for all
    /// channels, so that the base colour darkens what is behind, but does not tint it.
    #[inline(always)]
    pub fn share(&self) -> L {
        let Self { transmission, metallic, base_color, f0 } = *self;
        let one = metallic.lit(1.0);
        let mean = (base_color.x + base_color.y + base_color.z) * one.lit(1.0 / 3.0);
        (transmission * (one - metallic) * mean * (one - f0)).clamp(0.0, 0.99)
    }
}

/// Returns F0 and F90: of a dielectric from its index of refraction, specular strength and colour, of a metal from its
/// base colour.
///
/// Source: glTF 2.0, appendix B; KHR_materials_ior; KHR_materials_specular.
#[inline(always)]
fn normal_and_grazing<L: Lane>(
    uniforms: &MaterialUniforms<L>,
    values: &MaterialValues<L>,
    base_color: Vec3<L>,
) -> (Vec3<L>, L) {
    let MaterialValues { metallic, specular: strength, specular_color, .. } = *values;
    let one = metallic.lit(1.0);
    let tinted = specular_color * uniforms.dielectric_f0;
    let dielectric = Vec3::new(tinted.x.min(one), tinted.y.min(one), tinted.z.min(one)) * strength;
    let f0 = dielectric * (one - metallic) + base_color * metallic;
    (f0, strength * (one - metallic) + metallic)
}

/// Beckmann's slope and the exponent of the Phong family: as authored, widened by detail within the pixel, or from
/// the roughness, which is widened already.
#[inline(always)]
fn classic_widths<L: Lane>(uniforms: &MaterialUniforms<L>, values: &MaterialValues<L>) -> (L, L) {
    let MaterialValues { roughness, variance, .. } = *values;
    let alpha = (roughness * roughness).max(roughness.lit(LEAST_ALPHA));
    let widened = |alpha: L| (alpha * alpha + variance).sqrt();
    let slope = uniforms.slope.map_or(alpha, widened);
    let shininess = match uniforms.shininess {
        Some(authored) => {
            let wide =
                microfacets::shininess_from_alpha(widened(microfacets::alpha_from_shininess(authored)));
            L::select(variance.lit(0.0).lt(variance), wide, authored)
        }
        None => microfacets::shininess_from_alpha(alpha),
    };
    (slope, shininess)
}

/// Returns Beckmann's slope for the tables of `cook-torrance`, at least 0.
#[inline(always)]
pub fn lobe_slope<L: Lane>(uniforms: &MaterialUniforms<L>, values: &MaterialValues<L>) -> L {
    match uniforms.slope {
        Some(slope) => (slope * slope + values.variance).sqrt(),
        None => values.roughness.squared(),
    }
}

/// Returns the roughness of the GGX lobe closest to the model's highlight, [0, 1].
#[inline(always)]
pub fn lobe_roughness<L: Lane>(
    shading: Shading,
    uniforms: &MaterialUniforms<L>,
    values: &MaterialValues<L>,
) -> L {
    match (shading, uniforms.shininess) {
        _ if is_cook_torrance(shading) => {
            let slope = lobe_slope(uniforms, values);
            slope.sqrt().min(slope.lit(1.0))
        }
        (Shading::Ggx | Shading::GgxPrinted | Shading::Lambert, _) | (_, None) => values.roughness,
        (_, Some(shininess)) => microfacets::alpha_from_shininess(shininess).sqrt(),
    }
}

/// The facts about a model that are known before any point. If it is a constant, code for other models is not compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Model {
    /// The reflectance model.
    pub shading: Shading,
    /// `true` if there may be clearcoat, sheen or anisotropy.
    pub layered: bool,
}

impl Model {
    /// Returns the model of a material.
    pub fn new(shading: Shading, material: &Material) -> Self {
        let layers =
            material.clearcoat.is_some() || material.sheen.is_some() || material.anisotropy.is_some();
        Self { shading, layered: takes_layers(shading) && layers }
    }
}

/// Returns true if the model has clearcoat, sheen and anisotropy.
pub(crate) fn takes_layers(shading: Shading) -> bool {
    shading == Shading::Ggx
}

/// Returns true if the model multiplies k_s by a Fresnel term made from F0, so that k_s is 1 unless authored.
fn takes_fresnel(shading: Shading) -> bool {
    is_cook_torrance(shading)
}

/// Returns true if the model can add multiple scattering.
pub fn takes_compensation(shading: Shading) -> bool {
    matches!(shading, Shading::Ggx | Shading::CookTorrance)
}

/// Returns true if the model has a microfacet lobe, whose directional albedos are in tables.
pub fn takes_albedos(shading: Shading) -> bool {
    takes_compensation(shading) || matches!(shading, Shading::GgxPrinted | Shading::CookTorrancePrinted)
}

/// Returns true if reflected light depends on the roughness: slopes and exponents may be authored instead.
pub fn takes_roughness(shading: Shading, material: &Material) -> bool {
    match shading {
        Shading::CookTorrance | Shading::CookTorrancePrinted => material.classic.slope.is_none(),
        Shading::Phong | Shading::BlinnPhong => material.classic.shininess.is_none(),
        _ => true,
    }
}

/// Returns true if the lobe is Beckmann's.
pub fn is_cook_torrance(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}

/// Applies the linear part of a texture's transform, given by rows, to texture coordinates or their derivatives.
#[inline(always)]
pub fn turned_uv<L: Lane>([[a, b], [c, d]]: [[L; 2]; 2], [u, v]: [L; 2]) -> [L; 2] {
    [a * u + b * v, c * u + d * v]
}

/// Returns log2 of the finest level's texels that a pixel covers along the longer of its two steps: the changes of the
/// texture coordinates one pixel to the right and down, in a texture of `size` texels.
#[inline(always)]
pub fn log2_texels<L: Lane>(d_x: [L; 2], d_y: [L; 2], size: [L; 2]) -> L {
    let squared = |[du, dv]: [L; 2]| (du * size[0]).squared() + (dv * size[1]).squared();
    let texels = squared(d_x).max(squared(d_y)).clamp(1e-30, 1e30);
    texels.log2() * texels.lit(0.5)
}

/// Returns the step in u or v to the neighbouring texel of the level in use, whose texels are `texels` texels of the
/// finest level wide; `size` is the finest level's size.
#[inline(always)]
pub fn height_step<L: Lane>(texels: L, size: L) -> L {
    texels / size
}

/// Returns the derivative of a height with respect to u or v, from the heights one [`height_step`] to each side.
#[inline(always)]
pub fn height_derivative<L: Lane>(after: L, before: L, step: L) -> L {
    (after - before) / (step * step.lit(2.0))
}

/// Returns the occlusion weighted by its strength: 1 + strength (o − 1); both in [0, 1].
#[inline(always)]
pub fn occluded<L: Lane>(occlusion: L, strength: L) -> L {
    let one = occlusion.lit(1.0);
    one + strength * (occlusion - one)
}

/// Returns the variance of a normal map's vectors within a pixel, if their x and y are multiplied by `scale`.
#[inline(always)]
pub fn mapped_variance<L: Lane>(variance: L, scale: L) -> L {
    variance * (scale * scale)
}

/// Returns the cosine and sine of the material's own angle of anisotropy, at the 32-bit precision of files.
pub fn own_turn(anisotropy: &Anisotropy) -> [f32; 2] {
    let angle = f64::from(anisotropy.rotation as f32);
    [scalar::cos(angle) as f32, scalar::sin(angle) as f32]
}

/// Returns the cosine and sine of the anisotropy's angle from the tangent: the material's angle, rotated by a texel's red
/// and green, each in [0, 1].
///
/// Source: KHR_materials_anisotropy.
#[inline(always)]
pub fn anisotropy_turn<L: Lane>([cos, sin]: [L; 2], [red, green]: [L; 2]) -> [L; 2] {
    let (one, two) = (red.lit(1.0), red.lit(2.0));
    let (x, y) = (two * red - one, two * green - one);
    [cos * x - sin * y, sin * x + cos * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::Named;
    use crate::shade::Angles;

    #[test]
    fn perfect_glass_scatters_nothing() {
        let [n, v, l] = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, 0.8]].map(Vec3::from_array);
        let values = MaterialValues {
            tint: Vec3::splat(1.0),
            metallic: 0.0,
            roughness: 0.5,
            specular: 1.0,
            specular_color: Vec3::splat(1.0),
            occlusion: 1.0,
            emissive: Vec3::splat(0.0),
            variance: 0.0,
        };
        for (name, shading) in Shading::NAMES {
            let point = |base: f32, values: &MaterialValues<f32>| {
                let material = Material { base_color: [base, base, base, 1.0], ..Material::default() };
                MaterialPoint::new(*shading, &MaterialUniforms::new(&material), values, None)
            };
            let light = |point: MaterialPoint<f32>| {
                [shade::reflect(*shading, &point.sample, &Angles::new(n, v, l)), point.ambient]
            };
            let reflected = |base: f32| light(point(base, &values).transmitting(*shading, 1.0));
            for (dark, bright) in reflected(0.1).into_iter().zip(reflected(0.9)) {
                assert!((dark - bright).length() < 1e-6, "{name}: {dark:?} {bright:?}");
            }
            let metal = point(0.9, &MaterialValues { metallic: 1.0, ..values });
            assert_eq!(light(metal.transmitting(*shading, 1.0)), light(metal), "{name}");
        }
    }

    #[test]
    fn light_passes_through_glass_but_not_through_metal() {
        let glass = PassedLight { transmission: 1.0, metallic: 0.0, base_color: Vec3::splat(1.0), f0: 0.04 };
        assert!((glass.share() - 0.96).abs() < 1e-6);
        assert_eq!(PassedLight { metallic: 1.0, ..glass }.share(), 0.0);
        assert_eq!(PassedLight { f0: 0.0, ..glass }.share(), 0.99, "blending divides by the rest");
    }
}
