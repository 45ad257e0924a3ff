//! The shares of a surface beyond given limits.

use crate::proof::{CloseUp, Exceedance, SurfaceSample};

/// Limits that requirements name: the shares are exact at these.
#[derive(Debug, Clone, Default)]
pub(super) struct AskedLimits {
    /// Degrees.
    pub angles: Vec<f64>,
    /// CIEDE2000.
    pub colors: Vec<f64>,
    /// Per cent of the diagonal.
    pub distances: Vec<f64>,
}

/// The shares of the visible surface beyond given limits, seen close up, the worse of scan and asset.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Beyond {
    /// Limits of the angle between normals, degrees; surface that the other one lacks counts as 90.
    pub angle: Option<Exceedance>,
    /// Limits of the difference of base colours, CIEDE2000; `None` if colours are not compared.
    pub color: Option<Exceedance>,
    /// Limits of the distance to the other surface, per cent of the diagonal.
    pub distance: Option<Exceedance>,
}

impl Beyond {
    /// Counts the close-up samples of scan and asset.
    pub(super) fn of(surfaces: [&CloseUp; 2], diagonal: f32, asked: &AskedLimits) -> Self {
        let curve = |difference: &dyn Fn(&SurfaceSample) -> f32, asked: &[f64]| {
            let [scan, asset] = surfaces.map(|of| of.samples.iter().map(difference).collect::<Vec<f32>>());
            Exceedance::of([&scan, &asset], asked)
        };
        Self {
            angle: curve(&|sample| sample.angle_deg, &asked.angles),
            color: curve(&|sample| sample.color, &asked.colors),
            distance: curve(&|sample| sample.distance / diagonal * 100.0, &asked.distances),
        }
    }
}
