//! The alpha mode of each triangle of a low-poly mesh: that of most of the surface it represents.

use super::cage::Cage;
use super::scan::Scan;
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::scene::AlphaMode;

/// The barycentric weights of the points of a triangle that are projected onto the scan: its centre, and six points
/// around it.
const POINTS: [[f32; 3]; 7] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.6, 0.2, 0.2],
    [0.2, 0.6, 0.2],
    [0.2, 0.2, 0.6],
    [0.45, 0.45, 0.1],
    [0.45, 0.1, 0.45],
    [0.1, 0.45, 0.45],
];

impl Scan {
    /// Returns the alpha mode of each triangle of a low-poly mesh: the most frequent one among points of the scan
    /// onto which a few of its points are projected, as texels are. Masks with several cutoffs count as one with the
    /// cutoff 0.5. In a tie, the more transparent mode wins; a triangle that finds no scan is opaque.
    pub fn alpha_modes(&self, low: &Mesh, cage: &Cage) -> Vec<AlphaMode> {
        let count = low.triangles().len();
        match self.surface().alpha_modes().as_slice() {
            [only] => vec![*only; count],
            modes => parallel::collect(count, |t| {
                let points = POINTS.iter().map(|weights| Point { triangle: t as u32, weights: *weights });
                let most = most(points.filter_map(|point| self.rank_at(low, cage, point)));
                modes.iter().copied().find(|mode| rank(*mode) == most).unwrap_or_default()
            }),
        }
    }

    /// Returns the rank of the mode at a point of the low-poly mesh; `None` if it finds no scan.
    fn rank_at(&self, low: &Mesh, cage: &Cage, point: Point) -> Option<usize> {
        let projection = cage.projection_ray(low, point);
        let found = self.project(&projection).or_else(|| cage.fallback(self, &projection))?;
        Some(rank(self.surface().material(found.point.triangle).alpha))
    }
}

/// Returns the rank of a mode among all kinds: the higher, the more transparent.
fn rank(mode: AlphaMode) -> usize {
    match mode {
        AlphaMode::Opaque => 0,
        AlphaMode::Mask(_) => 1,
        AlphaMode::Blend => 2,
    }
}

/// Returns the most frequent of the ranks, the highest in a tie; 0 if there is none.
fn most(ranks: impl Iterator<Item = usize>) -> usize {
    let mut counts = [0; 3];
    ranks.for_each(|rank| counts[rank] += 1);
    (1..3).fold(0, |most, rank| if counts[rank] > 0 && counts[rank] >= counts[most] { rank } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_points_decide_and_then_what_lets_more_through() {
        let of = |ranks: &[usize]| most(ranks.iter().copied());
        assert_eq!(of(&[]), 0);
        assert_eq!((of(&[0, 0, 1]), of(&[1, 2, 1]), of(&[2, 2, 0])), (0, 1, 2));
        assert_eq!((of(&[0, 1]), of(&[1, 2, 0]), of(&[0, 2, 2, 0, 1])), (1, 2, 2));
    }

    #[test]
    fn the_points_lie_within_the_triangle_and_balance() {
        let mut sum = [0.0; 3];
        for weights in POINTS {
            assert!(weights.iter().all(|w| *w > 0.0) && (weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            sum.iter_mut().zip(weights).for_each(|(sum, w)| *sum += w);
        }
        assert!(sum.iter().all(|sum| (sum - 7.0 / 3.0).abs() < 1e-5), "{sum:?}");
    }
}
