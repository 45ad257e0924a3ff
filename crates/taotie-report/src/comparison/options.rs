//! The options for the files of a comparison.

use serde_json::Value;

/// The options for the files of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The heading of the page.
    pub title: String,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top_deg: f64,
    /// The choice of material, repeated in `report.json`; null if there is none.
    pub material: Value,
    /// The choice of environment, repeated in `report.json`; null if there is none.
    pub environment: Value,
    /// Also writes normals and angular errors as OpenEXR: unencoded unit vectors in world space, and degrees.
    pub exr: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            title: "Comparison".into(),
            heat_top_deg: 30.0,
            material: Value::Null,
            environment: Value::Null,
            exr: false,
        }
    }
}
