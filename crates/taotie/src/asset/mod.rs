//! From a scan to an asset and its proof: the whole workflow of the command.
//!
//! ```no_run
//! use taotie::Progress;
//! use taotie::asset::{BakeOptions, Baker, Limits, Packing, Requirement, Scan, VerifyOptions};
//!
//! # fn main() -> taotie::Result<()> {
//! let progress = Progress::SILENT;
//! let scan = Scan::read("scan.ply", &Limits::default(), progress)?;
//! let baker = Baker::new(BakeOptions { triangles: 20_000, size: 1024, ..BakeOptions::default() });
//! let asset = baker.bake(&scan, progress)?;
//! let written = asset.write("scan.glb", &Packing::default(), progress)?;
//! let proof = written.verify(scan, &VerifyOptions::default(), progress)?;
//! for met in proof.require(&[Requirement::mean_angle_deg(2.0)]) {
//!     assert!(met.met, "{met:?}");
//! }
//! # Ok(())
//! # }
//! ```
//!
//! [`Baker`], [`Scan`] and [`Asset`] own their data and can be sent to any thread. Each step takes a
//! [`Progress`](crate::Progress): its listener receives the stages, and cancelling takes effect within about 20 ms at
//! any point. Anything requested that cannot be done is an error or a counted warning.

mod baker;
mod beyond;
mod carried;
mod certificate;
mod certified_files;
mod close_ups;
mod detail;
mod document;
mod extent;
mod figure;
mod figure_words;
mod figures;
mod findings;
mod given;
mod green;
mod hash;
mod inputs;
mod judgement;
mod kept_textures;
mod level_figures;
mod lod;
mod look;
mod low;
mod low_file;
mod made;
mod map_note;
mod map_numbers;
mod map_side;
mod maps;
mod maps_alone;
mod material_figures;
mod measured_model;
mod measurement;
mod memory;
mod met;
mod metalness;
mod misses;
mod named_requirements;
mod notes;
mod object_map;
mod options;
mod packing;
mod parameters;
mod part_figures;
mod part_flip;
mod patch_pictures;
mod plan;
mod preset;
mod proof;
mod property;
mod provenance;
mod regions;
mod report;
mod requirement;
mod requirement_level;
mod requirement_text;
mod scan;
mod scan_green;
mod scan_normals;
mod scan_options;
mod scan_size;
mod scan_winding;
mod screen;
mod search;
mod seen;
mod shown;
mod slots;
mod space;
mod stripped;
mod textures;
mod unlit;
mod unseen;
mod verify_options;
mod view_figures;
mod views;
mod within;
mod worst_places;
mod write;

pub use crate::io::{Bytes, Limits};
pub use baker::Baker;
pub use beyond::Beyond;
pub use certificate::{Certificate, KeyFigure, ProofOptions, ProvedFile, Signature, Verdict};
pub use certified_files::{HashedFile, HashedMap};
pub use figure::{Figure, FigureUnit};
pub use figure_words::Looking;
pub use figures::{Figures, FitFigures};
pub use level_figures::{BIN_WIDTH, Coverage, LevelFigures, Resolution, WorstPatches};
pub use lod::Lod;
pub use low::{Origin, Simplification};
pub use made::Asset;
pub use map_note::MapNote;
pub use map_side::AUTO_SIZE;
pub use material_figures::MaterialFigures;
pub use measured_model::measure;
pub use memory::MemoryEstimate;
pub use met::RequirementOutcome;
pub use misses::Misses;
pub use options::{BakeOptions, MeshSource, RayDistance};
pub use packing::Packing;
pub use parameters::{Parameters, model_unit};
pub use part_figures::PartFigures;
pub use part_flip::{PartFlip, PartKind};
pub use patch_pictures::PatchPictures;
pub use plan::DroppedProperty;
pub use preset::Preset;
pub use proof::{FLOOR_8_BIT, Proof, verify};
pub use regions::WorstParts;
pub use report::{BakeFigures, Report, StageTime, Warning};
pub use requirement::Requirement;
pub use scan::{Scan, ScanFile};
pub use scan_options::ScanOptions;
pub use scan_size::ScanSize;
pub use search::Trial;
pub use space::into_metres;
pub use textures::{MapPresence, Range, SeparateMap, Textures};
pub use verify_options::VerifyOptions;
pub use view_figures::ViewFigures;
pub use views::Views;
pub use write::WrittenAsset;
