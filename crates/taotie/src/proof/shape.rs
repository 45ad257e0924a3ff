//! How far the shapes of two surfaces are apart.

use super::close_up::CloseUp;
use super::distance::{DistanceBounds, Source, distance_bounds};
use super::pair::Pair;

/// Less of a surface hidden than this needs no search for what is visible: noise and folds hide as much.
const HARDLY_HIDDEN: f64 = 1e-3;
/// The width of the bounds of distances, as a part of the diagonal, and as a part of the distance.
const WIDTH: [f32; 2] = [1e-3, 0.1];
/// The bounds are closer in proportion if more points than these are looked at.
const POINTS: f32 = 20_000.0;

/// The distances between what can be seen of two surfaces, in both directions, model units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct ShapeFigures {
    /// Bounds of the largest (Hausdorff distance).
    pub hausdorff: DistanceBounds,
    /// The root mean square over sampled points.
    pub rms: f64,
}

impl ShapeFigures {
    /// Measures the distances; `close_ups` are those of the scan and of the asset.
    pub fn of(pair: &Pair<'_>, close_ups: [&CloseUp; 2]) -> Self {
        Self { hausdorff: hausdorff(pair, close_ups), rms: root_mean_square(close_ups) }
    }
}

fn hausdorff(pair: &Pair<'_>, close_ups: [&CloseUp; 2]) -> DistanceBounds {
    let sides = [(pair.scan, pair.asset), (pair.asset, pair.scan)];
    let bounds = sides.into_iter().zip(close_ups).map(|((from, to), close_up)| {
        let known = close_up.samples.iter().map(|sample| sample.distance).fold(0.0, f32::max);
        let source = Source { side: from, is_partly_hidden: close_up.hidden > HARDLY_HIDDEN, known };
        let width = (pair.diagonal * WIDTH[0]).max(known * WIDTH[1]);
        // Closer where more points have to decide a requirement.
        distance_bounds(source, to.surface, width * (POINTS / close_up.points.max(1) as f32).min(1.0))
    });
    bounds.fold(DistanceBounds::default(), DistanceBounds::larger)
}

fn root_mean_square(close_ups: [&CloseUp; 2]) -> f64 {
    let samples = || close_ups.into_iter().flat_map(|close_up| &close_up.samples);
    let sum: f64 = samples().map(|sample| f64::from(sample.distance) * f64::from(sample.distance)).sum();
    (sum / samples().count().max(1) as f64).sqrt()
}
