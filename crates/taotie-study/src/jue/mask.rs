//! The taotie: the face of a beast from the front, mirrored about its nose, with its body extending to both sides.
//!
//! Drawn in millimetres for the right half: x from the nose outward (48 at the panel's edge), y upward (0 to 37).
//! Its parts are composed of tapering brush strokes.

use super::patterns::{bump, dome, from_whole, plateau, smooth};

/// Half the width of a panel.
pub(super) const HALF_WIDTH: f32 = 48.4;
/// The height of a panel.
pub(super) const HEIGHT: f32 = 37.0;

const SHIELD: usize = 0;
const NOSE: usize = 1;
const LID: usize = 2;
const BROW: usize = 3;
const HORN: usize = 4;
const EAR: usize = 5;
const JAW: usize = 6;
const FANG: usize = 7;
const BODY: usize = 8;
const LEG: usize = 9;
const QUILL: usize = 10;
const PARTS: usize = 11;

/// The height of each part, and the distance inside its edge at which a contour is engraved (0: none).
const LEVELS: [[f32; 2]; PARTS] = [
    [0.66, 0.95], // shield
    [0.78, 0.0],  // nose
    [0.66, 0.0],  // lid
    [0.60, 0.0],  // brow
    [0.80, 0.85], // horn
    [0.70, 0.80], // ear
    [0.76, 0.80], // jaw
    [0.86, 0.0],  // fang
    [0.70, 0.85], // body
    [0.66, 0.80], // leg
    [0.52, 0.0],  // quill
];

/// The centre and half axes of the eyeball.
const EYE: [f32; 4] = [13.4, 16.6, 4.9, 4.2];

const STROKES: &[Stroke] = &[
    Stroke {
        part: SHIELD,
        points: &[[0.0, 22.4, 1.6], [0.0, 26.0, 3.3], [0.0, 30.0, 3.2], [0.0, 35.8, 0.5]],
    },
    Stroke { part: NOSE, points: &[[1.6, 21.0, 0.9], [2.0, 15.0, 1.3], [2.5, 10.6, 1.8]] },
    Stroke {
        part: NOSE,
        points: &[[2.5, 10.6, 1.7], [5.4, 9.6, 1.3], [7.2, 11.2, 1.0], [6.2, 13.2, 0.8], [4.9, 12.3, 0.5]],
    },
    Stroke {
        part: LID,
        points: &[
            [5.2, 12.0, 0.35],
            [7.2, 16.6, 0.75],
            [10.0, 20.4, 0.85],
            [13.6, 21.8, 0.85],
            [18.8, 19.9, 0.75],
            [23.4, 17.6, 0.3],
        ],
    },
    Stroke {
        part: LID,
        points: &[
            [5.2, 12.0, 0.35],
            [9.0, 12.0, 0.75],
            [13.6, 11.4, 0.8],
            [18.6, 13.6, 0.75],
            [23.4, 17.6, 0.3],
        ],
    },
    Stroke {
        part: BROW,
        points: &[
            [5.0, 21.6, 0.3],
            [9.0, 23.7, 0.85],
            [15.4, 24.5, 1.0],
            [21.4, 22.6, 0.8],
            [24.6, 20.2, 0.25],
        ],
    },
    Stroke {
        part: HORN,
        points: &[
            [5.8, 26.6, 0.7],
            [10.0, 27.7, 1.6],
            [16.6, 27.7, 2.0],
            [22.6, 28.2, 2.3],
            [25.6, 31.2, 2.1],
            [23.1, 34.5, 1.8],
            [17.6, 34.9, 1.5],
            [14.4, 33.0, 1.1],
            [15.8, 31.2, 0.85],
            [18.6, 31.8, 0.5],
        ],
    },
    Stroke {
        part: EAR,
        points: &[[25.4, 14.6, 0.3], [28.0, 17.2, 1.6], [28.8, 21.2, 1.9], [26.4, 25.0, 0.3]],
    },
    Stroke {
        part: JAW,
        points: &[
            [3.4, 7.0, 1.0],
            [8.0, 6.8, 1.6],
            [13.6, 5.6, 1.6],
            [19.4, 5.2, 1.6],
            [23.6, 7.4, 1.5],
            [23.6, 11.0, 1.2],
            [20.6, 11.8, 0.9],
            [19.6, 9.6, 0.5],
        ],
    },
    Stroke { part: FANG, points: &[[7.6, 6.2, 1.5], [8.6, 3.4, 1.1], [9.6, 0.9, 0.15]] },
    Stroke { part: FANG, points: &[[17.4, 5.0, 1.5], [16.2, 2.8, 1.1], [13.8, 1.2, 0.15]] },
    Stroke { part: FANG, points: &[[1.6, 6.4, 1.0], [2.4, 3.4, 0.9], [3.6, 1.4, 0.15]] },
    Stroke {
        part: BODY,
        points: &[
            [29.6, 11.4, 1.0],
            [33.2, 13.0, 1.9],
            [37.4, 16.6, 2.2],
            [40.8, 21.6, 2.2],
            [43.0, 27.4, 2.0],
            [42.0, 32.6, 1.7],
            [37.2, 34.6, 1.4],
            [33.4, 32.0, 1.2],
            [34.4, 28.4, 0.9],
            [37.6, 29.2, 0.45],
        ],
    },
    Stroke {
        part: LEG,
        points: &[
            [31.2, 10.4, 1.3],
            [33.6, 8.0, 1.7],
            [33.0, 4.6, 1.4],
            [35.6, 2.4, 1.2],
            [40.0, 2.2, 1.0],
            [41.4, 4.8, 0.7],
            [39.4, 6.4, 0.35],
        ],
    },
    Stroke { part: LEG, points: &[[32.8, 5.4, 1.1], [29.6, 3.6, 0.9], [28.2, 1.2, 0.2]] },
    Stroke {
        part: QUILL,
        points: &[[31.2, 16.4, 0.3], [33.2, 19.6, 1.0], [33.4, 23.6, 0.9], [30.6, 27.4, 0.25]],
    },
    Stroke { part: QUILL, points: &[[35.6, 20.4, 0.3], [37.4, 23.0, 0.8], [38.0, 26.0, 0.25]] },
    Stroke {
        part: QUILL,
        points: &[
            [45.6, 22.0, 0.25],
            [44.4, 17.0, 0.9],
            [41.6, 13.0, 1.1],
            [38.4, 10.8, 0.7],
            [39.8, 9.2, 0.3],
        ],
    },
    Stroke { part: QUILL, points: &[[45.2, 3.0, 0.9], [44.6, 7.0, 1.1], [45.4, 11.6, 0.3]] },
    Stroke { part: QUILL, points: &[[28.6, 29.0, 0.3], [29.8, 32.4, 1.1], [28.6, 35.6, 0.3]] },
];

