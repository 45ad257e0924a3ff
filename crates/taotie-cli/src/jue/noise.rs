//! Smooth random variation in space, the same on every machine.

use taotie::math::Vec3;

/// A number in [0, 1) from three whole ones.
fn hash(x: i32, y: i32, z: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x8da6_b343) ^ (y as u32).wrapping_mul(0xd816_3841);
    h ^= (z as u32).wrapping_mul(0xcb1a_b31f);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    ((h ^ (h >> 15)) >> 8) as f32 / 16_777_216.0
}

/// Value noise in [0, 1): random at whole numbers, smooth between.
fn value(p: Vec3) -> f32 {
    let floor = p.map(f32::floor);
    let f = (p - floor).map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let [x, y, z] = floor.to_array().map(|v| v as i32);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let edge = |dy: i32, dz: i32| mix(hash(x, y + dy, z + dz), hash(x + 1, y + dy, z + dz), f.x);
    mix(mix(edge(0, 0), edge(1, 0), f.y), mix(edge(0, 1), edge(1, 1), f.y), f.z)
}

/// Octaves of value noise about 0, roughly within ±1; the coarsest has features of size 1.
pub(super) fn fractal(p: Vec3, octaves: usize) -> f32 {
    let (mut sum, mut amplitude, mut p) = (0.0, 1.0, p);
    for _ in 0..octaves {
        sum += amplitude * (value(p) - 0.5);
        amplitude *= 0.5;
        // Turned a little from octave to octave, so that lattices do not line up.
        p = Vec3::new(1.6 * p.x + 1.2 * p.y, 1.6 * p.y - 1.2 * p.x, 2.0 * p.z) + Vec3::new(17.3, 5.9, 31.7);
    }
    sum * 1.6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_centred_and_continuous() {
        let at = |i: u32| Vec3::new(i as f32 * 0.37, i as f32 * 0.11, i as f32 * -0.23);
        let values: Vec<f32> = (0..4000).map(|i| fractal(at(i), 4)).collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        assert!(mean.abs() < 0.05, "{mean}");
        assert!(values.iter().all(|v| v.abs() < 1.6));
        let step = Vec3::splat(1e-3);
        assert!((0..500).all(|i| (fractal(at(i), 4) - fractal(at(i) + step, 4)).abs() < 0.05));
    }
}
