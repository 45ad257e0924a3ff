//! What is compared: a surface method, for the bump methods with a factor.

use crate::options;
use taotie::names::Named;
use taotie::surface::SurfaceMethod;

/// A way to find the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// The way.
    pub surface: SurfaceMethod,
    /// The paper's bump factor: white stands this many texels above black. `None` takes the height of the material.
    pub factor: Option<f32>,
}

/// The paper's bump factors.
const PAPER_FACTORS: [f32; 2] = [5.0, 50.0];

impl Method {
    /// The methods that are compared if none is named: the paper's four, bump mapping as it is meant beside it, and
    /// both kinds of normal map.
    pub fn defaults() -> Vec<Self> {
        let plain = |surface| Self { surface, factor: None };
        let by_factor = |surface| PAPER_FACTORS.map(|factor| Self { surface, factor: Some(factor) });
        let mut methods = vec![plain(SurfaceMethod::Smooth), plain(SurfaceMethod::Bump)];
        methods.extend(by_factor(SurfaceMethod::Bump));
        methods.extend(by_factor(SurfaceMethod::BumpPrinted));
        methods.extend([plain(SurfaceMethod::ObjectNormal), plain(SurfaceMethod::TangentNormal)]);
        methods
    }

    /// As it is written on the command line: `tangent-normal`, `bump:5`.
    pub fn id(self) -> String {
        match self.factor {
            Some(factor) => format!("{}:{factor}", self.surface.name()),
            None => self.surface.name().into(),
        }
    }

    /// [`Method::id`] as part of a file's name.
    pub fn file_stem(self) -> String {
        self.id().replace(':', "-")
    }

    /// What it does, in a few words.
    pub fn describe(self) -> String {
        let what = match self.surface {
            SurfaceMethod::Facet => "one normal a triangle",
            SurfaceMethod::Smooth => "vertex normals",
            SurfaceMethod::Bump => "surface gradient",
            SurfaceMethod::BumpPrinted => "as the paper prints it",
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

/// `NAME` or `NAME:FACTOR`.
pub fn parse(value: &str) -> Result<Method, String> {
    let (name, factor) = match value.split_once(':') {
        Some((name, factor)) => (name, Some(options::number(factor)? as f32)),
        None => (value, None),
    };
    let surface = options::named(name)?;
    let takes_factor = matches!(surface, SurfaceMethod::Bump | SurfaceMethod::BumpPrinted);
    if factor.is_some() && !takes_factor {
        return Err(format!("`{name}` takes no factor; only bump and bump-printed do, such as bump:5"));
    }
    Ok(Method { surface, factor })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for method in Method::defaults() {
            assert_eq!(parse(&method.id()), Ok(method));
        }
    }

    #[test]
    fn factors_belong_to_bump() {
        assert!(parse("smooth:5").unwrap_err().contains("bump:5"));
        assert!(parse("bump:high").unwrap_err().contains("high"));
        assert!(parse("bmup").unwrap_err().contains("tangent-normal"));
    }
}
