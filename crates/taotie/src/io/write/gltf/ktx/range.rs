//! The levels that endpoints of a block are quantised to.

/// Quantisation levels: bits, and above them a digit of three or five values. Source: Khronos Data Format 1.3, 23.18,
/// on the unquantisation of colours.
pub(super) struct Range {
    /// The number of bits below the digit.
    pub bits: u32,
    /// The number of values of the digit; 1 if there is none.
    pub digits: u32,
    /// The value from 0 to 255 of each code.
    pub value: [u8; 256],
    /// The code of the nearest level to each value.
    pub nearest: [u8; 256],
}

/// 192 levels: a three-valued digit and six bits.
pub(super) static OF_192: Range = Range::new(6, 3);

/// 160 levels: a five-valued digit and five bits.
pub(super) static OF_160: Range = Range::new(5, 5);

/// All 256 levels.
pub(super) static OF_256: Range = Range::new(8, 1);

impl Range {
    const fn new(bits: u32, digits: u32) -> Self {
        let mut range = Self { bits, digits, value: [0; 256], nearest: [0; 256] };
        let levels = (digits << bits) as usize;
        let mut code = 0;
        while code < levels {
            range.value[code] = unquantized(code as u32, bits, digits);
            code += 1;
        }
        let mut value = 0;
        while value < 256 {
            let mut best = 0;
            let mut code = 1;
            while code < levels {
                if range.value[code].abs_diff(value as u8) < range.value[best].abs_diff(value as u8) {
                    best = code;
                }
                code += 1;
            }
            range.nearest[value] = best as u8;
            value += 1;
        }
        range
    }

    /// Returns the code of the nearest level.
    pub fn code(&self, value: f32) -> u8 {
        self.nearest[(value + 0.5).clamp(0.0, 255.0) as usize]
    }
}

const fn unquantized(code: u32, bits: u32, digits: u32) -> u8 {
    let (digit, low) = (code >> bits, code & ((1 << bits) - 1));
    let high = low >> 1;
    let spread = match digits {
        3 => digit * 5 + (high << 4 | high >> 4),
        5 => digit * 6 + (high << 5 | high >> 3),
        _ => return code as u8,
    };
    let mirror = if low & 1 == 1 { 511 } else { 0 };
    ((mirror & 0x80) | ((spread ^ mirror) >> 2)) as u8
}

#[cfg(all(test, feature = "basis"))]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_the_decoder() {
        let table = basisu::uastc::bise::astc_unquant();
        for (range, number) in [(&OF_160, 18), (&OF_192, 19), (&OF_256, 20)] {
            let codes = (range.digits << range.bits) as usize;
            for (code, (ours, theirs)) in range.value.iter().zip(&table[number]).take(codes).enumerate() {
                assert_eq!(*ours, theirs.m_unquant, "{code} of range {number}");
            }
            let farthest =
                (0..=255u8).map(|v| v.abs_diff(range.value[range.nearest[v as usize] as usize])).max();
            assert!(farthest <= Some(1));
        }
    }
}
