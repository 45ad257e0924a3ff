//! The input files of the Khronos glTF Asset Auditor: the schema, with the checks that an audit runs and their
//! limits, and the product info, with whose dimensions the model is compared.

use super::check::AuditRange;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::error::Category;
use std::fmt::Display;
use taotie_engine::error::{Error, Result};

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
    #[serde(deserialize_with = "super::check::limit")]
    pub maximum: Option<f64>,
    #[serde(deserialize_with = "super::check::limit")]
    pub minimum: Option<f64>,
    /// Per cent of the product's dimension; without it the match must be exact.
    #[serde(deserialize_with = "super::check::limit")]
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
    #[serde(deserialize_with = "super::check::limit")]
    resolution256: Option<f64>,
    #[serde(deserialize_with = "super::check::limit")]
    resolution512: Option<f64>,
    #[serde(deserialize_with = "super::check::limit")]
    resolution1024: Option<f64>,
    #[serde(deserialize_with = "super::check::limit")]
    resolution2048: Option<f64>,
    #[serde(deserialize_with = "super::check::limit")]
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
fn parse_json<T: DeserializeOwned>(bytes: &[u8], file: impl Display) -> Result<T> {
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

/// The product info of the Khronos glTF Asset Auditor: the dimensions of the product that a model shows.
///
/// ```
/// use taotie::inspection::ProductInfo;
///
/// let text = r#"{ "dimensions": { "length": 0.4, "width": 0.4, "height": 1.1 } }"#;
/// assert!(ProductInfo::parse(text.as_bytes(), "vase.json").is_ok());
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProductInfo {
    pub(super) dimensions: ProductDimensions,
}

/// The dimensions of a product, in metres; missing ones are not compared.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ProductDimensions {
    pub length: Option<f64>,
    pub width: Option<f64>,
    pub height: Option<f64>,
}

impl ProductInfo {
    /// Reads product info from the bytes of a JSON file; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::Invalid`] with line and column as for [`AuditSchema::parse`], or naming a dimension that is
    /// not above 0, or if there are none.
    pub fn parse(bytes: &[u8], file: impl Display) -> Result<Self> {
        let info: Self = parse_json(bytes, &file)?;
        let ProductDimensions { length, width, height } = info.dimensions;
        let given = || [length, width, height].into_iter().flatten();
        if given().next().is_none() {
            let why = "missing: specify length, width or height in metres";
            return Err(Error::invalid(format!("{file}: dimensions"), why));
        }
        match given().find(|dimension| *dimension <= 0.0) {
            Some(wrong) => {
                let why = "invalid: dimensions must be above 0, in metres; omit unknown ones";
                Err(Error::invalid(format!("{file}: dimension {wrong}"), why))
            }
            None => Ok(info),
        }
    }
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

    #[test]
    fn dimensions_are_above_zero() {
        let parse = |text: &str| ProductInfo::parse(text.as_bytes(), "p.json");
        let error = |text: &str| parse(text).unwrap_err().to_string();
        let info = parse(r#"{ "dimensions": { "length": 1, "height": 2.5 } }"#).unwrap();
        let expected = ProductDimensions { length: Some(1.0), width: None, height: Some(2.5) };
        assert_eq!(info.dimensions, expected);
        assert!(error(r#"{ "dimensions": { "length": 0 } }"#).contains("dimension 0"));
        assert!(error(r#"{ "dimensions": {} }"#).contains("missing"));
        assert!(error(r#"{ "dimension": {} }"#).contains("unknown field `dimension`"));
        assert!(error("{}").contains("missing field `dimensions`"));
    }
}
