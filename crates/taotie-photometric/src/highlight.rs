//! The highlight on a chrome ball, and the direction of its light.
//!
//! A ball is a mirror: seen from far away along v, the light in direction l = 2 (n · v) n − v appears at the point with
//! normal n. On the picture of a ball, equal areas are equal solid angles of l, so that the mean of l over the
//! highlight is the direction of the lamp's centre.

use crate::circle::Circle;
use crate::grey::GreyImage;
use std::collections::HashSet;
use taotie_engine::math::Vec3;

/// The fraction of the way from the ball's median to its brightest value above which a pixel belongs to the highlight.
const BRIGHT: f32 = 0.2;
/// The largest highlight, as a fraction of the ball's area.
const LARGEST: f64 = 0.04;
/// Pixels of a highlight that are accepted on the smallest ball.
const FEW: usize = 12;
/// The fraction of the radius within which highlights are looked for: beyond, a ball mirrors what is behind it.
const INSIDE: f64 = 0.97;

/// The highlight of a light on a ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Highlight {
    /// The ball's normal there.
    pub normal: Vec3<f64>,
    /// Unit vector towards the light.
    pub direction: Vec3<f64>,
}

/// Returns the light's direction from the ball's normal at the highlight.
fn mirrored(n: Vec3<f64>) -> Vec3<f64> {
    n * (2.0 * n.z) - Vec3::new(0.0, 0.0, 1.0)
}

/// Finds the highlight of a ball; `None` if the brightest part is too large for a chrome ball's.
pub fn highlight(image: &GreyImage, ball: &Circle) -> Option<Highlight> {
    let Circle { center: [cx, cy], radius } = *ball;
    let range = |c: f64, side: usize| {
        (c - radius).floor().max(0.0) as usize..((c + radius).ceil().max(0.0) as usize).min(side)
    };
    let (columns, rows) = (range(cx, image.width), range(cy, image.height));
    let inner = Circle { radius: INSIDE * radius, ..*ball };
    let pixels: Vec<[usize; 2]> = rows
        .flat_map(|y| columns.clone().map(move |x| [x, y]))
        .filter(|pixel| inner.holds(*pixel, 0.0))
        .collect();
    let value = |[x, y]: [usize; 2]| image.values[y * image.width + x];
    // A plateau of saturated pixels has no brightest one: its first will do.
    let brightest = pixels.iter().copied().reduce(|a, b| if value(b) > value(a) { b } else { a })?;
    let mut sorted: Vec<f32> = pixels.iter().map(|pixel| value(*pixel)).collect();
    let middle = sorted.len() / 2;
    let background = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
    let least = background + BRIGHT * (value(brightest) - background);
    if least <= background {
        return None;
    }
    let most = FEW.max((LARGEST * std::f64::consts::PI * radius * radius) as usize);
    let bright = |[x, y]: [usize; 2]| {
        x < image.width && y < image.height && inner.holds([x, y], 0.0) && value([x, y]) > least
    };
    let blob = blob(brightest, most, bright)?;
    let mut sum = Vec3::splat(0.0);
    for pixel in blob {
        let [x, y] = [pixel[0] as f64 + 0.5 - cx, cy - pixel[1] as f64 - 0.5].map(|v| v / radius);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        sum += mirrored(Vec3::new(x, y, z)) * f64::from(value(pixel) - background);
    }
    let direction = sum.normalize_or(Vec3::new(0.0, 0.0, 1.0));
    let normal = (direction + Vec3::new(0.0, 0.0, 1.0)).normalize_or(Vec3::new(0.0, 0.0, 1.0));
    Some(Highlight { normal, direction })
}

/// Returns the `bright` pixels that are connected to one of them; `None` if they are more than `most`.
fn blob(start: [usize; 2], most: usize, bright: impl Fn([usize; 2]) -> bool) -> Option<Vec<[usize; 2]>> {
    let (mut found, mut known) = (vec![start], HashSet::from([start]));
    let mut next = 0;
    while next < found.len() {
        let [x, y] = found[next];
        next += 1;
        for pixel in [[x + 1, y], [x.wrapping_sub(1), y], [x, y + 1], [x, y.wrapping_sub(1)]] {
            if bright(pixel) && known.insert(pixel) {
                found.push(pixel);
            }
        }
        if found.len() > most {
            return None;
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawn_highlight_gives_its_direction_to_a_third_of_a_degree() {
        let ball = Circle { center: [40.2, 38.7], radius: 31.4 };
        for truth in [[0.0, 0.0, 1.0], [0.5, -0.3, 0.8], [-0.9, 0.2, 0.3]] {
            let truth = Vec3::from_array(truth).normalize_or(Vec3::splat(0.0));
            let value = |x: f64, y: f64| {
                let [x, y] = [(x - ball.center[0]) / ball.radius, (ball.center[1] - y) / ball.radius];
                let z = (1.0 - x * x - y * y).max(0.0).sqrt();
                let near = mirrored(Vec3::new(x, y, z)).dot(truth) > 0.99;
                if near && x * x + y * y < 1.0 { 0.9 } else { 0.1 }
            };
            let pixel = |i: usize| {
                let at = |k: usize| {
                    let [u, v] = [k % 8, k / 8].map(|v| (v as f64 + 0.5) / 8.0);
                    value((i % 80) as f64 + u, (i / 80) as f64 + v)
                };
                ((0..64).map(at).sum::<f64>() / 64.0) as f32
            };
            let values = (0..80 * 80).map(pixel).map(|v| v.min(1.0)).collect();
            let image = GreyImage { width: 80, height: 80, values };
            let found = highlight(&image, &ball).unwrap();
            let angle = taotie_engine::compare::angle_deg(found.direction, truth);
            assert!(angle < 0.3, "{angle}");
        }
        let even = GreyImage { width: 80, height: 80, values: vec![0.5; 6400] };
        assert_eq!(highlight(&even, &ball), None);
    }
}
