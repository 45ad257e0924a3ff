//! Maps of a size, as they were measured on one mesh.

use super::workshop::{Draft, Workshop, under_map};
use crate::error::Result;
use crate::math::scalar::{exp, ln};

/// Qualities of WebP that are measured, from the best down.
const QUALITIES: [u8; 4] = [92, 75, 45, 15];
/// Lower qualities are not measured once the error is this many times too large.
const FAR: f64 = 1.5;
/// Steps between two qualities, and between two sizes.
const STEPS: u32 = 4;
/// Smaller numbers count as this one, whose logarithm is finite.
const LEAST: f64 = 1e-9;

/// Maps of a size.
#[derive(Debug, Clone)]
pub(super) struct MapSize {
    /// Texels along a side.
    pub size: u32,
    /// The square of the error with maps that lose nothing, degrees².
    pub squared: f64,
    /// The bytes of the mesh that they were measured on.
    pub mesh_bytes: f64,
    /// Their own bytes.
    bytes: f64,
    /// Lossy ones, from the best quality down.
    lossy: Vec<Loss>,
}

/// What a quality costs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loss {
    /// `None` loses nothing.
    pub quality: Option<u8>,
    /// What it adds to the square of the error, degrees².
    pub squared: f64,
    pub bytes: f64,
}

impl MapSize {
    /// Measures the maps of a draft that lose nothing.
    pub fn lossless(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Self> {
        let bits = under_map(draft.shape.size);
        let trial = workshop.trial(draft, workshop.rounding(bits, None))?;
        let mesh_bytes = draft.mesh_bytes(bits)? as f64;
        let squared = trial.mean_angle * trial.mean_angle;
        let bytes = trial.bytes as f64 - mesh_bytes;
        Ok(Self { size: draft.shape.size, squared, mesh_bytes, bytes, lossy: Vec::new() })
    }

    /// Measures the maps of a draft that lose nothing, and lossy ones until their error is far beyond the goal.
    pub fn measured(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Self> {
        let mut maps = Self::lossless(workshop, draft)?;
        for quality in QUALITIES {
            let rounding = workshop.rounding(under_map(draft.shape.size), Some(quality));
            let trial = workshop.trial(draft, rounding)?;
            let squared = trial.mean_angle * trial.mean_angle - maps.squared;
            maps.lossy.push(Loss {
                quality: Some(quality),
                squared,
                bytes: trial.bytes as f64 - maps.mesh_bytes,
            });
            if trial.mean_angle > FAR * workshop.goal.angle {
                break;
            }
        }
        Ok(maps)
    }

    /// Returns the fewest bytes of the maps that were measured.
    pub fn least_bytes(&self) -> f64 {
        self.losses().map(|loss| loss.bytes).fold(f64::INFINITY, f64::min)
    }

    /// Returns the losses that can be chosen: none, those of the qualities that were measured, and some in between.
    pub fn losses(&self) -> impl Iterator<Item = Loss> {
        let none = Loss { quality: None, squared: 0.0, bytes: self.bytes };
        let between =
            self.lossy.windows(2).flat_map(|pair| steps().map(|part| pair[0].toward(pair[1], part)));
        std::iter::once(none).chain(between).chain(self.lossy.last().copied())
    }

    /// Returns this size and some on the way to a larger one.
    pub fn up_to<'a>(&'a self, larger: &'a Self) -> impl Iterator<Item = Self> + 'a {
        steps().map(|part| {
            let lossy = self.lossy.iter().zip(&larger.lossy).map(|(a, b)| a.toward(*b, part)).collect();
            Self {
                size: (between(f64::from(self.size), f64::from(larger.size), part) as u32)
                    .next_multiple_of(4),
                squared: between(self.squared, larger.squared, part),
                mesh_bytes: self.mesh_bytes,
                bytes: between(self.bytes, larger.bytes, part),
                lossy,
            }
        })
    }
}

impl Loss {
    fn toward(self, other: Self, part: f64) -> Self {
        let quality = |of: Self| f64::from(of.quality.unwrap_or(100));
        Self {
            quality: Some((quality(self) * (1.0 - part) + quality(other) * part + 0.5) as u8),
            squared: between(self.squared, other.squared, part),
            bytes: between(self.bytes, other.bytes, part),
        }
    }
}

/// Returns the parts of the way from one measured thing to the next, without its end.
fn steps() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|i| f64::from(i) / f64::from(STEPS))
}

/// Interpolates logarithms.
fn between(a: f64, b: f64, part: f64) -> f64 {
    let [a, b] = [a, b].map(|v| ln(v.max(LEAST)));
    exp(a + (b - a) * part)
}
