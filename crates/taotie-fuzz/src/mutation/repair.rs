//! Repair of lengths and checksums after a change, so that readers look further.

use super::chunks::{PNG, chunks};

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