/// The mask of one panel.
#[derive(Debug)]
pub(super) struct Mask {
    drawing: Drawing<PARTS>,
}

impl Mask {
    /// Prepares the drawing.
    pub fn new() -> Self {
        Self { drawing: Drawing::new(STROKES, [HALF_WIDTH, HEIGHT]) }
    }

    /// Returns the height in [0, 1] and the distance to the nearest part, at `x` from the nose and `y` above the
    /// panel's lower edge.
    pub fn height(&self, x: f32, y: f32) -> (f32, f32) {
        let x = x.abs();
        let distances = self.drawing.distances([x, y]);
        let (mut height, mut nearest) = eye(x, y);
        for (d, [level, inset]) in distances.into_iter().zip(LEVELS) {
            let engraved = if inset > 0.0 { 0.34 * bump(d + inset, 0.34) } else { 0.0 };
            height = max(height, plateau(d, level, 0.42) - engraved * level);
            nearest = min(nearest, d);
        }
        height -= hairs(x, distances[BROW]);
        (height, nearest)
    }
}

/// The hairs engraved in the brow.
fn hairs(x: f32, brow: f32) -> f32 {
    0.20 * bump(from_whole(x / 1.35) * 1.35, 0.36) * smooth((-0.12 - brow) / 0.3)
}

/// The eyeball: a dome with a drilled pupil.
fn eye(x: f32, y: f32) -> (f32, f32) {
    let [cx, cy, a, b] = EYE;
    let (px, py) = ((x - cx) / a, (y - cy) / b);
    let radius = (px * px + py * py).sqrt();
    let d = (radius - 1.0) * b;
    let ball = plateau(d + 0.15, 0.34, 0.5) + 0.66 * dome(radius / 0.96);
    let (qx, qy) = (x - cx, y - cy);
    let pupil = ((qx * qx) * 0.5 + qy * qy).sqrt();
    (ball - 0.42 * plateau(pupil - 0.62, 1.0, 0.5), d)
}

fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// A brush stroke through points (x, y, radius), smoothed by a Catmull–Rom spline, and the part to which it belongs.
#[derive(Debug, Clone, Copy)]
struct Stroke {
    /// The part of the drawing; strokes of the same part merge.
    part: usize,
    /// The x, y and radius of each point.
    points: &'static [[f32; 3]],
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

/// A drawing of at most `COUNT` parts that returns the distance from a point to each part.
#[derive(Debug)]
struct Drawing<const COUNT: usize> {
    segments: Vec<Segment>,
    columns: usize,
    rows: usize,
    /// For each cell, the segments within reach.
    cells: Vec<Vec<u16>>,
}

impl<const COUNT: usize> Drawing<COUNT> {
    /// Creates a drawing on the area from (0, 0) to `size`.
    fn new(strokes: &[Stroke], size: [f32; 2]) -> Self {
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
    fn distances(&self, p: [f32; 2]) -> [f32; COUNT] {
        let mut nearest = [REACH; COUNT];
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
