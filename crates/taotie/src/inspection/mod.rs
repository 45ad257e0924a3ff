//! The content and faults of a model file, as data.
//!
//! ```no_run
//! use taotie::inspection::{Hint, Inspection};
//!
//! let inspection = Inspection::of(&taotie::io::load_model("statue.glb".as_ref())?);
//! for hint in inspection.hints() {
//!     if let Hint::OtherGreen { material, by_pixels, .. } = hint {
//!         println!("{material}: green points {by_pixels:?}");
//!     }
//! }
//! # Ok::<(), taotie::Error>(())
//! ```

mod audit;
mod hints;
mod layers;
mod material;
mod mesh;
mod normal_map;
mod report;
mod tangents;
mod uvs;

pub use audit::{Audit, AuditSchema, Check, CheckResult, CheckStatus, ProductInfo, audit_bytes};
pub use hints::Hint;
pub use layers::{AnisotropyReport, ClearcoatReport, LayersReport, SheenReport, SpecularReport};
pub use material::{ClassicReport, MaterialReport, TextureReport};
pub use mesh::{MeshReport, Normals};
pub use normal_map::{NormalMapReport, Pixels};
pub use report::{AnimationReport, Counted, Counts, Extent, Inspection, Listed};
pub use tangents::{Agreement, TangentHealth};
pub use uvs::UvHealth;
