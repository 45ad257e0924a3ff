//! The image formats available to a search.

use crate::io::{CodecKind, CodecSet, ImageCodec};

/// Candidate qualities, in ascending order.
const WEBP: [u8; 9] = [20, 35, 50, 65, 75, 82, 88, 93, 97];
const JPEG: [u8; 9] = [40, 55, 70, 80, 86, 90, 94, 96, 98];
const AVIF: [u8; 9] = [30, 42, 54, 65, 75, 82, 88, 93, 97];
/// Candidate λ of KTX2, from the most lossy down.
const KTX2: [u8; 5] = [12, 6, 3, 1, 0];

/// The image formats available to a search.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Codecs {
    kinds: Vec<CodecKind>,
    /// The codec set, which determines the extension for packed geometry.
    pub set: CodecSet,
}

impl Codecs {
    /// Takes the allowed kinds, without those that this build cannot write; those of the set if none are given.
    pub fn new(kinds: &[CodecKind], set: CodecSet) -> Self {
        let kinds = if kinds.is_empty() { set.images() } else { kinds };
        let can_write = |kind: &CodecKind| match kind {
            CodecKind::WebP => cfg!(feature = "webp"),
            CodecKind::Avif => cfg!(feature = "avif"),
            CodecKind::Png | CodecKind::Jpeg | CodecKind::Ktx2 => true,
        };
        let mut kinds: Vec<CodecKind> = kinds.iter().copied().filter(can_write).collect();
        if kinds.is_empty() {
            kinds.push(CodecKind::Png);
        }
        Self { kinds, set }
    }

    /// Returns `true` if images of a kind may be kept as is.
    pub fn allows(&self, kind: CodecKind) -> bool {
        self.kinds.contains(&kind)
    }

    /// Returns the maximum bytes of a texel on a graphics card.
    pub fn bytes_per_texel(&self) -> f64 {
        if self.kinds == [CodecKind::Ktx2] { 1.0 } else { 4.0 }
    }

    /// Returns the smallest lossless format; `None` if all are lossy.
    pub fn lossless(&self) -> Option<ImageCodec> {
        let both = [(CodecKind::WebP, ImageCodec::WebP), (CodecKind::Png, ImageCodec::Png)];
        both.into_iter().find(|(kind, _)| self.kinds.contains(kind)).map(|(_, codec)| codec)
    }

    /// Returns the format with the least loss.
    pub fn least_lossy(&self) -> ImageCodec {
        self.lossless()
            .or_else(|| self.ladders().find_map(|ladder| ladder.last().copied()))
            .unwrap_or_default()
    }

    /// Returns the lossy formats of each kind, starting with the most lossy.
    pub fn ladders(&self) -> impl Iterator<Item = Vec<ImageCodec>> {
        let ladder = |kind: &CodecKind| match kind {
            CodecKind::Png => Vec::new(),
            CodecKind::Jpeg => JPEG.map(ImageCodec::Jpeg).into(),
            CodecKind::WebP => WEBP.map(ImageCodec::LossyWebP).into(),
            CodecKind::Avif => AVIF.map(ImageCodec::Avif).into(),
            CodecKind::Ktx2 => KTX2.map(ImageCodec::Ktx2).into(),
        };
        self.kinds.iter().map(ladder).filter(|ladder| !ladder.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_set_has_a_format_that_loses_least() {
        let least = |kinds: &[CodecKind]| Codecs::new(kinds, CodecSet::Portable).least_lossy();
        assert_eq!(least(&[CodecKind::Ktx2]), ImageCodec::Ktx2(0));
        assert_eq!(least(&[CodecKind::Jpeg]), ImageCodec::Jpeg(98));
        assert_eq!(least(&[CodecKind::Jpeg, CodecKind::Png]), ImageCodec::Png);
        #[cfg(feature = "webp")]
        assert_eq!(least(&[]), ImageCodec::WebP);
    }
}
