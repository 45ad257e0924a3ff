//! Triangulates polygons, keeping their corners, winding and area.

use earcut::Earcut;
use taotie_engine::math::Vec3;

/// The shape of a polygon's outline, determined during triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outline {
    /// Its triangles cover it once.
    Simple,
    /// It has no area.
    Flat,
    /// It intersects itself, so that no set of triangles covers it exactly once.
    Crossing,
}

/// Triangulates polygons; its buffers are reused between them.
#[derive(Default)]
pub(super) struct Cutter {
    ears: Earcut<f64>,
    points: Vec<[f64; 2]>,
    indices: Vec<u32>,
}

impl Cutter {
    /// Maximum number of corners of a polygon, which bounds the time of one triangulation.
    pub(super) const MAX_CORNERS: usize = 1 << 14;

    /// Appends the triangles of the polygon with the given corners to `triangles`, as indices into `corners`.
    ///
    /// A triangle is unchanged. A convex quadrilateral is cut along its shorter diagonal (the first if both are
    /// equal), a concave one through its reflex corner. Larger polygons are projected along their normal (Newell's
    /// method) onto the coordinate plane they face most, and ears are clipped there.
    pub(super) fn cut(&mut self, corners: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> Outline {
        let normal = newell_normal(corners);
        if corners.len() > 3 && normal.length() == 0.0 {
            triangles.extend((2..corners.len() as u32).map(|i| [0, i - 1, i]));
            return Outline::Flat;
        }
        match corners.len() {
            0..=2 => Outline::Flat,
            3 => {
                triangles.push([0, 1, 2]);
                if normal.length() == 0.0 { Outline::Flat } else { Outline::Simple }
            }
            4 => cut_quad(corners, normal, triangles),
            _ => self.clip_ears(corners, normal, triangles),
        }
    }

    fn clip_ears(&mut self, corners: &[Vec3], normal: Vec3<f64>, triangles: &mut Vec<[u32; 3]>) -> Outline {
        self.points.clear();
        self.points.extend(corners.iter().map(|p| project(p.to_f64() - corners[0].to_f64(), normal)));
        self.ears.earcut(self.points.iter().copied(), &[], &mut self.indices);
        let start = triangles.len();
        triangles.extend(self.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
        let mut covered = 0.0;
        for triangle in &mut triangles[start..] {
            let area = signed_area(triangle.map(|i| self.points[i as usize]));
            if area < 0.0 {
                triangle.swap(1, 2);
            }
            covered += area.abs();
        }
        let outline: f64 = (1..self.points.len() - 1)
            .map(|i| signed_area([self.points[0], self.points[i], self.points[i + 1]]))
            .sum();
        if (covered - outline).abs() <= 1e-3 * outline { Outline::Simple } else { Outline::Crossing }
    }
}

/// Returns twice the vector area: perpendicular to the polygon, seen counter-clockwise from its tip.
fn newell_normal(corners: &[Vec3]) -> Vec3<f64> {
    let mut sum = Vec3::splat(0.0);
    let Some(first) = corners.first().map(|p| p.to_f64()) else { return sum };
    for pair in corners.windows(2).skip(1) {
        sum += (pair[0].to_f64() - first).cross(pair[1].to_f64() - first);
    }
    sum
}

fn cut_quad(corners: &[Vec3], normal: Vec3<f64>, triangles: &mut Vec<[u32; 3]>) -> Outline {
    let p: [Vec3<f64>; 4] = std::array::from_fn(|i| corners[i].to_f64());
    let turns: [f64; 4] =
        std::array::from_fn(|i| (p[i] - p[(i + 3) % 4]).cross(p[(i + 1) % 4] - p[i]).dot(normal));
    let sharpest = (0..4).fold(0, |best, i| if turns[i] < turns[best] { i } else { best });
    let along_first = if turns[sharpest] > 0.0 {
        (p[2] - p[0]).length() <= (p[3] - p[1]).length()
    } else {
        sharpest % 2 == 0
    };
    triangles.extend(if along_first { [[0, 1, 2], [0, 2, 3]] } else { [[0, 1, 3], [1, 2, 3]] });
    if turns.iter().filter(|t| **t < 0.0).count() > 1 { Outline::Crossing } else { Outline::Simple }
}

/// Returns the two coordinates across the axis nearest to `normal`, in an order that preserves the winding.
fn project(p: Vec3<f64>, normal: Vec3<f64>) -> [f64; 2] {
    let size = normal.map(f64::abs);
    let (pair, facing) = if size.z >= size.x && size.z >= size.y {
        ([p.x, p.y], normal.z)
    } else if size.y >= size.x {
        ([p.z, p.x], normal.y)
    } else {
        ([p.y, p.z], normal.x)
    };
    if facing < 0.0 { [pair[1], pair[0]] } else { pair }
}

/// Returns twice the area of a triangle, positive if it is counter-clockwise.
fn signed_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(corners: &[[f32; 3]]) -> (Vec<[u32; 3]>, Outline, f64, Vec3<f64>) {
        let corners: Vec<Vec3> = corners.iter().map(|p| Vec3::from_array(*p)).collect();
        let mut triangles = Vec::new();
        let outline = Cutter::default().cut(&corners, &mut triangles);
        let (mut area, mut vector) = (0.0, Vec3::splat(0.0));
        for t in &triangles {
            let [a, b, c] = t.map(|i| corners[i as usize].to_f64());
            let double = (b - a).cross(c - a);
            area += double.length() / 2.0;
            vector += double * 0.5;
        }
        (triangles, outline, area, vector)
    }

    #[test]
    fn quads_take_the_shorter_diagonal_or_the_reflex_corner() {
        let (t, ..) = cut(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [5.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        assert_eq!(t, [[0, 1, 3], [1, 2, 3]]);
        let (t, outline, area, _) =
            cut(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]]);
        assert_eq!((t, outline), (vec![[0, 1, 2], [0, 2, 3]], Outline::Simple));
        assert!((area - 4.0).abs() < 1e-6);
        let (_, outline, ..) = cut(&[[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(outline, Outline::Crossing);
    }

    #[test]
    fn concave_polygons_keep_area_and_winding_in_every_plane() {
        let arrow = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        for plane in 0..6 {
            let corners = arrow.map(|[x, y]| match plane {
                0 => [x, y, 0.0],
                1 => [0.0, x, y],
                2 => [y, 0.0, x],
                3 => [y, x, 0.0],
                4 => [0.0, y, x],
                _ => [x, 0.0, y],
            });
            let (triangles, outline, area, vector) = cut(&corners);
            assert_eq!((triangles.len(), outline), (3, Outline::Simple));
            assert!((area - 10.0).abs() < 1e-6 && (vector.length() - 10.0).abs() < 1e-6, "plane {plane}");
            let turned = vector.x + vector.y + vector.z;
            assert!(if plane < 3 { turned > 0.0 } else { turned < 0.0 }, "plane {plane}");
        }
    }

    #[test]
    fn flat_and_crossing_outlines_are_told() {
        assert_eq!(cut(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]).1, Outline::Flat);
        assert_eq!(cut(&[[0.0; 3]; 6]).1, Outline::Flat);
        let star: Vec<[f32; 3]> = [0, 2, 4, 1, 3]
            .iter()
            .map(|i| {
                let turn = f64::from(*i) * 0.4 * std::f64::consts::PI;
                [
                    taotie_engine::math::scalar::cos(turn) as f32,
                    taotie_engine::math::scalar::sin(turn) as f32,
                    0.0,
                ]
            })
            .collect();
        assert_eq!(cut(&star).1, Outline::Crossing);
    }

    #[test]
    fn the_largest_polygons_end() {
        let mut seed = 1u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        let tangle: Vec<Vec3> =
            (0..Cutter::MAX_CORNERS).map(|_| Vec3::new(random(), random(), 0.0)).collect();
        let spiral: Vec<Vec3> = (0..Cutter::MAX_CORNERS)
            .map(|i| {
                let inward = i >= Cutter::MAX_CORNERS / 2;
                let step = if inward { Cutter::MAX_CORNERS - 1 - i } else { i };
                let turn = step as f64 * 0.01;
                let radius = 1.0 + turn + if inward { 1.0 } else { 0.0 };
                let (x, y) = (taotie_engine::math::scalar::cos(turn), taotie_engine::math::scalar::sin(turn));
                Vec3::new((x * radius) as f32, (y * radius) as f32, 0.0)
            })
            .collect();
        let comb: Vec<Vec3> = (0..Cutter::MAX_CORNERS)
            .map(|i| Vec3::new(i as f32, if i % 2 == 0 { 0.0 } else { 1000.0 + i as f32 }, 0.0))
            .collect();
        for polygon in [tangle, spiral, comb] {
            let mut triangles = Vec::new();
            Cutter::default().cut(&polygon, &mut triangles);
            assert!((1..=polygon.len() - 2).contains(&triangles.len()), "{}", triangles.len());
        }
    }
}
