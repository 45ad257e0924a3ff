//! The audit of a model by a schema of the Khronos glTF Asset Auditor.
//!
//! ```no_run
//! use taotie::inspection::{Audit, AuditSchema};
//! use taotie_io;
//!
//! let schema = AuditSchema::parse(&taotie_io::read_bytes("schema.json".as_ref())?, "schema.json")?;
//! let audit = Audit::of(&taotie_io::load_model("vase.glb".as_ref())?, &schema, None)?;
//! for failed in audit.failed() {
//!     println!("{:?}: {}", failed.name, failed.message);
//! }
//! # Ok::<(), taotie::Error>(())
//! ```

mod check;
mod model;
mod schema;
mod textures;
mod uv_raster;
mod uvs;

pub use check::{Check, CheckResult, CheckStatus};
pub use schema::{AuditSchema, ProductInfo};

use taotie_engine::Warning;
use taotie_engine::error::Result;
use taotie_engine::scene::Scene;
use taotie_io::Loaded;
use uv_raster::MOST_SIDE;

/// The results of an audit.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Audit {
    /// The version stated in the schema.
    pub schema_version: String,
    /// True if no check failed.
    pub passed: bool,
    /// One result per check, in the order of the auditor's report.
    pub checks: Vec<CheckResult>,
    /// Content that was skipped or corrected on reading; the checks do not see it.
    pub warnings: Vec<Warning>,
}

impl Audit {
    /// Audits a loaded model; `product` gives the dimensions of the product that it shows.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Limit`] if UVs of a mesh of 2³¹ triangles must be checked.
    pub fn of(loaded: &Loaded, schema: &AuditSchema, product: Option<&ProductInfo>) -> Result<Self> {
        let scene = &loaded.scene;
        let mut checks = vec![CheckResult::not_tested(
            Check::GltfValidator,
            "not part of a schema; run the Khronos glTF validator",
        )];
        checks.extend(model::counts(loaded, schema));
        checks.extend(model::edges(scene, &schema.model));
        checks.extend(model::dimensions(scene, &schema.product.dimensions, product));
        checks.extend(textures::results(loaded, &schema.textures));
        checks.extend(textures::texel_density(scene, schema.uvs.pixels_per_meter));
        checks.extend(uvs::results(scene, &schema.uvs)?);
        Ok(Self {
            schema_version: schema.version().to_owned(),
            passed: checks.iter().all(|check| check.status != CheckStatus::Fail),
            warnings: loaded.warnings.list(),
            checks,
        })
    }

    /// Returns an upper bound of the memory in bytes that an audit of `scene` needs in addition to it.
    pub fn memory(scene: &Scene, schema: &AuditSchema) -> u64 {
        /// Per texel: its triangle, and its island twice or the island nearest to it.
        const TEXEL: u64 = 16;
        /// Per triangle: its edges, or its uvs and those of its island.
        const TRIANGLE: u64 = 192;
        let largest = scene.meshes().iter().map(|mesh| mesh.triangles().len() as u64).max().unwrap_or(0);
        let is_drawn = schema.uvs.require_not_overlapping || schema.uvs.gutter_width.widest().is_some();
        let texels = if is_drawn { u64::from(MOST_SIDE) * u64::from(MOST_SIDE) } else { 0 };
        largest * TRIANGLE + texels * TEXEL
    }

    /// Returns the checks that failed.
    pub fn failed(&self) -> impl Iterator<Item = &CheckResult> {
        self.checks.iter().filter(|check| check.status == CheckStatus::Fail)
    }
}

#[cfg(test)]
mod tests;
