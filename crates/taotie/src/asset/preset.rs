//! Targets and ceilings for common uses of an asset.

use super::figure::Figure;
use super::lod::Lod;
use super::requirement::Requirement;
use crate::io::CodecKind;
use crate::names::Named;

/// A use of an asset: how close it must be to its scan, and how many device resources it may take.
///
/// ```
/// use taotie::asset::{BakeOptions, Preset};
///
/// let engine = Preset::Engine;
/// let (goal, images, lods) = (Some(engine.requirements()), engine.images(), engine.lods());
/// let options = BakeOptions { goal, images, lods, ..BakeOptions::default() };
/// assert!(options.check().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// Pages that load on a phone: 1° on average, at most 100,000 triangles and 80 MB on the graphics card.
    Web,
    /// Access copies of a collection: 0.1° on average, without ceilings.
    Archive,
    /// Real-time engines: 0.5° on average, at most 50,000 triangles and 32 MB on the graphics card, textures in KTX2,
    /// levels of detail for 256, 128 and 64 pixels across.
    Engine,
}

impl Named for Preset {
    const WHAT: &'static str = "preset";
    const NAMES: &'static [(&'static str, Self)] =
        &[("web", Self::Web), ("archive", Self::Archive), ("engine", Self::Engine)];
}

impl Preset {
    /// Returns the maximum differences and the ceilings.
    pub fn requirements(self) -> Vec<Requirement> {
        let ceilings = |triangles: f64, megabytes: f64| {
            let gpu_memory = Requirement::of(Figure::GpuMemory, megabytes * 1e6);
            vec![Requirement::of(Figure::Triangles, triangles), gpu_memory]
        };
        match self {
            Self::Web => {
                [Requirement::as_seen([1.0, 4.0], [1.0, 3.0, 6.0]), ceilings(100_000.0, 80.0)].concat()
            }
            Self::Archive => Requirement::as_seen([0.1, 0.4], [0.2, 0.5, 1.0]),
            Self::Engine => [Requirement::visually_lossless(), ceilings(50_000.0, 32.0)].concat(),
        }
    }

    /// Returns the coarser levels of detail.
    pub fn lods(self) -> Vec<Lod> {
        match self {
            Self::Web | Self::Archive => Vec::new(),
            Self::Engine => [256, 128, 64].map(Lod::Pixels).to_vec(),
        }
    }

    /// Returns the image formats to choose from; empty for those of the codec set.
    pub fn images(self) -> Vec<CodecKind> {
        match self {
            Self::Web | Self::Archive => Vec::new(),
            Self::Engine => vec![CodecKind::Ktx2],
        }
    }
}
