//! A plane of numbers and its convolution by separable kernels.

use crate::parallel;

/// One number for each pixel in double precision, row by row from the top.
pub(super) struct Plane {
    pub width: usize,
    pub values: Vec<f64>,
}

impl Plane {
    /// Makes a plane from one number per pixel.
    pub fn new<P: Sync>(width: u32, pixels: &[P], number: impl Fn(&P) -> f64 + Sync) -> Self {
        Self { width: width as usize, values: parallel::collect(pixels.len(), |i| number(&pixels[i])) }
    }

    /// Returns the plane convolved with the kernel `across` along its rows and `down` along its columns, both of odd
    /// length and applied unmirrored; beyond the border the plane repeats its last pixels.
    pub fn filtered(&self, across: &[f64], down: &[f64]) -> Plane {
        self.rows_filtered(across).columns_filtered(down)
    }

    fn rows_filtered(&self, kernel: &[f64]) -> Plane {
        let radius = kernel.len() / 2;
        self.by_rows(|y, out| {
            let row = &self.values[y * self.width..][..self.width];
            let mut padded = Vec::with_capacity(self.width + 2 * radius);
            padded.resize(radius, row[0]);
            padded.extend_from_slice(row);
            padded.resize(self.width + 2 * radius, row[self.width - 1]);
            weighted_sum(out, kernel, |tap| &padded[tap..]);
        })
    }

    fn columns_filtered(&self, kernel: &[f64]) -> Plane {
        let radius = kernel.len() / 2;
        let last = self.values.len() / self.width - 1;
        self.by_rows(|y, out| {
            let row = |tap: usize| (y + tap).saturating_sub(radius).min(last);
            weighted_sum(out, kernel, |tap| &self.values[row(tap) * self.width..]);
        })
    }

    /// Makes a plane of this size by calling `fill` with the index of each row.
    fn by_rows(&self, fill: impl Fn(usize, &mut [f64]) + Sync) -> Plane {
        let mut values = vec![0.0f64; self.values.len()];
        parallel::pieces(&mut values, self.width, &fill);
        Plane { width: self.width, values }
    }
}

/// Number of values of a row that are summed together.
const BLOCK: usize = 16;

/// Writes the sum, over all taps of a kernel, of its weight times the row that `from` returns for it.
fn weighted_sum<'a>(out: &mut [f64], kernel: &[f64], from: impl Fn(usize) -> &'a [f64]) {
    let mut blocks = out.chunks_exact_mut(BLOCK);
    let mut at = 0;
    for block in &mut blocks {
        let mut sums = [0.0; BLOCK];
        for (tap, weight) in kernel.iter().enumerate() {
            let values: &[f64; BLOCK] = from(tap)[at..at + BLOCK].try_into().expect("a block");
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value * weight;
            }
        }
        block.copy_from_slice(&sums);
        at += BLOCK;
    }
    for (i, out) in blocks.into_remainder().iter_mut().enumerate() {
        *out = kernel.iter().enumerate().fold(0.0, |sum, (tap, weight)| sum + from(tap)[at + i] * weight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_reach_over_the_border_and_keep_their_direction() {
        let plane = Plane { width: 3, values: vec![1.0, 2.0, 4.0, 10.0, 20.0, 40.0] };
        let forward = plane.filtered(&[0.0, 0.0, 1.0], &[1.0]);
        assert_eq!(forward.values, [2.0, 4.0, 4.0, 20.0, 40.0, 40.0]);
        let downward = plane.filtered(&[1.0], &[0.0, 0.0, 1.0]);
        assert_eq!(downward.values, [10.0, 20.0, 40.0, 10.0, 20.0, 40.0]);
        let mean = plane.filtered(&[0.25, 0.5, 0.25], &[0.0, 1.0, 0.0]);
        assert_eq!(mean.values, [1.25, 2.25, 3.5, 12.5, 22.5, 35.0]);
    }
}
