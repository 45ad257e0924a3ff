//! The reflectance models by name.

use crate::error::{Error, Result};

/// A reflectance model. The correct models bear their standard names; a model ending in `Printed` computes what
/// the seed paper or article prints, errors included, so that its pictures can be reproduced and compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
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
    /// Every model with its name on the command line.
    pub const NAMES: [(&'static str, Shading); 9] = [
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

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, shading)| *shading == self).map_or("", |(name, _)| name)
    }

    /// The model of this name.
    ///
    /// # Errors
    /// [`Error::Invalid`], listing the names, where there is none.
    pub fn from_name(name: &str) -> Result<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, shading)| *shading).ok_or_else(|| {
            let names: Vec<_> = Self::NAMES.iter().map(|(name, _)| *name).collect();
            Error::invalid(format!("shading `{name}`"), format!("choose one of {}", names.join(", ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for (name, shading) in Shading::NAMES {
            assert_eq!(shading.name(), name);
            assert_eq!(Shading::from_name(name).unwrap(), shading);
        }
    }

    #[test]
    fn an_unknown_name_is_told_the_known_ones() {
        let error = Shading::from_name("gxx").unwrap_err().to_string();
        assert!(error.contains("gxx") && error.contains("cook-torrance-printed"), "{error}");
    }
}
