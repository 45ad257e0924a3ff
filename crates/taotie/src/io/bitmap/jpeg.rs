//! The memory needed to decode a JPEG, estimated from its header.
//!
//! The decoder (`zune-jpeg` 0.5) keeps one row of blocks if a single scan has all components. For a progressive file,
//! and for one whose components come in several scans, it keeps all coefficients, two bytes each. Markers are located
//! as the decoder does, so that no file can present a different header to it.

/// The start of a frame and of its first scan.
#[derive(Debug, PartialEq)]
struct Header {
    width: u64,
    height: u64,
    /// The samples of each component across and down in a block of the file, 1 to 4.
    samplings: Vec<[u64; 2]>,
    /// `true` if all coefficients are kept.
    keeps_all: bool,
    /// The length of the file in bytes, including metadata, of which the decoder makes copies.
    length: u64,
}

/// Returns the bytes needed for decoding, including the decoder's pixels and its copy of the file; `None` for a file
/// that it rejects.
pub(super) fn room(bytes: &[u8], bytes_per_pixel: u64) -> Option<u64> {
    let header = Header::read(bytes)?;
    let pixels = header.width * header.height * bytes_per_pixel;
    let coefficients = if header.keeps_all { header.coefficients() } else { 0 };
    Some(pixels + coefficients + header.rows() + header.length + bytes.len() as u64)
}

impl Header {
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut reader = Reader { bytes: bytes.strip_prefix(b"\xff\xd8")?, last: 0 };
        let mut frame = None;
        loop {
            let marker = reader.marker()?;
            let segment = reader.segment()?;
            match marker {
                0xc0..=0xc2 if frame.is_none() => frame = Some(Self::of_frame(marker, segment)?),
                // Other frames, arithmetic coding, an end without an image, a height that comes later.
                0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcd | 0xcf | 0xd9 | 0xdc => return None,
                0xda => {
                    let of_scan = usize::from(*segment.first()?);
                    let length = (bytes.len() - reader.bytes.len()) as u64;
                    return frame.map(|frame| Self {
                        keeps_all: frame.keeps_all || of_scan != frame.samplings.len(),
                        length,
                        ..frame
                    });
                }
                _ => {}
            }
        }
    }

    /// Reads the frame header.
    fn of_frame(marker: u8, segment: &[u8]) -> Option<Self> {
        let [_, h1, h0, w1, w0, count, components @ ..] = segment else { return None };
        let (components, rest) = components.as_chunks::<3>();
        if components.len() != usize::from(*count) || !rest.is_empty() {
            return None;
        }
        let sampling = |[_, factors, _]: &[u8; 3]| [factors >> 4, factors & 15].map(u64::from);
        let samplings: Vec<[u64; 2]> = components.iter().map(sampling).collect();
        let is_known = |sampling: &[u64; 2]| sampling.iter().all(|factor| (1..=4).contains(factor));
        let side = |high: &u8, low: &u8| u64::from(u16::from_be_bytes([*high, *low]));
        let (width, height, keeps_all) = (side(w1, w0), side(h1, h0), marker == 0xc2);
        let is_whole = !samplings.is_empty() && samplings.iter().all(is_known);
        is_whole.then_some(Self { width, height, samplings, keeps_all, length: 0 })
    }

    /// Returns the maximum sampling factors of the components, across and down.
    fn most(&self) -> [u64; 2] {
        [0, 1].map(|axis| self.samplings.iter().map(|sampling| sampling[axis]).max().unwrap_or(1))
    }

    /// Returns the bytes of all coefficients: two for each sample of each component, in whole blocks.
    fn coefficients(&self) -> u64 {
        let [across, down] = self.most();
        let blocks = self.width.div_ceil(8 * across) * self.height.div_ceil(8 * down);
        self.samplings.iter().map(|[h, v]| 2 * 64 * blocks * h * v).sum()
    }

    /// Returns the bytes of one row of blocks: its samples, and the same upsampled to the finest component's
    /// resolution.
    fn rows(&self) -> u64 {
        let [across, down] = self.most();
        let blocks = self.width.div_ceil(8 * across);
        let of_component = |[h, v]: &[u64; 2]| {
            let (stride, finer) = (8 * blocks * h, across.div_ceil(*h) * down.div_ceil(*v));
            // Samples; two rows and one upsampled; eight upsampled, which may be doubled, or all samples twice as wide.
            stride * (16 * v + 4 * v + 2 * v * finer + (32 * finer).max(32 * v))
        };
        self.samplings.iter().map(of_component).sum::<u64>() + 16 * 8 * blocks * across
    }
}

