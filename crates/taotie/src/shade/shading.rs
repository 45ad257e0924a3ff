//! The reflectance models by name.

use crate::names::Named;

/// A reflectance model. The correct models have their standard names; a model ending in `Printed` computes what a
/// paper or article prints, errors included, so that its images can be reproduced and compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Shading {
    /// Perfectly diffuse, f = ρ/π.
    Lambert,
    /// Phong 1975: the mirrored light direction against the viewer's.
    Phong,
    /// Blinn-Phong with the energy normalisation (s + 8)/(8π).
    BlinnPhong,
    /// Blinn-Phong without normalisation, as in fixed-function graphics.
    BlinnPhongClassic,
    /// Cook and Torrance 1982 with Beckmann's distribution, in today's normalisation.
    CookTorrance,
    /// Metallic-roughness of glTF 2.0: GGX, height-correlated Smith, Schlick.
    #[default]
    Ggx,
    /// Cook-Torrance as Guo and Wang 2025 print it.
    CookTorrancePrinted,
    /// Blinn-Phong as the article's shader computes it.
    BlinnPhongPrinted,
    /// GGX as the article's shader computes it.
    GgxPrinted,
}

impl Shading {
    /// Returns true if it computes what a paper or article prints, errors included, so that nothing may be corrected.
    pub fn is_printed(self) -> bool {
        matches!(self, Self::CookTorrancePrinted | Self::BlinnPhongPrinted | Self::GgxPrinted)
    }
}

impl Named for Shading {
    const WHAT: &'static str = "shading model";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("lambert", Self::Lambert),
        ("phong", Self::Phong),
        ("blinn-phong", Self::BlinnPhong),
        ("blinn-phong-classic", Self::BlinnPhongClassic),
        ("cook-torrance", Self::CookTorrance),
        ("ggx", Self::Ggx),
        ("cook-torrance-printed", Self::CookTorrancePrinted),
        ("blinn-phong-printed", Self::BlinnPhongPrinted),
        ("ggx-printed", Self::GgxPrinted),
    ];
}
