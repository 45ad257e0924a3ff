//! Sets of directions, quantised, and the narrowest cone around them.

use crate::math::Vec3;

/// Cells along a side of the octahedral map; directions are rounded by 1.3° on average.
const SIDE: u16 = 64;

/// The unit direction in the middle of each cell of the octahedral map.
pub(super) struct Middles(Vec<Vec3<f64>>);

impl Middles {
    pub fn new() -> Self {
        Self((0..SIDE * SIDE).map(direction).collect())
    }
}

/// Directions rounded to cells of the octahedral map; sorted and distinct.
#[derive(Debug, Clone, Default)]
pub(super) struct Directions(Vec<u16>);

impl Directions {
    pub fn of(directions: impl Iterator<Item = Vec3<f64>>) -> Self {
        let mut cells: Vec<u16> = directions.filter(|d| d.dot(*d) > 0.5).map(cell).collect();
        cells.sort_unstable();
        cells.dedup();
        Self(cells)
    }

    /// Returns the union of both sets.
    pub fn union(&self, other: &Self) -> Self {
        let mut cells = [self.0.as_slice(), &other.0].concat();
        cells.sort_unstable();
        cells.dedup();
        Self(cells)
    }

    /// Returns the minimum cosine of the angle between `axis` and any of them; 1 if there are none.
    pub fn least_cosine(&self, middles: &Middles, axis: Vec3<f64>) -> f64 {
        self.farthest(middles, axis).0
    }

    /// Returns the direction farthest from `axis`, and the cosine of the angle between both, at most 1; `axis` itself
    /// if there are none.
    fn farthest(&self, middles: &Middles, axis: Vec3<f64>) -> (f64, Vec3<f64>) {
        let directions = self.0.iter().map(|cell| middles.0[usize::from(*cell)]);
        directions.fold((1.0, axis), |(least, far), d| {
            let cosine = d.dot(axis);
            if cosine < least { (cosine, d) } else { (least, far) }
        })
    }

    /// Returns the axis of approximately the narrowest cone around them, searching from `start` (unit).
    ///
    /// Source: Bădoiu and Clarkson 2003, "Smaller core-sets for balls", section 3: move towards the farthest point in
    /// ever smaller steps.
    pub fn axis(&self, middles: &Middles, start: Vec3<f64>) -> Vec3<f64> {
        let mut farthest = self.farthest(middles, start);
        let (mut axis, mut best) = (start, (farthest.0, start));
        for round in 1..=12 {
            axis = (axis + (farthest.1 - axis) / (f64::from(round) + 2.0)).normalize_or(start);
            farthest = self.farthest(middles, axis);
            if farthest.0 > best.0 {
                best = (farthest.0, axis);
            }
        }
        best.1
    }
}

/// Returns the cell of a unit direction.
/// Source: Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors".
fn cell(d: Vec3<f64>) -> u16 {
    let sum = d.x.abs() + d.y.abs() + d.z.abs();
    let (x, y) = (d.x / sum, d.y / sum);
    let (x, y) = if d.z < 0.0 { folded(x, y) } else { (x, y) };
    let place = |v: f64| (((v * 0.5 + 0.5) * f64::from(SIDE)) as u16).min(SIDE - 1);
    place(y) * SIDE + place(x)
}

/// Returns the unit direction in the middle of a cell.
fn direction(cell: u16) -> Vec3<f64> {
    let place = |i: u16| (f64::from(i) + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
    let (x, y) = (place(cell % SIDE), place(cell / SIDE));
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z < 0.0 { folded(x, y) } else { (x, y) };
    Vec3::new(x, y, z).normalize()
}

fn folded(x: f64, y: f64) -> (f64, f64) {
    let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_near_their_directions() {
        for i in 0..4096u16 {
            assert_eq!(cell(direction(i)), i);
        }
        let d = Vec3::new(0.3, -0.5, -0.7).normalize();
        assert!(direction(cell(d)).dot(d) > 0.9985);
    }

    #[test]
    fn the_cone_of_a_cap_is_found() {
        let rim = (0..40).map(|i| {
            let angle = f64::from(i) * 0.157;
            Vec3::new(0.6 * crate::math::scalar::cos(angle), 0.6 * crate::math::scalar::sin(angle), 0.8)
        });
        let (set, middles) = (Directions::of(rim), Middles::new());
        let axis = set.axis(&middles, Vec3::new(0.6, 0.0, 0.8));
        assert!(axis.z > 0.99, "{axis:?}");
        assert!(set.least_cosine(&middles, axis) > 0.75);
    }
}
