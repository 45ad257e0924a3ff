//! The values of a material, in every model's terms.

use super::batch::Lanes;
use super::model::{takes_compensation, takes_fresnel};
use crate::math::{Pack, Vec3};
use crate::scene::Material;
use crate::shade::{self, MaterialSample, Shading, fresnel, ndf};

/// The least α that shininess and slope are made from.
const LEAST_ALPHA: f32 = 0.02;

/// The surface's parameters in every model's terms, and k_a. What the material does not author follows from the
/// metallic-roughness values.
#[inline(always)]
pub(super) fn material_sample<P: Pack>(
    at: Lanes<'_, P>,
    shading: Shading,
    material: &Material,
) -> (MaterialSample<P>, Vec3<P>) {
    let batch = at.batch;
    let tint = at.load3(&batch.tint);
    let (metallic, roughness) = (at.load(&batch.metallic), at.load(&batch.roughness));
    let one = at.splat(1.0);
    let [r, g, b, _] = material.base_color;
    let base_color = tint.mul_elements(at.everywhere([r, g, b]));
    let (f0, f90) = match material.f0 {
        Some(f0) => (at.everywhere(f0), one),
        None => normal_and_grazing(at, material, base_color),
    };
    let f82_drop = match material.f82 {
        Some(f82) => fresnel::f82_drop(f0, at.everywhere(f82)),
        None => Vec3::splat(at.splat(0.0)),
    };
    let diffuse = match material.classic.diffuse {
        Some(diffuse) => at.everywhere(diffuse).mul_elements(tint),
        None => base_color * (one - metallic),
    };
    let specular = match material.classic.specular {
        Some(specular) => at.everywhere(specular),
        None if takes_fresnel(shading) => Vec3::splat(one),
        None => f0,
    };
    let (slope, shininess) = classic_widths(at, material);
    let ambient = match material.classic.ambient {
        Some(ambient) => at.everywhere(ambient).mul_elements(tint),
        None => diffuse + f0,
    };
    let compensated = batch.compensated && takes_compensation(shading);
    let compensation = compensated.then(|| shade::compensation(&at.dfg(), f0, f90, f82_drop));
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
    (sample, ambient)
}

/// Returns F0 and F90: a dielectric's by its index of refraction and its specular strength and colour, a metal's by
/// its base colour.
///
/// Source: glTF 2.0, appendix B; KHR_materials_ior; KHR_materials_specular.
#[inline(always)]
fn normal_and_grazing<P: Pack>(at: Lanes<'_, P>, material: &Material, base_color: Vec3<P>) -> (Vec3<P>, P) {
    let batch = at.batch;
    let one = at.splat(1.0);
    let metallic = at.load(&batch.metallic);
    let strength = at.load(&batch.specular);
    let from_index = at.splat(f0_of_index(material.ior));
    let tinted = at.load3(&batch.specular_color) * from_index;
    let dielectric = Vec3::new(tinted.x.min(one), tinted.y.min(one), tinted.z.min(one)) * strength;
    let f0 = dielectric * (one - metallic) + base_color * metallic;
    (f0, strength * (one - metallic) + metallic)
}

/// Returns ((η − 1)/(η + 1))², and 1 for the index 0, which means total reflection.
fn f0_of_index(ior: f32) -> f32 {
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

/// Beckmann's slope and the exponent of the Phong family: as authored, widened by what hides within the pixel, or from
/// the roughness, which is widened already.
#[inline(always)]
fn classic_widths<P: Pack>(at: Lanes<'_, P>, material: &Material) -> (P, P) {
    let roughness = at.load(&at.batch.roughness);
    let alpha = (roughness * roughness).max(at.splat(LEAST_ALPHA));
    let variance = at.load(&at.batch.variance);
    let widened = |alpha: P| (alpha * alpha + variance).sqrt();
    let slope = material.classic.slope.map_or(alpha, |slope| widened(at.splat(slope)));
    let shininess = match material.classic.shininess {
        Some(shininess) => {
            let authored = at.splat(shininess);
            let wide = ndf::shininess_from_alpha(widened(ndf::alpha_from_shininess(authored)));
            P::select(at.splat(0.0).lt(variance), wide, authored)
        }
        None => ndf::shininess_from_alpha(alpha),
    };
    (slope, shininess)
}
