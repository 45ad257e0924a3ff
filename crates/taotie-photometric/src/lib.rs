//! Normals from photographs of one object from one position under changing light (photometric stereo), each with its
//! uncertainty in degrees.
//!
//! ```no_run
//! use taotie_engine::{Progress, Warnings};
//! use taotie_photometric::{Estimate, PhotographSet, Reading, Samples, Transfer};
//!
//! let mut warnings = Warnings::default();
//! let set = PhotographSet::open("coin/dome.lp".as_ref(), &mut warnings)?;
//! let reading = Reading { mask: None, transfer: Transfer::Auto, flat: None, limits: Default::default() };
//! let samples = Samples::read(&set, &reading, Progress::SILENT)?;
//! let estimate = Estimate::of(&samples, Progress::SILENT)?;
//! println!("mean uncertainty {:.2}°", estimate.mean(|pixel| pixel.sigma_deg));
//! # Ok::<(), taotie_engine::Error>(())
//! ```
//!
//! The camera is far away; light comes from far away or from lamps whose places are known. Estimates do not depend on
//! the number of threads.

mod appearance;
mod bilateral;
mod block;
mod calibration;
mod cells;
mod chroma;
mod circle;
mod depth;
mod diligent;
mod doubts;
mod estimate;
mod finish;
mod folder;
mod grey;
mod grid;
mod highlight;
mod indirect;
mod integrability;
mod lamp;
mod light;
mod lp;
mod materials;
mod multigrid;
mod options;
mod photograph;
mod plane;
mod program;
mod regions;
mod relief;
mod relight;
mod residuals;
mod robust;
mod samples;
mod scan;
mod set;
mod shift;
mod sources;
mod surface;
mod surfaces;
mod symmetric;
mod truth;
mod uncertainty;

pub use calibration::{Balls, Setup};
pub use circle::{Circle, Outline};
pub use depth::Relief;
pub use estimate::{Estimate, Estimator, PixelEstimate};
pub use folder::{input_files, is_photograph};
pub use integrability::Curl;
pub use light::{Light, note_behind, note_lengths};
pub use materials::{
    Frame, Lamp, LampPlace, Layout, Lens, MaterialEstimate, MaterialMaps, MaterialsEstimate, MaterialsInput,
    Model, PhotographResiduals, Pose, Texel, TexelEstimate, Transforms,
};
pub use options::{PhotometricOptions, marks_photographs};
pub use photograph::{Photograph, Sample, Transfer};
pub use program::Finish;
pub use relight::{Basis, Coefficients, ColorModel, ColorReader, Plane, Quality, RelightFormat, Relightable};
pub use residuals::{LightResiduals, Shift};
pub use samples::{Reading, Samples};
pub use scan::{Anchoring, ScanHeights};
pub use set::{PhotographSet, check_output};
pub use surfaces::RegionFinish;
pub use symmetric::Sym2;
pub use truth::{Coverage, averaged};
