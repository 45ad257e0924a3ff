//! The schema of the Khronos glTF Asset Auditor: which checks an audit runs, and their limits.

use super::range::AuditRange;
use crate::error::{Error, Result};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::error::Category;
use std::fmt::Display;

/// A requirements schema of the Khronos glTF Asset Auditor, version 1.
///
/// Missing limits or −1, and missing requirements or `false`, turn a check off. Unknown keys are errors.
///
/// ```
/// use taotie::inspection::AuditSchema;
///
/// let text = r#"{ "version": "1.0.4", "model": { "triangles": { "maximum": 100000 } } }"#;
/// let schema = AuditSchema::parse(text.as_bytes(), "schema.json")?;
/// assert_eq!(schema.version(), "1.0.4");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub struct AuditSchema {
    version: String,
    #[serde(default)]
    pub(super) file_size_in_kb: AuditRange,
    #[serde(default)]
    pub(super) materials: AuditRange,
    #[serde(default)]
    pub(super) model: ModelSchema,
    #[serde(default)]
    pub(super) product: ProductSchema,
    #[serde(default)]
    pub(super) textures: TextureSchema,
    #[serde(default)]
    pub(super) uvs: UvSchema,
}

/// Limits of the geometry and of the objects that contain it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "camelCase")]
pub(super) struct ModelSchema {
    pub object_count: ObjectCount,
    pub require_beveled_edges: bool,
    pub require_clean_root_node_transform: bool,
    pub require_manifold_edges: bool,
    pub triangles: AuditRange,
}

/// Limits on the numbers of objects.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ObjectCount {
    pub nodes: AuditRange,
    pub meshes: AuditRange,
    pub primitives: AuditRange,
}

/// Limits of the product's size.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ProductSchema {
    pub dimensions: DimensionsSchema,
}

/// Limits of each dimension.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct DimensionsSchema {
    pub length: DimensionSchema,
    pub width: DimensionSchema,
    pub height: DimensionSchema,
}

/// Limits of a dimension, in metres, and the tolerance relative to the product's own dimension.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "camelCase")]
pub(super) struct DimensionSchema {
    #[serde(deserialize_with = "super::range::limit")]
    pub maximum: Option<f64>,
    #[serde(deserialize_with = "super::range::limit")]
    pub minimum: Option<f64>,
    /// Per cent of the product's dimension; without it the match must be exact.
    #[serde(deserialize_with = "super::range::limit")]
    pub percent_tolerance: Option<f64>,
}

/// Limits of textures.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "camelCase")]
pub(super) struct TextureSchema {
    pub height: AuditRange,
    pub width: AuditRange,
    pub pbr_color_range: AuditRange,
    pub require_dimensions_be_powers_of_two: bool,
    pub require_dimensions_be_quadratic: bool,
}

/// Limits of uvs.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "camelCase")]
pub(super) struct UvSchema {
    pub gutter_width: GutterWidth,
    pub pixels_per_meter: AuditRange,
    pub require_not_inverted: bool,
    pub require_not_overlapping: bool,
    pub require_range_zero_to_one: bool,
}

/// The minimum gutter between UV islands, in pixels of a map of each resolution.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct GutterWidth {
    #[serde(deserialize_with = "super::range::limit")]
    resolution256: Option<f64>,
    #[serde(deserialize_with = "super::range::limit")]
    resolution512: Option<f64>,
    #[serde(deserialize_with = "super::range::limit")]
    resolution1024: Option<f64>,
    #[serde(deserialize_with = "super::range::limit")]
    resolution2048: Option<f64>,
    #[serde(deserialize_with = "super::range::limit")]
    resolution4096: Option<f64>,
}

/// A required gutter: pixels at a resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gutter {
    pub pixels: f64,
    pub resolution: f64,
}

impl Gutter {
    /// Returns the width in uv.
    pub fn width(&self) -> f64 {
        self.pixels / self.resolution
    }
}

impl GutterWidth {
    /// Returns the widest required gutter; `None` if none is.
    pub fn widest(&self) -> Option<Gutter> {
        let all = [
            (self.resolution256, 256.0),
            (self.resolution512, 512.0),
            (self.resolution1024, 1024.0),
            (self.resolution2048, 2048.0),
            (self.resolution4096, 4096.0),
        ];
        let asked = all.into_iter().filter_map(|(pixels, resolution)| Some((pixels?, resolution)));
        let asked = asked.filter(|(pixels, _)| *pixels > 0.0);
        asked
            .map(|(pixels, resolution)| Gutter { pixels, resolution })
            .reduce(|widest, other| if other.width() > widest.width() { other } else { widest })
    }
}

impl AuditSchema {
    /// Reads a schema from the bytes of a JSON file; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::Invalid`] with line and column: text that is not JSON, an unknown or repeated key, a value of the
    /// wrong type, a negative limit other than −1, a minimum above its maximum, a missing version.
    pub fn parse(bytes: &[u8], file: impl Display) -> Result<Self> {
        parse_json(bytes, file)
    }

