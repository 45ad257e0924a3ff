//! The taotie: the face of a beast from the front, mirrored about its nose, with its body extending to both sides.
//!
//! Drawn in millimetres for the right half: x from the nose outward (48 at the panel's edge), y upward (0 to 37).

use super::profile::{bump, dome, from_whole, plateau, smooth};
use super::strokes::{Drawing, Stroke};

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
