//! Codec sets: how recent a program must be to open an asset.

use super::codec::CodecKind;
use crate::names::Named;

/// The codecs that an asset may require.
///
/// ```
/// use taotie::names::Named;
/// use taotie::io::{CodecKind, CodecSet};
///
/// assert!(CodecSet::WebLatest.images().contains(&CodecKind::Avif));
/// assert_eq!(CodecSet::from_name("portable")?, CodecSet::default());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum CodecSet {
    /// Supported by most programs: PNG, JPEG and WebP; EXT_meshopt_compression.
    #[default]
    Portable,
    /// Supported by the newest web viewers: AVIF as well; KHR_meshopt_compression, whose vertices take fewer bytes.
    /// EXT_texture_avif is not ratified, and KHR_meshopt_compression is a release candidate.
    WebLatest,
}

impl Named for CodecSet {
    const WHAT: &'static str = "set of codecs";
    const NAMES: &'static [(&'static str, Self)] =
        &[("portable", Self::Portable), ("web-latest", Self::WebLatest)];
}

impl CodecSet {
    /// Returns the image formats of the set.
    pub fn images(self) -> &'static [CodecKind] {
        match self {
            Self::Portable => &[CodecKind::Png, CodecKind::Jpeg, CodecKind::WebP],
            Self::WebLatest => &[CodecKind::Png, CodecKind::Jpeg, CodecKind::WebP, CodecKind::Avif],
        }
    }

    /// Returns the geometry compression extension.
    pub(super) fn meshopt(self) -> &'static str {
        match self {
            Self::Portable => "EXT_meshopt_compression",
            Self::WebLatest => "KHR_meshopt_compression",
        }
    }

    /// Returns the version of meshoptimizer's vertex codec that this extension allows.
    pub(super) fn vertex_version(self) -> i32 {
        match self {
            Self::Portable => 0,
            Self::WebLatest => 1,
        }
    }
}
