//! Distances to drawings composed of tapering brush strokes, in millimetres.

/// A brush stroke through points (x, y, radius), smoothed by a Catmull–Rom spline, and the part to which it belongs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    /// The part of the drawing; strokes of the same part merge.
    pub part: usize,
    /// The x, y and radius of each point.
    pub points: &'static [[f32; 3]],
}

/// A straight piece of a stroke: its ends as x, y, radius.
#[derive(Debug, Clone, Copy)]
struct Segment {
    part: usize,
    a: [f32; 3],
    b: [f32; 3],
}

/// The maximum exact distance; larger distances are clamped to it.
const REACH: f32 = 2.0;
/// The side of a cell of the lookup grid.
const CELL: f32 = 1.5;
/// Segments per span between two points.
const PIECES: usize = 7;

/// A drawing of at most `PARTS` parts that returns the distance from a point to each part.
#[derive(Debug)]
pub(super) struct Drawing<const PARTS: usize> {
    segments: Vec<Segment>,
    columns: usize,
    rows: usize,
    /// For each cell, the segments within reach.
    cells: Vec<Vec<u16>>,
}

impl<const PARTS: usize> Drawing<PARTS> {
    /// Creates a drawing on the area from (0, 0) to `size`.
    pub fn new(strokes: &[Stroke], size: [f32; 2]) -> Self {
        let segments: Vec<Segment> = strokes.iter().flat_map(pieces).collect();
        let [columns, rows] = size.map(|s| (s / CELL).ceil() as usize);
        let cells = (0..columns * rows)
            .map(|i| {
                let center = [(i % columns) as f32 + 0.5, (i / columns) as f32 + 0.5].map(|c| c * CELL);
                let near = REACH + CELL * 0.7072;
                let within = |s: &Segment| distance(s, center) < near;
                (0..segments.len()).filter(|k| within(&segments[*k])).map(|k| k as u16).collect()
            })
            .collect();
        Self { segments, columns, rows, cells }
    }

    /// Returns the signed distance to each part, negative inside and at most [`REACH`], which it is outside the area.
    pub fn distances(&self, p: [f32; 2]) -> [f32; PARTS] {
        let mut nearest = [REACH; PARTS];
        let [i, j] = p.map(|c| (c / CELL).floor());
        if i < 0.0 || j < 0.0 || i >= self.columns as f32 || j >= self.rows as f32 {
            return nearest;
        }
        for k in &self.cells[j as usize * self.columns + i as usize] {
            let segment = &self.segments[*k as usize];
            let d = distance(segment, p);
            if d < nearest[segment.part] {
                nearest[segment.part] = d;
            }
        }
        nearest
    }
}

/// Returns the distance to a capsule with a linearly varying radius; exact enough for gentle tapers.
fn distance(s: &Segment, [x, y]: [f32; 2]) -> f32 {
    let (dx, dy) = (s.b[0] - s.a[0], s.b[1] - s.a[1]);
    let (px, py) = (x - s.a[0], y - s.a[1]);
    let t = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    let (qx, qy) = (px - dx * t, py - dy * t);
    (qx * qx + qy * qy).sqrt() - (s.a[2] + (s.b[2] - s.a[2]) * t)
}

/// Returns the spline of a stroke as straight segments.
fn pieces(stroke: &Stroke) -> Vec<Segment> {
    let points = stroke.points;
    let at = |i: usize| points[i.min(points.len() - 1)];
    let mut line = vec![points[0]];
    for i in 0..points.len() - 1 {
        let (before, a, b, after) = (at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2));
        for k in 1..=PIECES {
            let t = k as f32 / PIECES as f32;
            line.push(std::array::from_fn(|c| catmull_rom([before[c], a[c], b[c], after[c]], t)));
        }
    }
    line.windows(2).map(|w| Segment { part: stroke.part, a: w[0], b: w[1] }).collect()
}

/// Evaluates the uniform Catmull–Rom spline between the middle two of four values, `t` in [0, 1].
fn catmull_rom([p, a, b, q]: [f32; 4], t: f32) -> f32 {
    let (slope_a, slope_b) = ((b - p) * 0.5, (q - a) * 0.5);
    let d = a - b;
    a + t * (slope_a + t * (-3.0 * d - 2.0 * slope_a - slope_b + t * (2.0 * d + slope_a + slope_b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_signed_and_falls_off_beyond_the_ends() {
        let stroke = Stroke { part: 1, points: &[[5.0, 5.0, 1.0], [9.0, 5.0, 1.0]] };
        let drawing = Drawing::<2>::new(&[stroke], [20.0, 10.0]);
        for (p, expected) in [([7.0, 5.0], -1.0), ([7.0, 6.5], 0.5), ([10.5, 5.0], 0.5), ([15.0, 9.0], REACH)]
        {
            let [other, d] = drawing.distances(p);
            assert_eq!(other, REACH);
            assert!((d - expected).abs() < 1e-5, "{p:?}: {d}");
        }
    }
}
