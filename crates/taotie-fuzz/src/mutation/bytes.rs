//! Changes of bytes, regardless of their meaning.

use fastrand::Rng;
use serde::{Deserialize, Serialize};

/// The largest size of a file after a change.
const MOST: usize = 1 << 24;
/// The size of a typical header.
const HEAD: usize = 256;

/// A change of bytes. Positions beyond the end are ignored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ByteChange {
    /// Truncates the file.
    Truncate {
        /// The number of bytes kept.
        at: usize,
    },
    /// Flips one bit.
    Flip {
        /// The byte.
        at: usize,
        /// The bit; 0 is the lowest.
        bit: u8,
    },
    /// Writes an integer.
    Word {
        /// Its first byte.
        at: usize,
        /// Its number of bytes, 1 to 8.
        width: usize,
        /// `true` for big-endian order.
        big: bool,
        /// The integer, truncated to its lowest bytes.
        value: u64,
    },
    /// Removes bytes.
    Remove {
        /// The first byte.
        at: usize,
        /// Their number.
        count: usize,
    },
    /// Copies bytes and inserts the copy elsewhere.
    Copy {
        /// The first byte.
        from: usize,
        /// Their number.
        count: usize,
        /// The byte that they are inserted before.
        to: usize,
    },
}

impl ByteChange {
    /// Chooses a change of a file of `length` bytes; every second one is in its header.
    pub fn choose(rng: &mut Rng, length: usize) -> Self {
        let mut place = || {
            let within = if rng.bool() { length.min(HEAD) } else { length };
            rng.usize(..within.max(1))
        };
        let (at, to) = (place(), place());
        match rng.u8(..8) {
            0 => Self::Truncate { at },
            1 => Self::Flip { at, bit: rng.u8(..8) },
            2 => Self::Remove { at, count: rng.usize(1..16) },
            3 => Self::Copy { from: at, count: rng.usize(1..64), to },
            _ => Self::word(rng, at),
        }
    }

    /// Chooses an integer at the position `at`, usually an aligned one.
    fn word(rng: &mut Rng, at: usize) -> Self {
        let width = 1 << rng.u32(..4);
        let at = if rng.u8(..4) > 0 { at / width * width } else { at };
        Self::Word { at, width, big: rng.bool(), value: extreme(rng) }
    }

    /// Applies the change to `bytes`.
    pub fn apply(&self, bytes: &mut Vec<u8>) {
        let length = bytes.len();
        match *self {
            Self::Truncate { at } => bytes.truncate(at),
            Self::Flip { at, bit } => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << (bit % 8);
                }
            }
            Self::Word { at, width, big, value } => write_word(bytes, at, &digits(width, big, value)),
            Self::Remove { at, count } => drop(bytes.drain(at.min(length)..end(at, count, length))),
            Self::Copy { from, count, to } => {
                let copied = bytes[from.min(length)..end(from, count, length)].to_vec();
                if to <= length && length + copied.len() <= MOST {
                    bytes.splice(to..to, copied);
                }
            }
        }
    }
}

/// Returns the end of `count` bytes from `at`, in a file of `length` bytes.
fn end(at: usize, count: usize, length: usize) -> usize {
    at.saturating_add(count).min(length)
}

/// Returns the bytes of an integer.
fn digits(width: usize, big: bool, value: u64) -> Vec<u8> {
    let mut digits = value.to_le_bytes()[..width.min(8)].to_vec();
    if big {
        digits.reverse();
    }
    digits
}

/// Overwrites bytes from `at`, as far as the file extends.
fn write_word(bytes: &mut [u8], at: usize, digits: &[u8]) {
    bytes.iter_mut().skip(at).zip(digits).for_each(|(byte, digit)| *byte = *digit);
}

/// Chooses an integer at or near the end of some range, a small one, or any.
pub fn extreme(rng: &mut Rng) -> u64 {
    match rng.u8(..4) {
        0 => rng.u64(..17),
        1 => rng.u64(..),
        2 => (1u64 << rng.u32(..64)).wrapping_add(rng.u64(..3)).wrapping_sub(1),
        _ => u64::MAX >> rng.u32(..64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_change_does_what_it_says() {
        let changed = |change: ByteChange| {
            let mut bytes = vec![1, 2, 3, 4];
            change.apply(&mut bytes);
            bytes
        };
        assert_eq!(changed(ByteChange::Truncate { at: 2 }), [1, 2]);
        assert_eq!(changed(ByteChange::Flip { at: 1, bit: 0 }), [1, 3, 3, 4]);
        assert_eq!(changed(ByteChange::Remove { at: 3, count: 9 }), [1, 2, 3]);
        assert_eq!(changed(ByteChange::Copy { from: 2, count: 2, to: 0 }), [3, 4, 1, 2, 3, 4]);
        let word = |big| ByteChange::Word { at: 2, width: 4, big, value: 0x0a0b_0c0d };
        assert_eq!(changed(word(false)), [1, 2, 0x0d, 0x0c]);
        assert_eq!(changed(word(true)), [1, 2, 0x0a, 0x0b]);
    }
}
