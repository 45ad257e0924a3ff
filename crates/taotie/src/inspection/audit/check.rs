//! The checks of an audit and their results.

use super::range::AuditRange;
use super::words::number;
use crate::names::Named;

/// A check of an audit, under the name that the Khronos glTF Asset Auditor gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Check {
    /// The file follows the glTF specification, as the Khronos validator sees it.
    GltfValidator,
    /// The size of the file and of the files it names.
    FileSize,
    /// The triangles of all meshes.
    TriangleCount,
    /// The materials of the file.
    MaterialCount,
    /// The nodes of the file.
    NodeCount,
    /// The meshes of the file.
    MeshCount,
    /// The primitives of all meshes.
    PrimitiveCount,
    /// Root nodes have no translation, rotation or scale.
    CleanRootTransform,
    /// No two faces meet at 90° or more.
    BeveledEdges,
    /// No edge has more than two faces.
    ManifoldEdges,
    /// The size of the model is within its limits.
    OverallDimensions,
    /// The size of the model matches that of its product.
    ProductDimensions,
    /// The brightest texel of the base colour.
    PbrColorMaximum,
    /// The darkest texel of the base colour.
    PbrColorMinimum,
    /// The highest texture.
    TextureHeightMaximum,
    /// The lowest texture.
    TextureHeightMinimum,
    /// The widest texture.
    TextureWidthMaximum,
    /// The narrowest texture.
    TextureWidthMinimum,
    /// Sides of textures are powers of two.
    PowerOfTwoTextures,
    /// Textures are square.
    SquareTextures,
    /// The highest texel density.
    TexelDensityMaximum,
    /// The lowest texel density.
    TexelDensityMinimum,
    /// Uvs are in [0, 1].
    UvRange,
    /// No triangle is mirrored in uv.
    InvertedUvs,
    /// No two triangles of a primitive overlap in uv.
    OverlappingUvs,
    /// UV islands are far enough apart.
    GutterWidth,
}

impl Named for Check {
    const WHAT: &'static str = "check";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("gltf-validator", Self::GltfValidator),
        ("file-size", Self::FileSize),
        ("triangle-count", Self::TriangleCount),
        ("material-count", Self::MaterialCount),
        ("node-count", Self::NodeCount),
        ("mesh-count", Self::MeshCount),
        ("primitive-count", Self::PrimitiveCount),
        ("clean-root-transform", Self::CleanRootTransform),
        ("beveled-edges", Self::BeveledEdges),
        ("manifold-edges", Self::ManifoldEdges),
        ("overall-dimensions", Self::OverallDimensions),
        ("product-dimensions", Self::ProductDimensions),
        ("pbr-color-maximum", Self::PbrColorMaximum),
        ("pbr-color-minimum", Self::PbrColorMinimum),
        ("texture-height-maximum", Self::TextureHeightMaximum),
        ("texture-height-minimum", Self::TextureHeightMinimum),
        ("texture-width-maximum", Self::TextureWidthMaximum),
        ("texture-width-minimum", Self::TextureWidthMinimum),
        ("power-of-two-textures", Self::PowerOfTwoTextures),
        ("square-textures", Self::SquareTextures),
        ("texel-density-maximum", Self::TexelDensityMaximum),
        ("texel-density-minimum", Self::TexelDensityMinimum),
        ("uv-range", Self::UvRange),
        ("inverted-uvs", Self::InvertedUvs),
        ("overlapping-uvs", Self::OverlappingUvs),
        ("gutter-width", Self::GutterWidth),
    ];
}

/// The outcome of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum CheckStatus {
    /// The model meets the schema.
    Pass,
    /// The model does not meet the schema.
    Fail,
    /// The schema does not require it, or the model has nothing to check.
    NotTested,
}

impl Named for CheckStatus {
    const WHAT: &'static str = "status";
    const NAMES: &'static [(&'static str, Self)] =
        &[("pass", Self::Pass), ("fail", Self::Fail), ("not-tested", Self::NotTested)];
}

/// The result of a check.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CheckResult {
    /// The check.
    pub name: Check,
    /// Its outcome.
    pub status: CheckStatus,
    /// The value with its limits, or why it was not tested.
    pub message: String,
    /// The value, if it is one number and was measured.
    pub value: Option<f64>,
    /// The minimum value allowed.
    pub minimum: Option<f64>,
    /// The maximum value allowed.
    pub maximum: Option<f64>,
}

impl CheckResult {
    /// Returns the result of a check that was not run.
    pub(super) fn not_tested(name: Check, message: impl Into<String>) -> Self {
        let (status, message) = (CheckStatus::NotTested, message.into());
        Self { name, status, message, value: None, minimum: None, maximum: None }
    }

    /// Returns the result of a check that passed or failed.
    pub(super) fn tested(name: Check, passes: bool, message: impl Into<String>) -> Self {
        let status = if passes { CheckStatus::Pass } else { CheckStatus::Fail };
        Self { status, ..Self::not_tested(name, message) }
    }

    /// Compares a value in `unit` with its range; without a limit it is reported, but not tested.
    pub(super) fn of_value(name: Check, (value, unit): (f64, &str), range: AuditRange) -> Self {
        let text = format!("{}{unit}", number(value));
        let AuditRange { minimum, maximum } = range;
        let result = match range.is_limited() {
            true => Self::tested(name, range.allows(value), format!("{text} ({})", range.words())),
            false => Self::not_tested(name, text),
        };
        Self { value: Some(value), minimum, maximum, ..result }
    }

    /// Returns the result of a check that passes if there are no faults; `what` states the number of faults.
    pub(super) fn of_faults(name: Check, faults: usize, what: impl Into<String>) -> Self {
        let (value, maximum) = (Some(faults as f64), Some(0.0));
        Self { value, maximum, ..Self::tested(name, faults == 0, what) }
    }
}
