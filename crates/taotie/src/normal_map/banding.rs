//! Banding: places where a gentle curve is stored as a single code and shows steps in highlights.

use crate::compare::angle_deg;
use crate::math::Vec3;
use crate::parallel;
use crate::surface::encode_normal;

/// The minimum length, in texels, of a run of equal codes along a row or column that is visible as a band.
const LEAST_RUN: usize = 8;
/// The turn over a run, in degrees, below which the surface is flat and its constant colour is not a band.
const LEAST_TURN: f64 = 0.05;

/// Unit vectors of a map, row by row from the top, and which of its texels a surface covers.
pub(crate) struct CoveredNormals<'a> {
    pub size: [u32; 2],
    pub normals: &'a [[f32; 3]],
    pub is_covered: &'a (dyn Fn(usize) -> bool + Sync),
}

impl CoveredNormals<'_> {
    /// Returns the share of covered texels that are banded if vectors are rounded to 8 bits: in runs of one code
    /// along their row and their column, over at least one of which the vectors turn.
    pub fn banded_share(&self) -> f64 {
        let [width, height] = self.size.map(|side| side as usize);
        let covered = parallel::count(self.normals.len(), |i| (self.is_covered)(i));
        let banded = parallel::tasks(height, &|row| {
            (row * width..(row + 1) * width).filter(|i| self.is_banded(*i)).count()
        });
        banded.into_iter().sum::<usize>() as f64 / covered.max(1) as f64
    }

    fn is_banded(&self, texel: usize) -> bool {
        if !(self.is_covered)(texel) {
            return false;
        }
        let [width, height] = self.size.map(|side| side as usize);
        let (column, row) = (texel % width, texel / width);
        let runs = [
            self.run(texel, 1, (column, width - 1 - column)),
            self.run(texel, width, (row, height - 1 - row)),
        ];
        runs.iter().all(|[first, last, step]| (last - first) / step + 1 >= LEAST_RUN)
            && runs.iter().any(|[first, last, _]| self.turn(*first, *last) >= LEAST_TURN)
    }

    /// Returns the first and the last texel of the run of equal codes around a texel, at most [`LEAST_RUN`] to either
    /// side, and the step from one to the next; `before` and `after` are the number of texels on each side.
    fn run(&self, texel: usize, step: usize, (before, after): (usize, usize)) -> [usize; 3] {
        let code = self.code(texel);
        let is_same = |other: &usize| (self.is_covered)(*other) && self.code(*other) == code;
        let down = (1..=before.min(LEAST_RUN)).map(|i| texel - i * step).take_while(is_same).count();
        let up = (1..=after.min(LEAST_RUN)).map(|i| texel + i * step).take_while(is_same).count();
        [texel - down * step, texel + up * step, step]
    }

    fn code(&self, texel: usize) -> [u8; 3] {
        let number = encode_normal(Vec3::from_array(self.normals[texel])).to_array();
        number.map(|v| (v * 255.0 + 0.5) as u8)
    }

    /// Returns the angle between two vectors, in degrees.
    fn turn(&self, a: usize, b: usize) -> f64 {
        let [a, b] = [a, b].map(|i| Vec3::from_array(self.normals[i]).to_f64());
        angle_deg(a, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the share of banded texels on a map of 64² texels whose normals turn by this many degrees per texel
    /// along x.
    fn share(degrees_a_texel: f64) -> f64 {
        let lean = |i: usize| (degrees_a_texel * (i % 64) as f64).to_radians();
        let normal = |i: usize| {
            [crate::math::scalar::sin(lean(i)) as f32, 0.0, crate::math::scalar::cos(lean(i)) as f32]
        };
        let normals: Vec<[f32; 3]> = (0..64 * 64).map(normal).collect();
        CoveredNormals { size: [64; 2], normals: &normals, is_covered: &|_| true }.banded_share()
    }

    #[test]
    fn gentle_curves_have_bands_and_flat_or_rough_surfaces_have_none() {
        assert_eq!([share(0.0), share(0.2)], [0.0; 2]);
        assert!(share(0.02) > 0.9, "{}", share(0.02));
    }

    #[test]
    fn texels_that_nothing_covers_do_not_count() {
        let normals = vec![[0.0, 0.0, 1.0]; 64];
        let map = CoveredNormals { size: [8; 2], normals: &normals, is_covered: &|_| false };
        assert_eq!(map.banded_share(), 0.0);
    }
}
