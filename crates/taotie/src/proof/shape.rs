//! How far the shapes of two surfaces are apart.

use super::close_up::CloseUp;
use super::distance::{DistanceBounds, Source, distance_bounds};
use super::pair::Pair;

/// If less of a surface is hidden than this, visibility is not searched: noise and folds hide as much.
const HARDLY_HIDDEN: f64 = 1e-3;
/// The width of the bounds of distances, as a fraction of the diagonal, and as a fraction of the distance.
const WIDTH: [f32; 2] = [5e-4, 0.05];
/// Number of triangles of both surfaces above which the bounds widen in proportion, and the maximum factor.
const MANY: usize = 350_000;
const WIDEST: f32 = 3.0;
/// The bounds narrow in proportion if more points than these are examined.
const POINTS: f32 = 20_000.0;

/// Bounds the largest (Hausdorff) distance between the visible parts of two surfaces, in both directions, in model
/// units. `close_ups` are those of the scan and of the asset; the bounds narrow in proportion to `points` above
/// 20,000.
pub fn hausdorff(pair: &Pair<'_>, close_ups: [&CloseUp; 2], points: usize) -> DistanceBounds {
    let samples = || close_ups.into_iter().flat_map(|close_up| &close_up.samples);
    let farthest = samples().max_by(|a, b| a.distance.total_cmp(&b.distance));
    let known = farthest.map_or(0.0, |sample| sample.distance);
    let triangles: usize =
        [pair.scan, pair.asset].map(|side| side.surface.mesh().triangles().len()).iter().sum();
    let wider = (triangles as f32 / MANY as f32).clamp(1.0, WIDEST);
    // Narrower if more points have to decide a requirement.
    let width =
        (pair.diagonal * WIDTH[0]).max(known * WIDTH[1]) * wider * (POINTS / points.max(1) as f32).min(1.0);
    let sides = [(pair.scan, pair.asset), (pair.asset, pair.scan)];
    let at = farthest.map(|sample| sample.position.to_f64().to_array());
    let start = DistanceBounds { at, ..DistanceBounds::exactly(f64::from(known)) };
    sides.into_iter().zip(close_ups).fold(start, |bounds, ((side, to), close_up)| {
        // Only a distance larger than that of the other direction matters.
        let known = bounds.lower as f32;
        let source = Source { side, is_partly_hidden: close_up.hidden > HARDLY_HIDDEN, known };
        bounds.larger(distance_bounds(source, to.surface, width))
    })
}

/// Returns the root mean square distance over the points of both surfaces, in model units.
pub fn root_mean_square(close_ups: [&CloseUp; 2]) -> f64 {
    let samples = || close_ups.into_iter().flat_map(|close_up| &close_up.samples);
    let sum: f64 = samples().map(|sample| f64::from(sample.distance) * f64::from(sample.distance)).sum();
    (sum / samples().count().max(1) as f64).sqrt()
}
