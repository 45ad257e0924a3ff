//! The effects of three thousand years of burial on the metal: green carbonates in the recesses, red cuprite around
//! them, brown tarnish on flat areas, and bare bronze where it has been rubbed.

use super::noise::fractal;
use super::profile::smooth;
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
