//! The content and faults of a model file, as data.
//!
//! ```no_run
//! use taotie::inspection::{Hint, Inspection};
//!
//! let inspection = Inspection::of(&taotie::load_model("statue.glb")?);
//! for hint in inspection.hints() {
//!     if let Hint::OtherGreen { material, by_pixels, .. } = hint {
//!         println!("{material}: green points {by_pixels:?}");
//!     }
//! }
//! # Ok::<(), taotie::Error>(())
//! ```

mod audit;
mod material;
mod mesh;
mod report;

pub use audit::{Audit, AuditSchema, Check, CheckStatus, ProductInfo};
pub use material::{LayerReport, MaterialReport, NormalMapReport, Pixels, TextureReport};
pub use mesh::{Agreement, MeshReport, Normals, TangentHealth};
pub use report::{AnimationReport, Counts, Extent, Hint, Inspection, Listed};
