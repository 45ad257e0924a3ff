//! The shading normal and the other directions of a point that lighting needs.

use super::geometry::Geometry;
use crate::math::{Lane, Vec3};

/// The directions of a point, unit, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<L> {
    /// The shading normal; not unit for `bump-printed`.
    pub n: Vec3<L>,
    /// The normal before any map, on the side that is seen.
    pub smooth: Vec3<L>,
    /// α² of [`super::Terminator`]; 0 where nothing is to be softened.
    pub squared_slope: L,
    /// The direction to the viewer.
    pub v: Vec3<L>,
}

impl<L: Lane> Frame<L> {
    /// Makes the frame of the front's shading normal `n`. `side` is −1 where the surface is seen from behind and turns
    /// with it, else 1. Where it is `softened`, a normal that turns away from the viewer is turned back, and the edge
    /// of the relief's shadow is made soft.
    #[inline(always)]
    pub fn new(geometry: &Geometry<L>, n: Vec3<L>, side: L, softened: bool) -> Self {
        let (smooth, n, v) = (geometry.smooth() * side, n * side, geometry.v);
        if !softened {
            return Self { n, smooth, squared_slope: side.lit(0.0), v };
        }
        let n = towards_viewer(n, smooth, v);
        Self { n, smooth, squared_slope: squared_slope(smooth, n), v }
    }
}

/// The clearcoat's normal: `n` of its own map, on the side that is seen, turned towards the viewer.
#[inline(always)]
pub fn coat_normal<L: Lane>(n: Vec3<L>, frame: &Frame<L>) -> Vec3<L> {
    towards_viewer(n, frame.smooth, frame.v)
}

/// The direction of anisotropy, unit, at a right angle to the shading normal `n`: `turn` is cosine and sine of its angle
/// from the tangent.
///
/// Source: KHR_materials_anisotropy.
#[inline(always)]
pub fn anisotropy_direction<L: Lane>(geometry: &Geometry<L>, n: Vec3<L>, [cos, sin]: [L; 2]) -> Vec3<L> {
    let tangent = geometry.tangent;
    let across = n.cross(tangent) * geometry.handedness;
    let along = tangent * cos + across * sin;
    let flat = along - n * n.dot(along);
    flat.normalize_or(n.any_perpendicular())
}

/// The least n·v that a mapped normal keeps where the smooth normal has as much, and where it has none.
const LEAST_N_DOT_V: f64 = 0.25;
const LEAST_AT_RIM: f64 = 0.01;

/// A mapped normal that turns away from a viewer who sees the surface, turned back until it is just seen: the least
/// change there is, and without a step, where mirroring the normal would light the wrong side of every steep slope.
#[inline(always)]
fn towards_viewer<L: Lane>(n: Vec3<L>, smooth: Vec3<L>, v: Vec3<L>) -> Vec3<L> {
    let zero = n.x.lit(0.0);
    let least = smooth.dot(v).clamp(LEAST_AT_RIM, LEAST_N_DOT_V);
    let lacking = (least - n.dot(v)).max(zero);
    Vec3::select(zero.lt(lacking), (n + v * lacking).normalize_or(smooth), n)
}

/// α² of [`super::Terminator::share`] for a map that turns the unit normal `smooth` into `n`: tan² of the angle between
/// over eight, at most 1.
#[inline(always)]
fn squared_slope<L: Lane>(smooth: Vec3<L>, n: Vec3<L>) -> L {
    let cosine = smooth.dot(n).abs().clamp(1e-3, 1.0);
    let squared = cosine * cosine;
    ((squared.lit(1.0) - squared) / squared * squared.lit(0.125)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::Terminator;
    use super::*;

    #[test]
    fn terminators_agree_with_the_oracle() {
        let oracle = include_str!("../../../../tests/oracle/light_oracle.json");
        let oracle: serde_json::Value = serde_json::from_str(oracle).unwrap();
        let rows = oracle["terminator"].as_array().unwrap();
        assert!(rows.len() > 30);
        for row in rows {
            let vector = |name: &str| {
                let [x, y, z] = [0, 1, 2].map(|i| row[name][i].as_f64().unwrap());
                Vec3::new(x, y, z)
            };
            let smooth = vector("smooth");
            let terminator = Terminator { smooth, squared_slope: squared_slope(smooth, vector("n")) };
            let (share, truth) = (terminator.share(vector("l")), row["share"].as_f64().unwrap());
            assert!((share - truth).abs() < 1e-9, "{share} for {truth} in {row}");
        }
    }
}