/// The rest of a file, and the last byte read before it.
struct Reader<'a> {
    bytes: &'a [u8],
    last: u8,
}

impl<'a> Reader<'a> {
    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(*byte)
    }

    /// Returns the next marker: the byte after one or more 255s. Zeros after a 255 are skipped as well.
    fn marker(&mut self) -> Option<u8> {
        loop {
            let mut byte = self.byte()?;
            if self.last == 0xff {
                while byte == 0xff || byte == 0 {
                    self.last = byte;
                    byte = self.byte()?;
                }
            }
            let is_marker = self.last == 0xff;
            self.last = byte;
            if is_marker {
                return Some(byte);
            }
        }
    }

    /// Returns the segment after a marker, whose length is stored in its first two bytes.
    fn segment(&mut self) -> Option<&'a [u8]> {
        let length = usize::from(u16::from_be_bytes([self.byte()?, self.byte()?]));
        let (segment, rest) = self.bytes.split_at_checked(length.checked_sub(2)?)?;
        self.bytes = rest;
        Some(segment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header of 64 × 32 pixels, from a frame marker, the components' sampling factors, and the component count of
    /// the first scan.
    fn file(frame: u8, factors: &[u8], scan: u8) -> Vec<u8> {
        let count = factors.len() as u8;
        let mut bytes = b"\xff\xd8\xff\xe0\0\x06ab\xff\xc2".to_vec();
        bytes.extend([0xff, frame, 0, 8 + 3 * count, 8, 0, 32, 0, 64, count]);
        bytes.extend(factors.iter().enumerate().flat_map(|(i, factor)| [i as u8, *factor, 0]));
        bytes.extend([0xff, 0xff, 0xda, 0, 6 + 2 * scan, scan]);
        bytes.extend((0..scan).flat_map(|i| [i, 0]).chain([0, 63, 0]));
        bytes
    }

    fn keeps_all(bytes: &[u8]) -> Option<bool> {
        Header::read(bytes).map(|header| header.keeps_all)
    }

    #[test]
    fn coefficients_are_kept_where_no_scan_has_all() {
        let fine = [0x11; 3];
        let cases = [(0xc0, 3), (0xc1, 3), (0xc2, 3), (0xc2, 1), (0xc0, 1)];
        let kept = cases.map(|(frame, scan)| keeps_all(&file(frame, &fine, scan)).unwrap());
        assert_eq!(kept, [false, false, true, true, true]);
    }

    #[test]
    fn room_is_of_samples_and_rows() {
        let file = file(0xc2, &[0x22, 0x11, 0x11], 3);
        let header = Header::read(&file).unwrap();
        assert_eq!((header.width, header.height, header.length), (64, 32, file.len() as u64));
        let samples = 64 * 32 + 2 * 32 * 16;
        assert_eq!(header.coefficients(), 2 * samples);
        let all = room(&file, 3).unwrap();
        assert_eq!(all, 64 * 32 * 3 + 2 * samples + header.rows() + 2 * file.len() as u64);
        // The buffered rows are small compared with a tall image.
        assert!((64 * 176..=64 * 320).contains(&header.rows()), "{}", header.rows());
    }

    #[test]
    fn what_the_decoder_refuses_has_no_header() {
        let sound = file(0xc0, &[0x11], 1);
        assert!(keeps_all(&sound).is_some());
        assert!((0..sound.len()).all(|end| keeps_all(&sound[..end]).is_none()));
        let twice = [&sound[..sound.len() - 11], &sound[10..]].concat();
        for wrong in [&file(0xc9, &[0x11], 1), &file(0xc0, &[0x51], 1), &file(0xc0, &[], 0), &twice] {
            assert_eq!(keeps_all(wrong), None);
        }
        // Zeros between a 255 and a marker hide the marker.
        let hidden = [&b"\xff\xd8\xff\0\xc2"[..], &sound[2..]].concat();
        assert_eq!(keeps_all(&hidden), Some(false));
    }
}
