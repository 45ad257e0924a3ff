//! Maps of a size, as measured on one mesh.

use super::encodings::{Encodings, NORMAL_RATIOS};
use super::workshop::{Draft, Workshop, under_map};
use crate::error::Result;
use crate::image::Encoding;
use crate::io::{ImageCodec, LossyTexture};
use crate::math::scalar::{exp, ln};
use crate::proof::{Relook, Side};

/// Steps between two sizes.
const STEPS: u32 = 4;
/// The lower bound of values, which keeps logarithms finite.
const LEAST: f64 = 1e-9;

/// Maps of a size.
#[derive(Debug, Clone)]
pub(super) struct MapSize {
    /// Texels along a side.
    pub size: u32,
    /// The square of the ratio of angles with lossless maps.
    pub squared: f64,
    /// The bytes of the mesh that they were measured on.
    pub mesh_bytes: f64,
    /// The measured bytes of all maps.
    bytes: f64,
    /// The possible losses of the normal map, in ascending order, with the resulting bytes of all maps.
    lossy: Vec<Loss>,
}

/// The cost of a lossy normal map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loss {
    pub normals: ImageCodec,
    /// Its contribution to that square.
    pub squared: f64,
    pub bytes: f64,
}

impl MapSize {
    /// Measures the maps of a draft.
    pub fn measured(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Self> {
        let mut lossy = losses(workshop, draft)?;
        if lossy.is_empty() {
            lossy.push(Loss { normals: workshop.codecs().least_lossy(), squared: 0.0, bytes: 0.0 });
        }
        let least = lossy[0];
        let mut maps = Self::with(workshop, draft, least)?;
        let others = maps.bytes - least.bytes;
        maps.lossy = lossy.into_iter().map(|loss| Loss { bytes: loss.bytes + others, ..loss }).collect();
        Ok(maps)
    }

    /// Measures the maps of a draft with one loss.
    pub fn with(workshop: &mut Workshop<'_>, draft: &Draft, loss: Loss) -> Result<Self> {
        let bits = under_map(draft.shape.size);
        let trial = workshop.trial(draft, workshop.rounding(bits, loss.normals))?;
        let mesh_bytes = draft.mesh_bytes(bits, workshop.codecs().set)? as f64;
        let squared = (trial.angle_ratio * trial.angle_ratio - loss.squared).max(0.0);
        let bytes = trial.bytes as f64 - mesh_bytes;
        Ok(Self { size: draft.shape.size, squared, mesh_bytes, bytes, lossy: vec![loss] })
    }

    /// Returns the smallest loss.
    pub fn least(&self) -> Loss {
        self.lossy[0]
    }

    /// Returns the fewest bytes of the measured maps.
    pub fn least_bytes(&self) -> f64 {
        self.losses().map(|loss| loss.bytes).fold(f64::INFINITY, f64::min)
    }

    /// Returns the available losses.
    pub fn losses(&self) -> impl Iterator<Item = Loss> {
        self.lossy.iter().copied()
    }

    /// Returns this size and some between it and a larger one.
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
        Self {
            squared: between(self.squared, other.squared, part),
            bytes: between(self.bytes, other.bytes, part),
            ..self
        }
    }
}

/// Returns the possible losses of a draft's normal map, in ascending order, each with the bytes of that map.
fn losses(workshop: &Workshop<'_>, draft: &Draft) -> Result<Vec<Loss>> {
    let Some(normals) = &draft.maps.textures.normal else { return Ok(Vec::new()) };
    let (texture, size) = (LossyTexture::new(normals.clone(), Encoding::Normal), draft.shape.size);
    let surface = workshop.surface(draft)?;
    let side = Side::of(&surface);
    let look = Relook::new(&side, workshop.picture());
    let Some(look) = look.first(Encoding::Normal)? else { return Ok(Vec::new()) };
    let encodings = Encodings::new(&texture, look, (&workshop.goal, workshop.codecs()));
    let mut losses: Vec<Loss> = Vec::with_capacity(NORMAL_RATIOS.len());
    for ratio in NORMAL_RATIOS {
        let Some(encoded) = encodings.smallest_of(size, ratio)? else { continue };
        let (squared, bytes) = (encoded.ratio * encoded.ratio, encoded.bytes.len() as f64);
        losses.push(Loss { normals: encoded.codec, squared, bytes });
    }
    Ok(losses)
}

/// Returns the interpolation fractions between two measured sizes, without the end.
fn steps() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|i| f64::from(i) / f64::from(STEPS))
}

/// Interpolates logarithmically.
fn between(a: f64, b: f64, part: f64) -> f64 {
    let [a, b] = [a, b].map(|v| ln(v.max(LEAST)));
    exp(a + (b - a) * part)
}
