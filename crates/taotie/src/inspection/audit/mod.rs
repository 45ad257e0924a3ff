//! The audit of a model by a schema of the Khronos glTF Asset Auditor.
//!
//! ```no_run
//! use taotie::inspection::{Audit, AuditSchema};
//! use taotie::io;
//!
//! let schema = AuditSchema::parse(&io::read_bytes("schema.json".as_ref())?, "schema.json")?;
//! let audit = Audit::of(&io::load_model("vase.glb".as_ref())?, &schema, None)?;
//! for failed in audit.failed() {
//!     println!("{:?}: {}", failed.name, failed.message);
//! }
//! # Ok::<(), taotie::Error>(())
//! ```

mod audited;
mod check;
mod counts;
mod dimensions;
mod distance;
mod edges;
mod gutter;
mod overlap;
mod product_info;
mod range;
mod schema;
#[cfg(test)]
mod tests;
mod texel_density;
mod textures;
mod uv_raster;
mod uvs;
mod words;

pub use audited::{Audit, audit_bytes};
pub use check::{Check, CheckResult, CheckStatus};
pub use product_info::ProductInfo;
pub use schema::AuditSchema;
