//! The material sample: the parameters of a surface at a point.

use super::compensation::Compensation;
use crate::math::Vec3;

/// A material sample: the parameters of a surface at a point. Each model reads the fields it knows and ignores the
/// rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialSample<L> {
    /// ρ, linear RGB in [0, 1]; diffuse colour of `lambert`, `ggx` and `ggx-printed`.
    pub base_color: Vec3<L>,
    /// [0, 1]; 1 has no diffuse part in `ggx`.
    pub metallic: L,
    /// Perceptual roughness, [0, 1]; α is its square (in `ggx-printed`, α is the roughness itself).
    pub roughness: L,
    /// Reflectance at normal incidence, linear RGB in [0, 1], already mixed by `metallic`.
    pub f0: Vec3<L>,
    /// Reflectance at grazing incidence, [0, 1]; 1 except for weakened dielectrics.
    pub f90: L,
    /// Lazányi coefficient of the reflectance at 82°, see [`super::fresnel::f82_drop`]; 0 means Schlick.
    pub f82_drop: Vec3<L>,
    /// k_d or C_diff of the classic models and of Cook-Torrance, linear RGB in [0, 1].
    pub diffuse: Vec3<L>,
    /// k_s or C_spec of the classic models and of Cook-Torrance, linear RGB in [0, 1].
    pub specular: Vec3<L>,
    /// Exponent of Phong and Blinn-Phong, at least 0.
    pub shininess: L,
    /// Beckmann's rms slope m of Cook-Torrance, above 0.
    pub slope: L,
    /// Light scattered by several facets, for `ggx` and `cook-torrance`; `None` follows light only to its first
    /// facet.
    pub compensation: Option<Compensation<L>>,
}
