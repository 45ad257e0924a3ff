//! Changes of chunks: those of PNG, RIFF (WebP) and GLB; and the repair of lengths and checksums after a change, so
//! that readers look further.

use fastrand::Rng;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A change of chunks, which are numbered from 0; missing chunks are ignored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChunkChange {
    /// Removes a chunk.
    Remove {
        /// The chunk.
        chunk: usize,
    },
    /// Inserts a copy of one chunk before another.
    Copy {
        /// The chunk.
        from: usize,
        /// The chunk that the copy is inserted before.
        to: usize,
    },
    /// Writes a 32-bit integer into a chunk, header included.
    Word {
        /// The chunk.
        chunk: usize,
        /// The offset from its start, in bytes.
        at: usize,
        /// The integer, in the format's byte order.
        value: u32,
    },
}

impl ChunkChange {
    /// Chooses a change; `None` for a file without chunks.
    pub fn choose(rng: &mut Rng, bytes: &[u8]) -> Option<Self> {
        let chunks = chunks(bytes);
        let chunk = rng.usize(..chunks.len().max(1));
        let length = chunks.get(chunk)?.len();
        Some(match rng.u8(..6) {
            0 => Self::Remove { chunk },
            1 => Self::Copy { from: chunk, to: rng.usize(..chunks.len()) },
            _ => {
                let at = rng.usize(..length.min(40)) / 4 * 4;
                Self::Word { chunk, at, value: super::bytes::extreme(rng) as u32 }
            }
        })
    }

    /// Applies the change to the chunks of `bytes`.
    pub fn apply(&self, bytes: &mut Vec<u8>) {
        let chunks = chunks(bytes);
        match *self {
            Self::Remove { chunk } => {
                if let Some(range) = chunks.get(chunk) {
                    bytes.drain(range.clone());
                }
            }
            Self::Copy { from, to } => {
                if let (Some(from), Some(to)) = (chunks.get(from), chunks.get(to)) {
                    let copied = bytes[from.clone()].to_vec();
                    bytes.splice(to.start..to.start, copied);
                }
            }
            Self::Word { chunk, at, value } => {
                let big = bytes.starts_with(PNG);
                let digits = if big { value.to_be_bytes() } else { value.to_le_bytes() };
                if let Some(range) = chunks.get(chunk) {
                    let place = bytes[range.clone()].iter_mut().skip(at);
                    place.zip(digits).for_each(|(byte, digit)| *byte = digit);
                }
            }
        }
    }
}

/// The signature of PNG.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Returns the ranges of a file's chunks, headers and checksums included; none for other formats. The last may be cut
/// off.
fn chunks(bytes: &[u8]) -> Vec<Range<usize>> {
    if bytes.starts_with(PNG) {
        return walk(bytes, PNG.len(), |head| {
            12 + u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize
        });
    }
    if bytes.starts_with(b"RIFF") {
        let length = |head: [u8; 8]| u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        return walk(bytes, 12, |head| 8 + length(head).next_multiple_of(2));
    }
    if bytes.starts_with(b"glTF") {
        return walk(bytes, 12, |head| 8 + u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize);
    }
    Vec::new()
}

/// Returns the chunks from `begin`, whose lengths `length` reads from their first eight bytes.
fn walk(bytes: &[u8], begin: usize, length: impl Fn([u8; 8]) -> usize) -> Vec<Range<usize>> {
    let (mut at, mut found) = (begin, Vec::new());
    while let Some(head) = bytes.get(at..at + 8) {
        let head: [u8; 8] = std::array::from_fn(|i| head[i]);
        let end = at.saturating_add(length(head)).min(bytes.len());
        found.push(at..end);
        at = end;
    }
    found
}

/// The signature of cached environments, and the offsets of their checksum and of the data it covers.
const ENVIRONMENT: &[u8] = b"taotie\0E";
const SUM: usize = 12;
const SUMMED: usize = 16;

/// Returns `true` if [`repair`] supports the container.
pub fn is_container(bytes: &[u8]) -> bool {
    [PNG, b"RIFF", b"glTF", ENVIRONMENT].iter().any(|signature| bytes.starts_with(signature))
}

/// Corrects the checksums of PNG chunks and of cached environments, and the length field of GLB and RIFF.
pub fn repair(bytes: &mut [u8]) {
    let length = bytes.len();
    if bytes.starts_with(PNG) {
        for chunk in chunks(bytes).into_iter().filter(|chunk| chunk.len() >= 12) {
            let sum = crc32fast::hash(&bytes[chunk.start + 4..chunk.end - 4]);
            bytes[chunk.end - 4..chunk.end].copy_from_slice(&sum.to_be_bytes());
        }
    } else if bytes.starts_with(b"RIFF") && length >= 8 {
        bytes[4..8].copy_from_slice(&((length - 8) as u32).to_le_bytes());
    } else if bytes.starts_with(b"glTF") && length >= 12 {
        bytes[8..12].copy_from_slice(&(length as u32).to_le_bytes());
    } else if bytes.starts_with(ENVIRONMENT) && length >= SUMMED {
        let sum = crc32fast::hash(&bytes[SUMMED..]);
        bytes[SUM..SUMMED].copy_from_slice(&sum.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_found_and_changed() {
        let chunk = |name: &[u8; 4], value: u8| [&[0, 0, 0, 1], &name[..], &[value], &[9; 4]].concat();
        let sound = [PNG, &chunk(b"IHDR", 1), &chunk(b"IDAT", 2)].concat();
        assert_eq!(chunks(&sound), [8..21, 21..34]);
        let changed = |change: ChunkChange| {
            let mut bytes = sound.clone();
            change.apply(&mut bytes);
            bytes
        };
        assert_eq!(changed(ChunkChange::Remove { chunk: 0 }), [PNG, &chunk(b"IDAT", 2)].concat());
        assert_eq!(changed(ChunkChange::Copy { from: 1, to: 0 })[8..21], chunk(b"IDAT", 2));
        let word = changed(ChunkChange::Word { chunk: 1, at: 0, value: 0x0102_0304 });
        assert_eq!(word[21..25], [1, 2, 3, 4]);
        assert!(chunks(b"v 0 0 0").is_empty());
    }

    /// The empty chunk at the end of every PNG, whose checksum is known.
    #[test]
    fn sums_and_lengths_are_right_afterwards() {
        let mut png = [PNG, b"\0\0\0\0IEND\0\0\0\0"].concat();
        repair(&mut png);
        assert_eq!(png[16..], [0xae, 0x42, 0x60, 0x82]);
        let mut glb = b"glTF\x02\0\0\0\xff\xff\xff\xff".to_vec();
        repair(&mut glb);
        assert_eq!(glb[8..], [12, 0, 0, 0]);
        let mut riff = b"RIFF\0\0\0\0WEBP".to_vec();
        repair(&mut riff);
        assert_eq!(riff[4..8], [4, 0, 0, 0]);
    }
}
