//! The order of points along a curve that fills space.

/// Bits a coordinate.
pub(super) const BITS: u32 = 10;

/// Returns the place along Hilbert's curve of a cell of a cube of 2^[`BITS`] cells a side; neighbours on the curve are
/// neighbours in space.
///
/// Source: Skilling 2004, "Programming the Hilbert curve".
pub(super) fn hilbert_index(cell: [u32; 3]) -> u64 {
    let mut x = cell;
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        let low = bit - 1;
        for i in 0..3 {
            if x[i] & bit != 0 {
                x[0] ^= low;
            } else {
                let swapped = (x[0] ^ x[i]) & low;
                x[0] ^= swapped;
                x[i] ^= swapped;
            }
        }
        bit >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut flips = 0;
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        if x[2] & bit != 0 {
            flips ^= bit - 1;
        }
        bit >>= 1;
    }
    let [a, b, c] = x.map(|v| spread_bits(v ^ flips));
    a << 2 | b << 1 | c
}

/// The bits of a number of at most 21, two zeros between each and the next.
fn spread_bits(v: u32) -> u64 {
    let mut v = u64::from(v);
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_space() {
        // A cube of 8 cells a side at the origin is the first part of the curve.
        let side = 8u32;
        let mut cells: Vec<[u32; 3]> =
            (0..side.pow(3)).map(|i| [i % side, i / side % side, i / side / side]).collect();
        cells.sort_by_key(|cell| hilbert_index(*cell));
        for (i, cell) in cells.iter().enumerate() {
            assert_eq!(hilbert_index(*cell), i as u64);
        }
        for pair in cells.windows(2) {
            let steps: u32 = (0..3).map(|k| pair[0][k].abs_diff(pair[1][k])).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }
}
