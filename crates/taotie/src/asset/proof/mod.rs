//! The proof: an asset as its files show it, measured against its scan, with figures, pictures, problems, a
//! certificate and a report.

mod certificate;
mod figures;
mod findings;
mod measurement;
mod outcome;
mod pictures;
mod report;
mod shown;
mod verification;

pub use certificate::{
    Certificate, HashedFile, HashedMap, KeyFigure, ProofOptions, ProvedFile, Signature, Verdict,
};
pub use figures::{
    Beyond, Coverage, Figures, LevelFigures, MaterialFigures, PartFigures, Resolution, ViewFigures,
    WorstParts,
};
pub use measurement::{VerifyOptions, measure};
pub use outcome::RequirementOutcome;
pub use pictures::{PartFlip, PartKind, PatchPictures, Views};
pub use report::{BakeFigures, Report, StageTime};
pub use verification::{Proof, verify};
