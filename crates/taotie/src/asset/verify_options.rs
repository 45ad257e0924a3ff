//! The options of a proof.

use super::requirement::Requirement;
use crate::error::{Error, Result};

/// The options of a proof. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Proof, Requirement, Scan, VerifyOptions, WrittenAsset};
/// use taotie::{Progress, Result};
///
/// /// Measures at as many points as needed to decide whether the mean angle is at most 1°.
/// fn verify_to_one_degree(written: &WrittenAsset, scan: Scan) -> Result<Proof> {
///     let requirements = vec![Requirement::mean_angle_deg(1.0)];
///     written.verify(scan, &VerifyOptions { requirements, ..VerifyOptions::default() }, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct VerifyOptions {
    /// Pixels of the overview, and points of each surface, at which scan and asset are initially compared, at least
    /// 10. If a requirement's limit lies within the interval of the result, more are used, up to 4 million.
    pub points: usize,
    /// The maximum number of texels along a side of the error maps; no more than the maps have, and 0 makes none. No
    /// figure depends on it.
    pub map: u32,
    /// Pixels along a side of the images from all sides, at least 11.
    pub view: u32,
    /// Pixels along a side of the pictures of the worst patches; 0 takes none. No figure depends on it.
    pub patch_view: u32,
    /// The requirements that the figures must decide.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub requirements: Vec<Requirement>,
}

impl Default for VerifyOptions {
    /// 20,000 points, a map of 1024² and images of 384², no pictures of patches, no requirements.
    fn default() -> Self {
        Self { points: 20_000, map: 1024, view: 384, patch_view: 0, requirements: Vec::new() }
    }
}

/// Refuses out-of-range options.
pub(super) fn check(options: &VerifyOptions) -> Result<()> {
    let wrong = |what: &str, why: &str| Err(Error::invalid(what, why));
    match options {
        VerifyOptions { points: 0..10, .. } => wrong("points of the proof", "use at least 10"),
        VerifyOptions { view: 0..11, .. } => wrong("pictures from all sides", "use at least 11 pixels"),
        VerifyOptions { patch_view: 4097.., .. } => {
            wrong("pictures of the worst patches", "use at most 4096 pixels")
        }
        _ => Ok(()),
    }
}
