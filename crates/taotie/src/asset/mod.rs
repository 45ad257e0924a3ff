//! From a scan to an asset and its proof: the whole workflow of the command.
//!
//! ```no_run
//! use taotie::Progress;
//! use taotie::asset::{BakeOptions, Baker, Packing, Requirement, Scan, VerifyOptions};
//! use taotie::Limits;
//!
//! # fn main() -> taotie::Result<()> {
//! let progress = Progress::SILENT;
//! let scan = Scan::read("scan.ply", &Limits::default(), progress)?;
//! let baker = Baker::new(BakeOptions { triangles: 20_000, size: 1024, ..BakeOptions::default() });
//! let asset = baker.bake(&scan, progress)?;
//! let written = asset.write("scan.glb", &Packing::default(), progress)?;
//! let proof = written.verify(scan, &VerifyOptions::default(), progress)?;
//! proof.require(&[Requirement::mean_angle_deg(2.0)])?;
//! # Ok(())
//! # }
//! ```
//!
//! [`Baker`], [`Scan`] and [`Asset`] own their data and can be sent to any thread. Each step takes a
//! [`Progress`](crate::Progress): its listener receives the stages, and cancelling takes effect within about 20 ms at
//! any point. Anything requested that cannot be done is an error or a counted warning.
//!
//! Its folders import from one another in one direction only: each from those before it.
//!
//! | folder | holds |
//! |---|---|
//! | `ask` | the request: figures, requirements, levels of detail, options |
//! | `source` | the scan, and the low-poly mesh with its material and cage |
//! | `bake` | the plan, the memory, the faults, and the asset with its maps |
//! | `search` | the smallest asset within the requirements, and coarser levels of detail |
//! | `write` | the files of an asset, with its provenance |
//! | `proof` | measuring what was written: figures, pictures, certificate, report |
//!
//! `search` and `write` do not see each other, and `proof` does not see `search`. [`Baker`] is above all but `proof`.

mod ask;
mod bake;
mod baker;
mod proof;
mod search;
mod source;
mod write;

pub use ask::{
    BakeOptions, Channels, Figure, FigureUnit, Lod, Looking, MeshSource, Packing, Preset, RayDistance,
    Requirement,
};
pub use bake::{Asset, MemoryEstimate, Misses, Range, SeparateMap, Textures, Trial};
pub use baker::Baker;
pub use proof::{
    BakeFigures, Beyond, Certificate, Coverage, Figures, HashedFile, HashedMap, KeyFigure, LevelFigures,
    MaterialFigures, PartFigures, PartFlip, PartKind, PatchPictures, Proof, ProofOptions, ProvedFile, Report,
    RequirementOutcome, Resolution, Signature, StageTime, Verdict, VerifyOptions, ViewFigures, Views,
    WorstParts, measure, verify,
};
pub use source::{Origin, Scan, ScanFile, ScanOptions, ScanSize, Simplification, into_metres};
pub use write::{Parameters, WrittenAsset, model_unit};
