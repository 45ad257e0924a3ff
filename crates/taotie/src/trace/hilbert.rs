//! The order of points along a space-filling curve.

/// Bits per coordinate.
pub(super) const BITS: u32 = 10;

/// The number of cells processed side by side.
pub(super) const CELLS: usize = 8;

/// The coordinates of cells, axis by axis.
pub(super) type Cells = [[u32; CELLS]; 3];

/// Returns the positions along Hilbert's curve of cells in a cube of 2^[`BITS`] cells per side; neighbours on the
/// curve are neighbours in space. Branchless loops over all cells, which compilers vectorise.
///
/// Source: Skilling 2004, "Programming the Hilbert curve".
#[inline]
pub(super) fn hilbert_indices(cells: &Cells) -> [u64; CELLS] {
    let mut x = *cells;
    for bit in (1..BITS).rev() {
        let low = (1 << bit) - 1;
        let [first, second, third] = &mut x;
        // The first is swapped with itself, which has no effect.
        first.iter_mut().for_each(|first| *first ^= low & all_ones(*first >> bit & 1));
        for (first, other) in first.iter_mut().zip(second) {
            turn(first, other, bit);
        }
        for (first, other) in first.iter_mut().zip(third) {
            turn(first, other, bit);
        }
    }
    let mut indices = [0; CELLS];
    for (i, index) in indices.iter_mut().enumerate() {
        let [a, b, c] = [x[0][i], x[1][i] ^ x[0][i], x[2][i] ^ x[1][i] ^ x[0][i]];
        let flips = (1..BITS).fold(0, |flips, bit| flips ^ all_ones(c >> bit & 1) & ((1 << bit) - 1));
        let [a, b, c] = [a, b, c].map(|v| spread_bits(v ^ flips));
        *index = a << 2 | b << 1 | c;
    }
    indices
}

/// If a bit of `other` is set, flips the lower ones of `first`; otherwise swaps those of both.
#[inline(always)]
fn turn(first: &mut u32, other: &mut u32, bit: u32) {
    let (low, set) = ((1 << bit) - 1, all_ones(*other >> bit & 1));
    let swapped = (*first ^ *other) & low & !set;
    *first ^= low & set | swapped;
    *other ^= swapped;
}

/// All ones for 1, none for 0.
#[inline(always)]
fn all_ones(bit: u32) -> u32 {
    0u32.wrapping_sub(bit)
}

/// The lowest 21 bits of a number, with two zeros between consecutive bits.
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
        // A cube of 8 cells per side at the origin is the first part of the curve.
        let side = 8u32;
        let mut cells: Vec<[u32; 3]> =
            (0..side.pow(3)).map(|i| [i % side, i / side % side, i / side / side]).collect();
        let index = |cell: [u32; 3]| {
            let mut cells = [[0; CELLS]; 3];
            (0..3).for_each(|axis| cells[axis][3] = cell[axis]);
            hilbert_indices(&cells)[3]
        };
        cells.sort_by_key(|cell| index(*cell));
        for (i, cell) in cells.iter().enumerate() {
            assert_eq!(index(*cell), i as u64);
        }
        for pair in cells.windows(2) {
            let steps: u32 = (0..3).map(|k| pair[0][k].abs_diff(pair[1][k])).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }
}
