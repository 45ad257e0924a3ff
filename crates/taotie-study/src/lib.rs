//! The object and the numbers that demonstrate Taotie: a procedurally generated bronze *jue* with its demo pictures,
//! and the tables of Guo and Wang 2025, recomputed.
//!
//! ```
//! let mesh = taotie_study::jue::low_mesh();
//! assert_eq!(mesh.positions().len(), 251);
//! ```

pub mod demo;
pub mod jue;
pub mod paper;
