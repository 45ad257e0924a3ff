//! What a material says, in every model's terms.

use super::batch::{Batch, load, load3};
use super::point::{dfg, everywhere};
use crate::math::{Pack, Vec3};
use crate::scene::Material;
use crate::shade::{self, Shading, Substance, fresnel, ndf};

/// The least α that shininess and slope are made from.
const LEAST_ALPHA: f32 = 0.02;

/// Whether the model has lacquer, fibres and stretched highlights.
pub(super) fn takes_layers(shading: Shading) -> bool {
    shading == Shading::Ggx
}

/// Whether the model multiplies k_s by a Fresnel term made from F0, so that k_s itself is 1 where not authored.
fn takes_fresnel(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrance | Shading::CookTorrancePrinted)
}

/// Whether the model has a form that gives back what scatters several times.
pub(super) fn takes_compensation(shading: Shading) -> bool {
    matches!(shading, Shading::Ggx | Shading::CookTorrance)
}

/// Whether the model has a microfacet lobe, whose directional albedos are in tables.
pub(super) fn takes_albedos(shading: Shading) -> bool {
    takes_compensation(shading) || matches!(shading, Shading::GgxPrinted | Shading::CookTorrancePrinted)
}

/// Whether what lights reflect depends on the roughness: slopes and exponents may be given instead.
pub(super) fn takes_roughness(shading: Shading, material: &Material) -> bool {
    match shading {
        Shading::CookTorrance | Shading::CookTorrancePrinted => material.classic.slope.is_none(),
        Shading::Phong | Shading::BlinnPhong => material.classic.shininess.is_none(),
        _ => true,
    }
}

/// The surface's parameters in every model's terms, and k_a. What the material does not author follows from the
/// metallic-roughness values.
#[inline(always)]
pub(super) fn substance<P: Pack>(
    token: P::Token,
    shading: Shading,
    material: &Material,
    batch: &Batch,
    i: usize,
) -> (Substance<P>, Vec3<P>) {
    let tint = load3(token, &batch.tint, i);
    let (metallic, roughness): (P, P) = (load(token, &batch.metallic, i), load(token, &batch.roughness, i));
    let one = P::splat(token, 1.0);
    let [r, g, b, _] = material.base_color;
    let base_color = tint.mul_elements(everywhere(token, [r, g, b]));
    let (f0, f90) = match material.f0 {
        Some(f0) => (everywhere(token, f0), one),
        None => normal_and_grazing(token, material, batch, i, base_color),
    };
    let f82_drop = match material.f82 {
        Some(f82) => fresnel::f82_drop(f0, everywhere(token, f82)),
        None => Vec3::splat(P::splat(token, 0.0)),
    };
    let diffuse = match material.classic.diffuse {
        Some(diffuse) => everywhere(token, diffuse).mul_elements(tint),
        None => base_color * (one - metallic),
    };
    let specular = match material.classic.specular {
        Some(specular) => everywhere(token, specular),
        None if takes_fresnel(shading) => Vec3::splat(one),
        None => f0,
    };
    let (slope, shininess) = classic_widths(token, material, batch, i);
    let ambient = match material.classic.ambient {
        Some(ambient) => everywhere(token, ambient).mul_elements(tint),
        None => diffuse + f0,
    };
    let compensated = batch.compensated && takes_compensation(shading);
    let compensation = compensated.then(|| shade::compensation(&dfg(token, batch, i), f0, f90, f82_drop));
    let substance = Substance {
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
    (substance, ambient)
}

/// F0 and F90: a dielectric's by its index of refraction and its specular strength and colour, a metal's by its base
/// colour.
///
/// Source: glTF 2.0, appendix B; KHR_materials_ior; KHR_materials_specular.
#[inline(always)]
fn normal_and_grazing<P: Pack>(
    token: P::Token,
    material: &Material,
    batch: &Batch,
    i: usize,
    base_color: Vec3<P>,
) -> (Vec3<P>, P) {
    let one = P::splat(token, 1.0);
    let metallic: P = load(token, &batch.metallic, i);
    let strength: P = load(token, &batch.specular, i);
    let from_index = P::splat(token, f0_of_index(material.ior));
    let tinted = load3(token, &batch.specular_color, i) * from_index;
    let dielectric = Vec3::new(tinted.x.min(one), tinted.y.min(one), tinted.z.min(one)) * strength;
    let f0 = dielectric * (one - metallic) + base_color * metallic;
    (f0, strength * (one - metallic) + metallic)
}

/// ((η − 1)/(η + 1))², and 1 for the index 0, which stands for total reflection.
fn f0_of_index(ior: f32) -> f32 {
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

/// Beckmann's slope and the exponent of the Phong family: as authored, widened by what hides within the pixel, or from
/// the roughness, which is widened already.
#[inline(always)]
fn classic_widths<P: Pack>(token: P::Token, material: &Material, batch: &Batch, i: usize) -> (P, P) {
    let roughness: P = load(token, &batch.roughness, i);
    let alpha = (roughness * roughness).max(P::splat(token, LEAST_ALPHA));
    let variance: P = load(token, &batch.variance, i);
    let widened = |alpha: P| (alpha * alpha + variance).sqrt();
    let slope = material.classic.slope.map_or(alpha, |slope| widened(P::splat(token, slope)));
    let shininess = match material.classic.shininess {
        Some(shininess) => {
            let authored = P::splat(token, shininess);
            let wide = ndf::shininess_from_alpha(widened(ndf::alpha_from_shininess(authored)));
            P::select(P::splat(token, 0.0).lt(variance), wide, authored)
        }
        None => ndf::shininess_from_alpha(alpha),
    };
    (slope, shininess)
}
