//! Serialises an environment, so that its levels need not be recomputed: little endian, validated by length and
//! checksum.
//!
//! The header is followed by the number of corrected texels, the image and the levels. Texels are six bytes, three
//! half floats, after their exponent of two.

use super::equirect::Equirect;
use super::levels::{Levels, Octahedron, RoughnessLevel, alphas};
use super::texels::HalfTexels;
use super::{ENVIRONMENT_VERSION, Environment};
use crate::error::{Error, Result};
use crate::image::Image;
use crc32fast::Hasher;
use std::io::{self, Read};
use std::sync::OnceLock;

/// The signature; [`ENVIRONMENT_VERSION`] and the CRC-32 of the rest follow.
const SIGNATURE: &[u8; 8] = b"taotie\0E";
const HEADER: usize = 16;

/// The maximum number of levels, and the maximum texels across one.
const MOST_LEVELS: usize = 64;
const MOST_TEXELS: usize = 4096;

impl Environment {
    /// Returns the environment as bytes for [`Self::from_bytes`] of the same [`ENVIRONMENT_VERSION`].
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.stored_bytes());
        bytes.extend(SIGNATURE);
        bytes.extend(ENVIRONMENT_VERSION.to_le_bytes());
        bytes.extend([0; 4]);
        put_count(&mut bytes, self.repaired);
        put_count(&mut bytes, self.picture.width());
        put_count(&mut bytes, self.picture.height());
        put_texels(&mut bytes, self.picture.texels());
        put_count(&mut bytes, self.levels.0.len());
        for level in &self.levels.0 {
            bytes.extend(level.alpha.to_le_bytes());
            put_map(&mut bytes, &level.map);
        }
        let sum = crc32fast::hash(&bytes[HEADER..]);
        bytes[HEADER - 4..HEADER].copy_from_slice(&sum.to_le_bytes());
        bytes
    }

    /// An upper bound, nearly exact, of the number of bytes from [`Self::to_bytes`].
    fn stored_bytes(&self) -> usize {
        let levels = self.levels.0.iter().map(|level| level.map.texels());
        let texels: usize = levels.chain([self.picture.texels()]).map(|texels| texels.texels().len()).sum();
        1024 + texels * 6
    }

    /// Reads the bytes from [`Self::to_bytes`], restoring the same bits.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the bytes are not an environment, of another version, truncated or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        Self::read(bytes)
    }

    /// Like [`Self::from_bytes`], but reads from `from`, in large pieces and without holding all bytes in memory.
    ///
    /// # Errors
    /// As for [`Self::from_bytes`], and if reading fails.
    pub fn read(from: impl Read) -> Result<Self> {
        let mut rest = Rest { from, sum: Hasher::new() };
        if rest.array()? != *SIGNATURE {
            return Err(wrong("not an environment file"));
        }
        let version = u32::from_le_bytes(rest.array()?);
        if version != ENVIRONMENT_VERSION {
            return Err(wrong(&format!("version {version}; expected {ENVIRONMENT_VERSION}")));
        }
        let sum = u32::from_le_bytes(rest.array()?);
        rest.sum = Hasher::new();
        let repaired = rest.count(usize::MAX)?;
        let side = Image::MAX_SIDE as usize;
        let (width, height) = (rest.size(side)?, rest.size(side)?);
        let picture = Equirect::from_texels(width, height, rest.texels(width * height)?);
        let levels = (0..rest.count(MOST_LEVELS)?).map(|_| rest.level()).collect::<Result<Vec<_>>>()?;
        let expected = alphas().into_iter().map(|alpha| alpha as f32);
        if !rest.is_at_end() || !levels.iter().map(|level| level.alpha).eq(expected) {
            return Err(wrong("inconsistent content"));
        }
        if rest.sum.finalize() != sum {
            return Err(wrong("wrong checksum: damaged or truncated"));
        }
        let levels = Levels(levels);
        Ok(Self { picture, levels, distribution: OnceLock::new(), repaired })
    }
}

fn put_count(bytes: &mut Vec<u8>, count: usize) {
    bytes.extend((count as u64).to_le_bytes());
}

fn put_map(bytes: &mut Vec<u8>, map: &Octahedron) {
    put_count(bytes, map.side());
    put_texels(bytes, map.texels());
}

fn put_texels(bytes: &mut Vec<u8>, texels: &HalfTexels) {
    bytes.extend(texels.exponent().to_le_bytes());
    let mut piece = [[0; 2]; PIECE / 2];
    for halves in texels.texels().as_flattened().chunks(piece.len()) {
        for (stored, half) in piece.iter_mut().zip(halves) {
            *stored = half.to_le_bytes();
        }
        bytes.extend_from_slice(piece[..halves.len()].as_flattened());
    }
}

fn wrong(why: &str) -> Error {
    Error::invalid("environment data", why)
}

/// The number of bytes of texels read or written at a time: few enough to stay in the cache until they are converted.
const PIECE: usize = 6 << 13;

