//! Smooth random variation in space, identical on every machine.

use taotie_engine::math::Vec3;

/// Hashes three integers.
fn hash(x: i32, y: i32, z: i32) -> u32 {
    let mut h = (x as u32).wrapping_mul(0x8da6_b343) ^ (y as u32).wrapping_mul(0xd816_3841);
    h ^= (z as u32).wrapping_mul(0xcb1a_b31f);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

/// Returns the dot product of an offset with one of the twelve directions to a cube's edges.
fn gradient(h: u32, x: f32, y: f32, z: f32) -> f32 {
    let (a, b) = match h % 3 {
        0 => (x, y),
        1 => (y, z),
        _ => (z, x),
    };
    let signed = |v: f32, bit: u32| if h & bit == 0 { v } else { -v };
    signed(a, 1 << 8) + signed(b, 1 << 9)
}

/// Gradient noise within ±1: 0 with random slopes at whole numbers, and smooth in between (Perlin 2002).
fn value(p: Vec3) -> f32 {
    let floor = p.map(f32::floor);
    let d = p - floor;
    let f = d.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let [x, y, z] = floor.to_array().map(|v| v as i32);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let corner = |i: i32, j: i32, k: i32| {
        gradient(hash(x + i, y + j, z + k), d.x - i as f32, d.y - j as f32, d.z - k as f32)
    };
    let edge = |j: i32, k: i32| mix(corner(0, j, k), corner(1, j, k), f.x);
    mix(mix(edge(0, 0), edge(1, 0), f.y), mix(edge(0, 1), edge(1, 1), f.y), f.z)
}

/// Octaves of noise around 0, roughly within ±1; the coarsest has features of size 1.
pub(super) fn fractal(p: Vec3, octaves: usize) -> f32 {
    let (mut sum, mut amplitude, mut p) = (0.0, 1.0, p);
    for _ in 0..octaves {
        sum += amplitude * value(p);
        amplitude *= 0.5;
        // Rotate each octave so that lattices do not line up.
        p = Vec3::new(1.6 * p.x + 1.2 * p.y, 1.6 * p.y - 1.2 * p.x, 2.0 * p.z);
        p = Vec3::new(p.x + 17.3, 0.8 * p.y + 0.6 * p.z + 5.9, 0.8 * p.z - 0.6 * p.y + 31.7);
    }
    sum * 0.95
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
