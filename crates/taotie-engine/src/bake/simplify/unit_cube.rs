//! The unit cube that points are scaled into, and its cells along a Morton curve, on which neighbours in space are
//! mostly neighbours in order.

use crate::math::Vec3;

/// The cube that points are scaled from.
#[derive(Debug, Clone, Copy)]
pub(in crate::bake) struct UnitCube {
    least: Vec3<f64>,
    /// The longest side, model units; above 0.
    pub extent: f64,
}

impl UnitCube {
    pub fn of(positions: &[Vec3]) -> Self {
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for position in positions {
            for (k, v) in position.to_array().into_iter().enumerate() {
                least[k] = least[k].min(v);
                most[k] = most[k].max(v);
            }
        }
        let side = |k: usize| f64::from(most[k]) - f64::from(least[k]);
        let extent = side(0).max(side(1)).max(side(2));
        Self {
            least: Vec3::from_array(least).to_f64(),
            extent: if extent > 0.0 && extent.is_finite() { extent } else { 1.0 },
        }
    }

    /// Returns the point in the unit cube.
    pub fn scaled(&self, position: Vec3) -> [f32; 3] {
        self.unit(position).to_f32().to_array()
    }

    /// Returns the position of a point of the unit cube.
    pub fn placed(&self, point: [f32; 3]) -> Vec3 {
        (self.least + Vec3::from_array(point).to_f64() * self.extent).to_f32()
    }

    /// Like [`Self::scaled`], in double precision.
    pub fn unit(&self, position: Vec3) -> Vec3<f64> {
        (position.to_f64() - self.least) / self.extent
    }
}

/// Cells along a side of the cube: 2 to this power.
const CELL_BITS: u32 = 10;
/// The same for fine cells, whose codes have three words of [`CELL_BITS`] per axis.
const FINE_BITS: u32 = 3 * CELL_BITS;

/// Returns the index of a point's cell along the Morton curve; the point must be in the unit cube.
pub(in crate::bake) fn morton(point: [f32; 3]) -> u32 {
    let cells = 1 << CELL_BITS;
    interleaved(point.map(|v| ((v * cells as f32) as u32).min(cells - 1)))
}

/// Fine cells of the cube merged into blocks of 2^`shift` along a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct FineCells {
    shift: u32,
}

impl FineCells {
    /// The finest cells: 2^30 along a side.
    pub const FINEST: Self = Self { shift: 0 };

    /// Returns the smallest blocks with a side of at least `length`, or the whole cube if that is shorter.
    pub fn at_least(length: f64) -> Self {
        let cells = (length * f64::from(1u32 << FINE_BITS)) as u32;
        Self { shift: (u32::BITS - cells.leading_zeros()).min(FINE_BITS) }
    }

    /// Returns the coordinates of the block containing a point; points outside the cube are clamped.
    pub fn block(self, point: [f64; 3]) -> [u32; 3] {
        let cells = 1u32 << FINE_BITS;
        point.map(|v| ((v * f64::from(cells)) as u32).min(cells - 1) >> self.shift)
    }

    /// Returns the first and the last code of a block's cells along the curve. No other block has codes between them.
    pub fn codes(self, block: [u32; 3]) -> [[u32; 3]; 2] {
        let low = block.map(|v| v << self.shift);
        let high = low.map(|v| v | ((1 << self.shift) - 1));
        [low, high].map(|cell| {
            [2, 1, 0].map(|word| interleaved(cell.map(|v| v >> (word * CELL_BITS) & ((1 << CELL_BITS) - 1))))
        })
    }
}

fn interleaved(cell: [u32; 3]) -> u32 {
    let [x, y, z] = cell.map(spread_bits);
    x << 2 | y << 1 | z
}

/// Spreads ten bits, leaving two free bits before each.
fn spread_bits(v: u32) -> u32 {
    let v = (v | v << 16) & 0x0300_00FF;
    let v = (v | v << 8) & 0x0300_F00F;
    let v = (v | v << 4) & 0x030C_30C3;
    (v | v << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_by_three() {
        assert_eq!(spread_bits(0b11_1111_1111), 0x0924_9249);
        assert_eq!(morton([0.0, 0.0, 1.0]), 0x0924_9249);
        assert_eq!(morton([0.5, 0.0, 0.0]), 1 << 29);
    }

    #[test]
    fn a_point_has_a_code_of_its_block() {
        let point = [0.3, 0.999_999_9, 1e-8];
        let [code, same] = FineCells::FINEST.codes(FineCells::FINEST.block(point));
        assert_eq!(code, same);
        for length in [0.0, 1e-9, 1e-4, 0.3, 7.0] {
            let cells = FineCells::at_least(length);
            let [first, last] = cells.codes(cells.block(point));
            assert!(first <= code && code <= last, "{length}");
            let [x, y, z] = cells.block(point);
            let [after, _] = cells.codes([x, y, z + 1]);
            let side = f64::from(1u32 << cells.shift) / f64::from(1u32 << FINE_BITS);
            assert!(side == 1.0 || after != first && side >= length, "{length}");
        }
    }
}
