//! The effects of three thousand years of burial on the metal: green carbonates in the recesses, red cuprite around
//! them, brown tarnish on flat areas, and bare bronze where it has been rubbed.

use super::patterns::smooth;
use std::sync::LazyLock;
use taotie_engine::math::{Vec3, srgb};

/// The sRGB encoding of the 16-bit linear values.
static SRGB: LazyLock<Vec<u8>> = LazyLock::new(|| {
    (0..=65535u32).map(|i| (srgb::srgb_from_linear(f64::from(i) / 65535.0) * 255.0 + 0.5) as u8).collect()
});

/// The inputs that determine the patina of a texel.
#[derive(Debug, Clone, Copy)]
pub(super) struct PatinaInput {
    /// The position on the vessel, metres.
    pub position: Vec3,
    /// The interpolated vertex normal, not normalised.
    pub normal: Vec3,
    /// Relief, [0, 1].
    pub height: f32,
    /// Depth below the surroundings within half a millimetre; negative on ridges.
    pub cavity: f32,
    /// Depth below the surroundings within two millimetres.
    pub wide_cavity: f32,
}

/// The appearance of a texel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// Linear RGB.
    color: Vec3,
    occlusion: f32,
    roughness: f32,
    metallic: f32,
}

impl Default for Surface {
    fn default() -> Self {
        Self { color: TARNISH, occlusion: 1.0, roughness: 0.55, metallic: 0.0 }
    }
}

// Linear RGB.
/// Rubbed tin bronze: reflectance at normal incidence, slightly darkened.
const METAL: Vec3 = Vec3::new(0.60, 0.37, 0.185);
/// Brown, nearly black tarnish.
const TARNISH: Vec3 = Vec3::new(0.088, 0.060, 0.041);
/// Olive tarnish.
const OLIVE: Vec3 = Vec3::new(0.100, 0.094, 0.056);
/// Copper(I) oxide.
const CUPRITE: Vec3 = Vec3::new(0.140, 0.055, 0.033);
/// Basic copper carbonate, dense and pale.
const MALACHITE: Vec3 = Vec3::new(0.094, 0.192, 0.118);
const PALE_MALACHITE: Vec3 = Vec3::new(0.270, 0.385, 0.290);
/// The blue carbonate.
const AZURITE: Vec3 = Vec3::new(0.075, 0.135, 0.175);
/// Burial earth.
const EARTH: Vec3 = Vec3::new(0.250, 0.200, 0.130);

fn mix(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    a + (b - a) * t
}

/// Returns the appearance of a texel.
pub(super) fn surface(texel: &PatinaInput) -> Surface {
    let p = texel.position * 1000.0;
    let broad = fractal(p * (1.0 / 24.0), 3);
    let patch = fractal(p * (1.0 / 7.0) + Vec3::splat(91.0), 3);
    let grain = fractal(p * (1.0 / 1.1) + Vec3::splat(37.0), 2);
    let n = texel.normal.normalize();
    let recess = 0.5 * smooth(texel.cavity * 4.0 + 0.10) + 0.7 * smooth(texel.wide_cavity * 2.2);
    let raised = smooth((texel.height - 0.42) / 0.20);
    let ridge = smooth(-texel.cavity * 5.0 - 0.05) * smooth((texel.height - 0.28) / 0.2);

    // Tarnish: brown to olive, with patches of cuprite.
    let mut color = mix(TARNISH, OLIVE, smooth(0.5 + 0.9 * broad)) * (1.0 + 0.2 * grain);
    let mut roughness = 0.42 + 0.10 * grain;
    let red = 0.7 * smooth((patch - 0.5 * broad - 0.10) / 0.45);
    color = mix(color, CUPRITE, red);

    // Green, in patches and in recesses.
    let field = 0.95 * broad + 0.55 * patch + 0.25 * grain + 0.80 * recess - 0.34 * raised - 0.25 * ridge;
    let field = field - 0.36 + 0.08 * n.y;
    let green = smooth(field / 0.36 + 0.5);
    let crust = smooth((field - 0.28 + 0.3 * grain) / 0.4);
    if green > 0.0 {
        let blue = 0.45 * smooth((fractal(p * (1.0 / 11.0) + Vec3::splat(-53.0), 2) - 0.28) / 0.3);
        let mineral = mix(mix(MALACHITE, PALE_MALACHITE, crust), AZURITE, blue);
        color = mix(color, mineral * (1.0 + 0.25 * grain), green);
    }
    roughness += green * (0.30 + 0.10 * crust);

    // Earth in the deepest furrows.
    let earth = 0.5 * smooth((recess + 0.45 * patch - 0.85) / 0.4);
    color = mix(color, EARTH, earth);
    roughness += earth * 0.1;

    // Rubbed metal on edges and high places.
    let rubbed = 0.95 * ridge + 0.42 * raised - 0.45 * broad + 0.45 * grain + 0.40 * patch - 0.52;
    let metallic = smooth(rubbed / 0.5 + 0.1) * (1.0 - 0.8 * green) * (1.0 - earth);
    color = mix(color, METAL, metallic);
    roughness += metallic * (0.32 + 0.05 * grain - roughness);

    Surface { color, occlusion: occlusion(texel), roughness: roughness.clamp(0.2, 0.95), metallic }
}

/// Returns the fraction of the sky that a texel sees: less in furrows, far less deep in the cup.
fn occlusion(texel: &PatinaInput) -> f32 {
    let p = texel.position;
    let furrow = 0.55 * smooth(texel.cavity * 3.0) + 0.30 * smooth(texel.wide_cavity * 1.6);
    let n = texel.normal;
    // Inside the cup, normals point to the axis.
    let inward = smooth(-(n.x * p.x + n.z * p.z) / 0.008) + smooth(n.y * 2.0 - 1.0);
    let within = smooth((0.034 * 0.034 - p.x * p.x - p.z * p.z) * 4000.0) * inward.min(1.0);
    let depth = ((0.164 - p.y) / 0.075).clamp(0.0, 1.0);
    (1.0 - furrow) * (1.0 - 0.85 * within * depth.sqrt())
}

impl Surface {
    /// Returns the sRGB-encoded colour.
    pub fn srgb(&self) -> [u8; 4] {
        let encode = |c: f32| SRGB[(c.clamp(0.0, 1.0) * 65535.0 + 0.5) as usize];
        let [r, g, b] = self.color.to_array().map(encode);
        [r, g, b, 255]
    }

    /// Returns occlusion, roughness and metallic.
    pub fn orm(&self) -> [u8; 4] {
        let [o, r, m] =
            [self.occlusion, self.roughness, self.metallic].map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
        [o, r, m, 255]
    }
}

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

/// Octaves of noise around 0, identical on every machine, roughly within ±1; the coarsest has features of size 1.
fn fractal(p: Vec3, octaves: usize) -> f32 {
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
