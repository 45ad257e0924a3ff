//! The dimensions of a product, with which its model is compared.

use super::schema::parse_json;
use crate::error::{Error, Result};
use serde::Deserialize;
use std::fmt::Display;

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
    /// [`Error::Invalid`] with line and column as for [`super::AuditSchema::parse`], or naming a dimension that is
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