    /// The version of the auditor for which the schema was written.
    pub fn version(&self) -> &str {
        &self.version
    }
}

/// Reads a value from the bytes of a JSON file; errors name the file, the line and the column.
pub(super) fn parse_json<T: DeserializeOwned>(bytes: &[u8], file: impl Display) -> Result<T> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(bytes).map_err(|error| {
        let text = error.to_string();
        let reason = text.split(" at line ").next().unwrap_or_default();
        let why = match error.classify() {
            Category::Eof => "the JSON ends here: the file is cut off".to_owned(),
            Category::Syntax => format!("not valid JSON ({reason}): fix the file"),
            Category::Data | Category::Io => reason.to_owned(),
        };
        Error::invalid(format!("{file}: line {}, column {}", error.line(), error.column()), why)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<AuditSchema> {
        AuditSchema::parse(text.as_bytes(), "s.json")
    }

    fn error(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    #[test]
    fn values_land_where_their_keys_say() {
        let schema = parse(
            r#"{ "version": "1", "fileSizeInKb": { "maximum": 5 }, "materials": { "minimum": 1, "maximum": -1 },
                 "model": { "objectCount": { "nodes": { "maximum": 2 } }, "requireBeveledEdges": true },
                 "product": { "dimensions": { "width": { "minimum": 0.5, "percentTolerance": 3 } } },
                 "textures": { "pbrColorRange": { "minimum": 30 }, "requireDimensionsBePowersOfTwo": true },
                 "uvs": { "pixelsPerMeter": { "maximum": 9 }, "requireRangeZeroToOne": true } }"#,
        )
        .unwrap();
        assert_eq!(schema.file_size_in_kb, AuditRange { minimum: None, maximum: Some(5.0) });
        assert_eq!(schema.materials, AuditRange { minimum: Some(1.0), maximum: None });
        assert_eq!(schema.model.object_count.nodes.maximum, Some(2.0));
        assert!(schema.model.require_beveled_edges && !schema.model.require_manifold_edges);
        let width = schema.product.dimensions.width;
        assert_eq!((width.minimum, width.maximum, width.percent_tolerance), (Some(0.5), None, Some(3.0)));
        assert_eq!(schema.textures.pbr_color_range.minimum, Some(30.0));
        assert!(schema.textures.require_dimensions_be_powers_of_two && schema.uvs.require_range_zero_to_one);
        assert_eq!(schema.uvs.pixels_per_meter.maximum, Some(9.0));
    }

    #[test]
    fn wrong_schemas_are_refused_with_their_place() {
        let unknown = error("{ \"version\": \"1\",\n \"uvs\": { \"requireNotInvertd\": true } }");
        assert!(unknown.starts_with("s.json: line 2, column"), "{unknown}");
        assert!(
            unknown.contains("requireNotInvertd") && unknown.contains("`requireNotInverted`"),
            "{unknown}"
        );
        assert!(error("{}").contains("missing field `version`"));
        assert!(error(r#"{ "version": 1 }"#).contains("expected a string"));
        assert!(error(r#"{ "version": "1", "materials": { "maximum": "5" } }"#).contains("expected f64"));
        assert!(error(r#"{ "version": "1", "materials": { "maximum": -2 } }"#).contains("-2"));
        let crossed = error(r#"{ "version": "1", "materials": { "maximum": 1, "minimum": 2 } }"#);
        assert!(crossed.contains("minimum 2 is above the maximum 1"), "{crossed}");
        let crossed = r#"{ "version": "1", "product": { "dimensions": { "width": { "maximum": -3 } } } }"#;
        assert!(error(crossed).contains("-3"));
        assert!(error("{ \"version\": ").contains("the file is cut off"));
        assert!(error("version: 1").contains("not valid JSON"));
        assert!(error(r#"{ "version": "1", "version": "2" }"#).contains("duplicate"));
    }

    #[test]
    fn the_widest_gutter_counts() {
        let gutter = |text: &str| {
            let text = format!(r#"{{ "version": "1", "uvs": {{ "gutterWidth": {text} }} }}"#);
            parse(&text).unwrap().uvs.gutter_width.widest()
        };
        assert_eq!(gutter("{}"), None);
        assert_eq!(gutter(r#"{ "resolution256": -1, "resolution512": 0 }"#), None);
        let both = gutter(r#"{ "resolution256": 4, "resolution1024": 8 }"#);
        assert_eq!(both, Some(Gutter { pixels: 4.0, resolution: 256.0 }));
        let one = gutter(r#"{ "resolution4096": 8 }"#);
        assert_eq!(one, Some(Gutter { pixels: 8.0, resolution: 4096.0 }));
    }
}
