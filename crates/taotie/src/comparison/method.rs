//! The methods to compare.

use crate::names::Named;
use crate::surface::SurfaceMethod;

/// A way to find the shading normal: a surface method, and for the bump methods a factor.
///
/// ```
/// use taotie::comparison::Method;
/// use taotie::surface::SurfaceMethod;
///
/// let bump = Method { surface: SurfaceMethod::Bump, factor: Some(5.0) };
/// assert_eq!(bump.id(), "bump:5");
/// assert_eq!(bump.file_stem(), "bump-5");
/// assert_eq!(Method::from(SurfaceMethod::TangentNormal).id(), "tangent-normal");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Method {
    /// The surface method.
    pub surface: SurfaceMethod,
    /// For `bump` the height of white above black in texels, for `bump-printed` the factor of Guo and Wang 2025.
    /// `None` uses the height in the material.
    pub factor: Option<f32>,
}

impl From<SurfaceMethod> for Method {
    fn from(surface: SurfaceMethod) -> Self {
        Self { surface, factor: None }
    }
}

/// The bump factors of Guo and Wang 2025.
const PAPER_FACTORS: [f32; 2] = [5.0, 50.0];

impl Method {
    /// Returns the methods compared by default: the four of Guo and Wang 2025, bump mapping as intended, and both
    /// kinds of normal map.
    pub fn defaults() -> Vec<Self> {
        let by_factor = |surface| PAPER_FACTORS.map(|factor| Self { surface, factor: Some(factor) });
        let mut methods = vec![Self::from(SurfaceMethod::Smooth), Self::from(SurfaceMethod::Bump)];
        methods.extend(by_factor(SurfaceMethod::Bump));
        methods.extend(by_factor(SurfaceMethod::BumpPrinted));
        methods.extend([Self::from(SurfaceMethod::ObjectNormal), Self::from(SurfaceMethod::TangentNormal)]);
        methods
    }

    /// Returns `true` if the method takes a factor, which only bump mapping does.
    pub fn takes_factor(surface: SurfaceMethod) -> bool {
        matches!(surface, SurfaceMethod::Bump | SurfaceMethod::BumpPrinted)
    }

    /// Returns its name with the factor: `tangent-normal`, `bump:5`.
    pub fn id(self) -> String {
        match self.factor {
            Some(factor) => format!("{}:{factor}", self.surface.name()),
            None => self.surface.name().into(),
        }
    }

    /// Returns [`Method::id`] as part of a file's name: `bump-5`.
    pub fn file_stem(self) -> String {
        self.id().replace(':', "-")
    }

    /// Returns a short description.
    pub fn describe(self) -> String {
        let what = match self.surface {
            SurfaceMethod::Facet => "one normal per triangle",
            SurfaceMethod::Smooth => "vertex normals",
            SurfaceMethod::Bump => "surface gradient",
            SurfaceMethod::BumpPrinted => "as printed in the paper",
            SurfaceMethod::ObjectNormal => "object-space map",
            SurfaceMethod::TangentNormal => "tangent-space map",
        };
        match (self.surface, self.factor) {
            (SurfaceMethod::Bump, Some(factor)) => format!("{what}, {factor} texels"),
            (SurfaceMethod::BumpPrinted, Some(factor)) => format!("{what}, factor {factor}"),
            _ => what.into(),
        }
    }
}