/// The maximum number of texels allocated before they are read; the allocation grows as they are.
const BELIEVED: usize = 1 << 22;

/// The unread rest.
struct Rest<R> {
    from: R,
    /// The checksum of the bytes since the header.
    sum: Hasher,
}

impl<R: Read> Rest<R> {
    fn fill(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.from.read_exact(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => wrong("unexpected end"),
            _ => wrong(&error.to_string()),
        })?;
        self.sum.update(bytes);
        Ok(())
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut array = [0; N];
        self.fill(&mut array)?;
        Ok(array)
    }

    fn is_at_end(&mut self) -> bool {
        self.from.read_exact(&mut [0]).is_err()
    }

    fn count(&mut self, most: usize) -> Result<usize> {
        let count = usize::try_from(u64::from_le_bytes(self.array()?)).ok().filter(|count| *count <= most);
        count.ok_or_else(|| wrong("a count is too large"))
    }

    fn size(&mut self, most: usize) -> Result<usize> {
        let size = self.count(most)?;
        if size == 0 { Err(wrong("a size is zero")) } else { Ok(size) }
    }

    fn texels(&mut self, count: usize) -> Result<HalfTexels> {
        let exponent = i32::from_le_bytes(self.array()?);
        let texels = HalfTexels::with_exponent(exponent, count.min(BELIEVED));
        let mut texels = texels.ok_or_else(|| wrong("invalid number"))?;
        let mut piece = [0; PIECE];
        while texels.texels().len() < count {
            let stored = &mut piece[..PIECE.min(6 * (count - texels.texels().len()))];
            self.fill(stored)?;
            if !texels.add_stored(stored.as_chunks().0) {
                return Err(wrong("invalid number"));
            }
        }
        Ok(texels)
    }

    fn level(&mut self) -> Result<RoughnessLevel> {
        let alpha = f32::from_le_bytes(self.array()?);
        Ok(RoughnessLevel { alpha, map: self.map()? })
    }

    fn map(&mut self) -> Result<Octahedron> {
        let side = self.size(MOST_TEXELS)?;
        Ok(Octahedron::from_texels(side, self.texels((side + 2) * (side + 2))?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Environment {
        let mut image = Image::new(8, 4, [0.5, 0.25, 2.0, 1.0]).unwrap();
        image.pixels_mut()[7] = [900.0, f32::NAN, 0.0, 1.0];
        Environment::new(image).unwrap()
    }

    /// Reads bytes with one value changed and the checksum corrected.
    fn changed(mut bytes: Vec<u8>, at: usize, value: &[u8]) -> Result<Environment> {
        bytes[at..at + value.len()].copy_from_slice(value);
        let sum = crc32fast::hash(&bytes[HEADER..]).to_le_bytes();
        bytes[HEADER - 4..HEADER].copy_from_slice(&sum);
        Environment::from_bytes(&bytes)
    }

    #[test]
    fn bytes_there_and_back_are_the_same() {
        let environment = small();
        let bytes = environment.to_bytes();
        let again = Environment::from_bytes(&bytes).unwrap();
        assert_eq!(again.picture, environment.picture);
        assert_eq!(again.levels, environment.levels);
        assert_eq!(again.repaired_texels(), 1);
        assert!(again.to_bytes() == bytes);
    }

    #[test]
    fn what_is_cut_off_longer_or_damaged_is_refused() {
        let bytes = small().to_bytes();
        let cuts = [0, 7, 8, 12, 15, 16, 30, 200, bytes.len() - 1];
        for cut in cuts {
            assert!(Environment::from_bytes(&bytes[..cut]).is_err(), "{cut}");
        }
        assert!(Environment::from_bytes(&[&bytes[..], &[0]].concat()).is_err());
        for at in [0, 8, 12, 16, 24, 40, bytes.len() / 2, bytes.len() - 1] {
            let mut bytes = bytes.clone();
            bytes[at] ^= 4;
            assert!(Environment::from_bytes(&bytes).is_err(), "{at}");
        }
    }

    #[test]
    fn sums_are_no_reason_to_believe() {
        let bytes = small().to_bytes();
        let all = [0xff; 8];
        // Corrected texels, width, height, exponent, a texel, the number of levels.
        let picture = 16 + 3 * 8 + 4;
        let levels = picture + 8 * 4 * 6;
        for at in [24, 32, 40, picture, levels - 4, levels, levels + 8, levels + 12, levels + 20] {
            assert!(changed(bytes.clone(), at, &all).is_err(), "{at}");
        }
        assert!(changed(bytes.clone(), 24, &0u64.to_le_bytes()).is_err());
        assert!(changed(bytes.clone(), levels, &1u64.to_le_bytes()).is_err());
        assert!(changed(bytes, 16, &5u64.to_le_bytes()).is_ok_and(|e| e.repaired_texels() == 5));
    }
}
