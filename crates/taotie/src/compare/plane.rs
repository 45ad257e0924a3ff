//! A plane of numbers and its convolution by separable kernels.

use crate::parallel;

/// One number for each pixel in double precision, row by row from the top.
pub(super) struct Plane {
    pub width: usize,
    pub values: Vec<f64>,
}

impl Plane {
    /// A plane from one number for each of the pixels.
    pub fn new<P: Sync>(width: u32, pixels: &[P], number: impl Fn(&P) -> f64 + Sync) -> Self {
        Self { width: width as usize, values: parallel::collect(pixels.len(), |i| number(&pixels[i])) }
    }

    /// The plane convolved with the kernel `across` along its rows and `down` along its columns, both of odd length
    /// and applied unmirrored; beyond the border the plane goes on as its last pixels are.
    pub fn filtered(&self, across: &[f64], down: &[f64]) -> Plane {
        self.rows_filtered(across).columns_filtered(down)
    }

    fn rows_filtered(&self, kernel: &[f64]) -> Plane {
        let radius = kernel.len() / 2;
        self.by_rows(|y, out| {
            let row = &self.values[y * self.width..][..self.width];
            let mut padded = vec![row[0]; radius];
            padded.extend_from_slice(row);
            padded.extend(std::iter::repeat_n(row[self.width - 1], radius));
            for (tap, weight) in kernel.iter().enumerate() {
                add_scaled(out, &padded[tap..], *weight);
            }
        })
    }

    fn columns_filtered(&self, kernel: &[f64]) -> Plane {
        let radius = kernel.len() / 2;
        let last = self.values.len() / self.width - 1;
        self.by_rows(|y, out| {
            for (tap, weight) in kernel.iter().enumerate() {
                let from = (y + tap).saturating_sub(radius).min(last);
                add_scaled(out, &self.values[from * self.width..], *weight);
            }
        })
    }

    /// A plane of this size, of which `fill` writes each row; it gets the row's number and zeros.
    fn by_rows(&self, fill: impl Fn(usize, &mut [f64]) + Sync) -> Plane {
        let mut values = vec![0.0f64; self.values.len()];
        parallel::pieces(&mut values, self.width, &fill);
        Plane { width: self.width, values }
    }
}

fn add_scaled(out: &mut [f64], from: &[f64], weight: f64) {
    for (out, value) in out.iter_mut().zip(from) {
        *out += value * weight;
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
