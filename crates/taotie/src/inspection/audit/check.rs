//! The checks of an audit: their names, the ranges that they allow, their results, and the words of their messages.

use serde::de::{Deserialize, Deserializer, Error};
use taotie_engine::names::Named;

/// A check of an audit, under the name that the Khronos glTF Asset Auditor gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
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
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
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

/// The minimum and maximum value allowed; `None` for no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Deserialize)]
#[serde(try_from = "Limits")]
pub(super) struct AuditRange {
    pub minimum: Option<f64>,
    pub maximum: Option<f64>,
}

/// The limits as in the schema.
#[derive(Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Limits {
    #[serde(deserialize_with = "limit")]
    minimum: Option<f64>,
    #[serde(deserialize_with = "limit")]
    maximum: Option<f64>,
}

/// Reads a limit, which is at least 0; −1 means none.
pub(super) fn limit<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    match Option::<f64>::deserialize(from)? {
        Some(-1.0) | None => Ok(None),
        Some(limit) if limit >= 0.0 => Ok(Some(limit)),
        Some(limit) => {
            Err(D::Error::custom(format!("invalid limit {limit}: use 0 or more, or -1 for no limit")))
        }
    }
}

impl TryFrom<Limits> for AuditRange {
    type Error = String;

    fn try_from(Limits { minimum, maximum }: Limits) -> Result<Self, String> {
        match (minimum, maximum) {
            (Some(low), Some(high)) if low > high => {
                Err(format!("the minimum {low} is above the maximum {high}: no model can pass"))
            }
            _ => Ok(Self { minimum, maximum }),
        }
    }
}

impl AuditRange {
    /// Returns the range with an upper limit only.
    pub fn at_most(maximum: Option<f64>) -> Self {
        Self { minimum: None, maximum }
    }

    /// Returns the range with a lower limit only.
    pub fn at_least(minimum: Option<f64>) -> Self {
        Self { minimum, maximum: None }
    }

    /// Returns true if there is a limit.
    pub fn is_limited(&self) -> bool {
        self.minimum.is_some() || self.maximum.is_some()
    }

    /// Returns true if a value is within the limits.
    pub fn allows(&self, value: f64) -> bool {
        self.minimum.is_none_or(|least| value >= least) && self.maximum.is_none_or(|most| value <= most)
    }

    /// Returns the limits in words, such as `at least 1 and at most 5`; empty if there are none.
    pub fn words(&self) -> String {
        let least = self.minimum.map(|least| format!("at least {}", number(least)));
        let most = self.maximum.map(|most| format!("at most {}", number(most)));
        least.into_iter().chain(most).collect::<Vec<_>>().join(" and ")
    }
}

/// Formats a number with at most six decimals, grouping digits in threes.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.6}");
    let (whole, decimals) = text.split_once('.').unwrap_or((&text, ""));
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("-", digits));
    let (first, rest) = digits.split_at((digits.len() - 1) % 3 + 1);
    let groups: String =
        rest.as_bytes().chunks(3).map(|group| format!(",{}", String::from_utf8_lossy(group))).collect();
    match decimals.trim_end_matches('0') {
        "" => format!("{sign}{first}{groups}"),
        decimals => format!("{sign}{first}{groups}.{decimals}"),
    }
}

/// Formats a count with the word for what it counts, adding an `s` unless the count is one.
pub(super) fn counted(count: usize, what: &str) -> String {
    format!("{} {what}{}", number(count as f64), if count == 1 { "" } else { "s" })
}

/// Returns a value rounded to a multiple of 1 / `steps`.
pub(super) fn rounded(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_and_short() {
        let texts = [0.0, 7.0, 1234.0, 999_999.5, -1_234_567.25, 0.1 + 0.2].map(number);
        assert_eq!(texts, ["0", "7", "1,234", "999,999.5", "-1,234,567.25", "0.3"]);
        assert_eq!((counted(1, "edge"), counted(0, "edge")), ("1 edge".into(), "0 edges".into()));
    }
}
