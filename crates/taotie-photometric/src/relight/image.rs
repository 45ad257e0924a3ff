//! An image whose pixels are functions of the light's direction.

use super::basis::Basis;
use super::plane::Plane;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::parallel;

/// Pixels of a task.
pub const PIECE: usize = 4096;

/// How colours follow from coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorModel {
    /// Each channel has its own coefficients.
    Rgb,
    /// One brightness for all channels, times a colour that does not depend on the light.
    Lrgb,
}

impl Named for ColorModel {
    const WHAT: &'static str = "colour model";
    const NAMES: &'static [(&'static str, Self)] = &[("rgb", Self::Rgb), ("lrgb", Self::Lrgb)];
}

/// A relightable image. Values for display are in [0, 1] and beyond, with 1 as white.
#[derive(Debug, Clone, PartialEq)]
pub struct Relightable {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The functions of the light.
    pub basis: Basis,
    /// How colours follow from them.
    pub colors: ColorModel,
    /// The coefficients, rows from top to bottom. RGB: red, green and blue of each term. LRGB: the three channels of the
    /// colour, then each term.
    pub planes: Vec<Plane>,
}

impl Relightable {
    /// The number of pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Returns true if there are no pixels, which no reader accepts.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the colours of all pixels under a light, given as a unit vector towards it.
    pub fn relit(&self, light: Vec3<f64>) -> Vec<[f32; 3]> {
        let weights = self.basis.weights(light);
        let first = if self.colors == ColorModel::Lrgb { 3 } else { 0 };
        let weight = |plane: usize| match self.colors {
            ColorModel::Rgb => weights[plane / 3],
            ColorModel::Lrgb => weights.get(plane.wrapping_sub(first)).copied().unwrap_or(1.0),
        };
        let tables: Vec<[f32; 256]> =
            self.planes.iter().enumerate().map(|(i, plane)| plane.table(weight(i))).collect();
        let value = |plane: usize, pixel: usize| tables[plane][usize::from(self.planes[plane].codes[pixel])];
        let mut pixels = vec![[0.0; 3]; self.len()];
        parallel::pieces(&mut pixels, PIECE, &|piece, pixels| {
            for (i, color) in pixels.iter_mut().enumerate() {
                let pixel = piece * PIECE + i;
                match self.colors {
                    ColorModel::Rgb => {
                        (0..self.planes.len()).for_each(|plane| color[plane % 3] += value(plane, pixel));
                    }
                    ColorModel::Lrgb => {
                        let grey: f32 = (3..self.planes.len()).map(|plane| value(plane, pixel)).sum();
                        *color = std::array::from_fn(|channel| grey * value(channel, pixel));
                    }
                }
            }
        });
        pixels
    }
}

/// Returns unit vectors towards the lights by which a relightable image becomes photographs: a spiral around the view.
pub fn lights_of_relit() -> Vec<Vec3<f64>> {
    /// Lights.
    const COUNT: usize = 40;
    /// z of the highest and the lowest light. Of 0.2 to 0.75, 0.3 gave the smallest errors of normals.
    const Z: [f64; 2] = [0.95, 0.3];
    /// The golden angle (Vogel 1979).
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let light = |k: usize| {
        let z = Z[0] + (Z[1] - Z[0]) * (k as f64 + 0.5) / COUNT as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), GOLDEN * k as f64);
        Vec3::new(r * scalar::cos(angle), r * scalar::sin(angle), z)
    };
    (0..COUNT).map(light).collect()
}

/// Rejects sizes that no image of ours may have. `at` is the place in the file.
pub fn check_size(path: &Path, at: &str, [width, height]: [u64; 2]) -> Result<[u32; 2]> {
    /// The longest side, pixels.
    const SIDE: u64 = 1 << 16;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h))
            if (1..=SIDE).contains(&width) && (1..=SIDE).contains(&height) && w.checked_mul(h).is_some() =>
        {
            Ok([w, h])
        }
        _ => Err(Error::parse(
            path,
            at,
            format!("invalid size {width}x{height}: the sides are 1 to {SIDE} pixels"),
        )),
    }
}
