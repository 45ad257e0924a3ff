//! The names of the ways to a shading normal, and of the ways to tangents.

use crate::error::{Error, Result};

/// Where the shading normal comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SurfaceMethod {
    /// The geometric normal of the triangle.
    Facet,
    /// The interpolated vertex normal.
    Smooth,
    /// A height map by the surface-gradient method (Mikkelsen 2020).
    Bump,
    /// The seed paper's bump mapping as its Table 2 prints it: not normalised, see [`super::bump_printed`].
    BumpPrinted,
    /// Read from an object-space map.
    ObjectNormal,
    /// Read from a tangent-space map.
    #[default]
    TangentNormal,
}

impl SurfaceMethod {
    /// Every method with its name on the command line.
    pub const NAMES: [(&'static str, SurfaceMethod); 6] = [
        ("facet", Self::Facet),
        ("smooth", Self::Smooth),
        ("bump", Self::Bump),
        ("bump-printed", Self::BumpPrinted),
        ("object-normal", Self::ObjectNormal),
        ("tangent-normal", Self::TangentNormal),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        name_of(&Self::NAMES, self)
    }

    /// The method of this name.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists the names.
    pub fn from_name(name: &str) -> Result<Self> {
        value_of(&Self::NAMES, "surface", name)
    }
}

/// How tangents are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum TangentMethod {
    /// Each triangle's own solution of the two edge equations.
    Face,
    /// The angle-weighted mean of the triangles at a vertex.
    Averaged,
    /// Mikkelsen's tangent space (2008), which bakers and glTF agree on.
    #[default]
    MikkTSpace,
}

impl TangentMethod {
    /// Every method with its name on the command line.
    pub const NAMES: [(&'static str, TangentMethod); 3] =
        [("face", Self::Face), ("averaged", Self::Averaged), ("mikktspace", Self::MikkTSpace)];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        name_of(&Self::NAMES, self)
    }

    /// The method of this name.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists the names.
    pub fn from_name(name: &str) -> Result<Self> {
        value_of(&Self::NAMES, "tangents", name)
    }
}

fn name_of<T: Copy + PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    names.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

fn value_of<T: Copy>(names: &[(&'static str, T)], what: &str, name: &str) -> Result<T> {
    names.iter().find(|(known, _)| *known == name).map(|(_, value)| *value).ok_or_else(|| {
        let known: Vec<&str> = names.iter().map(|(known, _)| *known).collect();
        Error::invalid(format!("{what} `{name}`"), format!("there is {}", known.join(", ")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for (name, method) in SurfaceMethod::NAMES {
            assert_eq!(method.name(), name);
            assert_eq!(SurfaceMethod::from_name(name).unwrap(), method);
        }
        for (name, method) in TangentMethod::NAMES {
            assert_eq!(TangentMethod::from_name(name).unwrap().name(), method.name());
        }
        let text = SurfaceMethod::from_name("flat").unwrap_err().to_string();
        assert!(text.contains("`flat`") && text.contains("bump-printed"), "{text}");
    }
}
