//! What the pixels of a relief map say about it, since its statement in an MTL file often does not.

use crate::image::{Bitmap, Texels};

/// What a picture that gives relief holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Relief {
    /// Heights: it is grey, or its colours are no unit vectors.
    Height,
    /// Unit vectors that mostly lean along +z.
    TangentNormals,
    /// Unit vectors that point everywhere.
    ObjectNormals,
}

/// About how many texels are looked at.
const SAMPLES: usize = 1 << 16;

/// Tells relief maps apart by their texels.
///
/// A picture is grey where at least 98 in 100 texels have channels within 8/255 of each other, and holds vectors
/// where at least 80 in 100 of 2c − 1 are within 0.15 of unit length. Vectors are in tangent space where their mean
/// has z above 0.5 and at most 2 in 100 point below the surface. Black, white and transparent texels, with which
/// tools fill what no triangle covers, do not count.
pub(super) fn relief(bitmap: &Bitmap) -> Relief {
    let mut seen = Tally::default();
    // An odd step that is no divisor of common widths visits columns evenly.
    let step = (bitmap.texels().len() / SAMPLES) | 1;
    for i in (0..bitmap.texels().len()).step_by(step) {
        seen.add(stored(bitmap, i));
    }
    seen.verdict(bitmap.channels())
}

#[derive(Default)]
struct Tally {
    count: usize,
    grey: usize,
    unit: usize,
    below: usize,
    sum: [f64; 3],
}

impl Tally {
    fn add(&mut self, [r, g, b, a]: [f32; 4]) {
        let (least, most) = (r.min(g).min(b), r.max(g).max(b));
        let filler = a == 0.0 || most == 0.0 || least == 1.0;
        if filler || !(most - least).is_finite() {
            return;
        }
        let vector = [r, g, b].map(|c| f64::from(c) * 2.0 - 1.0);
        let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        self.count += 1;
        self.grey += usize::from(most - least <= 8.0 / 255.0);
        self.unit += usize::from((length - 1.0).abs() <= 0.15);
        self.below += usize::from(vector[2] < -0.05);
        for (sum, v) in self.sum.iter_mut().zip(vector) {
            *sum += v;
        }
    }

    fn verdict(&self, channels: u8) -> Relief {
        let grey = self.grey * 100 >= self.count * 98;
        let vectors = self.unit * 100 >= self.count * 80;
        if channels < 3 || grey || !vectors {
            Relief::Height
        } else if self.sum[2] > 0.5 * self.count as f64 && self.below * 100 <= self.count * 2 {
            Relief::TangentNormals
        } else {
            Relief::ObjectNormals
        }
    }
}

/// The numbers of a texel as stored, 1 being the largest of an integer type; nothing is decoded.
pub(super) fn stored(bitmap: &Bitmap, i: usize) -> [f32; 4] {
    match bitmap.texels() {
        Texels::U8(t) => t[i].map(|v| f32::from(v) / 255.0),
        Texels::U16(t) => t[i].map(|v| f32::from(v) / 65535.0),
        Texels::F32(t) => t[i],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;

    fn picture(channels: u8, texel: impl Fn(f64, f64) -> [f64; 3]) -> Bitmap {
        let texels = (0..4096)
            .map(|i| {
                let [r, g, b] = texel(f64::from(i % 64) / 63.0, f64::from(i / 64) / 63.0);
                [r, g, b, 1.0].map(|v| (v * 255.0 + 0.5) as u8)
            })
            .collect();
        Bitmap::new(64, 64, channels, Texels::U8(texels)).unwrap()
    }

    fn encoded(x: f64, y: f64, z: f64) -> [f64; 3] {
        let length = (x * x + y * y + z * z).sqrt();
        [x, y, z].map(|v| v / length * 0.5 + 0.5)
    }

    #[test]
    fn tells_heights_from_both_kinds_of_normals() {
        assert_eq!(relief(&picture(3, |u, v| [u * v; 3])), Relief::Height);
        assert_eq!(relief(&picture(1, |_, _| [0.5; 3])), Relief::Height);
        assert_eq!(relief(&picture(3, |u, v| [u, v, 0.2])), Relief::Height);
        assert_eq!(relief(&picture(3, |_, _| [0.5, 0.5, 1.0])), Relief::TangentNormals);
        let waves = |u: f64, v: f64| encoded(scalar::sin(u * 40.0), scalar::cos(v * 30.0), 1.0);
        assert_eq!(relief(&picture(3, waves)), Relief::TangentNormals);
        let half_covered = |u: f64, v: f64| if u < 0.7 { [0.0; 3] } else { waves(u, v) };
        assert_eq!(relief(&picture(3, half_covered)), Relief::TangentNormals);
        let sphere = |u: f64, v: f64| {
            let (a, z) = (u * 2.0 * std::f64::consts::PI, 2.0 * v - 1.0);
            let r = (1.0 - z * z).sqrt();
            encoded(r * scalar::cos(a), r * scalar::sin(a), z)
        };
        assert_eq!(relief(&picture(3, sphere)), Relief::ObjectNormals);
    }

    #[test]
    fn a_picture_of_filler_alone_is_flat_height() {
        assert_eq!(relief(&picture(3, |_, _| [0.0; 3])), Relief::Height);
    }
}
