//! The largest scale at which all UV islands fit into the map.

use super::island::{Mask, bounds, mask_corner, quarter_turned};
use super::pack::{Bin, Placement, pack};
use crate::error::{Error, Result};
use crate::parallel;
use crate::progress::Progress;
use std::cmp::Reverse;

/// The map for which a mesh is unwrapped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnwrapOptions {
    /// Texels along a side of the square map, 1 to [`crate::image::Image::MAX_SIDE`].
    pub size: u32,
    /// Texels between UV islands, and between them and the map's border.
    pub padding: u32,
}

impl Default for UnwrapOptions {
    fn default() -> Self {
        Self { size: 2048, padding: 4 }
    }
}

/// Cells along a side of the coarse bin, on which a first scale is searched in one order.
const COARSE: f64 = 256.0;
/// Cells along a side of the fine bin, on which UV islands are placed in several orders; the time grows with the
/// number of UV islands and the fourth power of this.
const FINE: f64 = 1024.0;
/// The same if there are more than [`MANY`] UV islands.
const FINE_FOR_MANY: f64 = 512.0;
const MANY: usize = 150;
/// Minimum number of cells along a side per UV island, times the root of the number of UV islands.
const FOR_ONE: f64 = 6.0;
/// The number of packings after a scale is known at which UV islands fit: on the coarse bin and on the fine one.
const TRIES: [usize; 2] = [9, 4];
/// The maximum number of packings overall: each time that UV islands do not fit, the scale falls.
const MOST_TRIES: usize = 40;
/// The search ends if the next scale would be less than this times the best.
const EXACT: f64 = 1.004;
/// The same after the intended number of tries.
const NEAR: f64 = 1.02;
/// The first scale on the fine bin, times the best on the coarse one, whose cells waste more.
const LESS_WASTE: f64 = 1.02;
/// The orders to try: by half the perimeter, the longer side, the cells, the shorter side; largest first.
const ORDERS: [usize; 4] = [0, 1, 2, 3];

/// Texels per unit at which the search for a layout starts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Start {
    /// An estimate of the final scale.
    Guess(f64),
    /// A scale at which nearly the same UV islands fit.
    Near(f64),
}

/// The position of each UV island on the map.
pub(super) struct Layout {
    /// Texels per unit.
    pub scale: f64,
    /// For each UV island: quarter turns, the point at its corner, and the corner's position in texels.
    islands: Vec<(u8, [f64; 2], [f64; 2])>,
}

impl Layout {
    /// Returns the position, right and down in texels, of a point of a UV island.
    pub fn place(&self, island: u32, point: [f64; 2]) -> [f64; 2] {
        let (quarters, low, at) = self.islands[island as usize];
        let p = quarter_turned(point, quarters);
        [0, 1].map(|k| at[k] + (p[k] - low[k]) * self.scale)
    }
}

/// Flattened UV islands.
type Laid = Vec<[[f64; 2]; 3]>;

/// The cells in which UV islands are packed.
struct Cells {
    /// Texels along a side of a cell.
    side: u32,
    bin: Bin,
}

impl Cells {
    fn new(options: &UnwrapOptions, wanted: f64) -> Self {
        let side = (f64::from(options.size) / wanted).ceil().max(1.0) as u32;
        // The room between the borders is at least one texel, and at least one cell.
        let width = ((options.size - 2 * options.padding) / side).max(1);
        Self { side, bin: Bin { width, gap: options.padding.div_ceil(side), most: width.saturating_mul(3) } }
    }
}

/// UV islands that fit.
struct Fit {
    places: Vec<Placement>,
    /// Texels per unit.
    scale: f64,
}

/// Packs UV islands at varying scales: on a coarse bin in one order if no scale is known, then on a fine one in
/// several.
pub(super) fn lay_out(
    laid: &[Laid],
    options: &UnwrapOptions,
    start: Start,
    progress: Progress<'_>,
) -> Result<Layout> {
    let fine = if laid.len() > MANY { FINE_FOR_MANY } else { FINE };
    let least = FOR_ONE * (laid.len() as f64).sqrt();
    let [coarse, fine] = [COARSE, fine].map(|wanted| Cells::new(options, wanted.max(least)));
    let too_many = || {
        Error::limit(
            format!("a mesh of {} UV islands on a map of {} texels per side", laid.len(), options.size),
            format!("their padding of {} texels fills it; use a larger map or less padding", options.padding),
        )
    };
    if laid.len() as u64 > fine.bin.room() {
        return Err(too_many());
    }
    let scale = match start {
        Start::Near(scale) => scale,
        Start::Guess(scale) => {
            let search = Search { laid, cells: &coarse, orders: &ORDERS[..1], tries: TRIES[0] };
            search.run(scale, progress.part(0.0, 0.2))?.map_or(scale, |fit| fit.scale * LESS_WASTE)
        }
    };
    let search = Search { laid, cells: &fine, orders: &ORDERS, tries: TRIES[1] };
    let fit = search.run(scale, progress.part(0.2, 1.0))?.ok_or_else(too_many)?;
    Ok(layout(laid, &fit, &fine, options))
}

/// A search for the largest scale on one bin.
struct Search<'a> {
    laid: &'a [Laid],
    cells: &'a Cells,
    orders: &'a [usize],
    tries: usize,
}

impl Search<'_> {
    /// Returns the largest scale found, if any. `start` is in texels per unit.
    fn run(&self, start: f64, progress: Progress<'_>) -> Result<Option<Fit>> {
        let (width, side) = (f64::from(self.cells.bin.width), f64::from(self.cells.side));
        // A UV island longer than the bin fits in no rotation.
        let mut known =
            Known { fits: 0.0, fails: f64::INFINITY, most: 0.9998 * width / longest_side(self.laid) };
        let (mut scale, mut best) = ((start / side).min(0.999 * known.most), None);
        for attempt in 0..MOST_TRIES {
            progress.at(attempt.min(self.tries) as f64 / (self.tries + 1) as f64)?;
            let packed = packed(self.laid, scale, &self.cells.bin, self.orders);
            let rows = packed.as_ref().map_or(3.0 * width, |(_, rows)| f64::from(*rows));
            match packed.filter(|_| rows <= width) {
                Some((places, _)) => {
                    known.fits = scale;
                    best = Some(Fit { places, scale: scale * side });
                }
                None => known.fails = scale,
            }
            let near = if attempt + 1 < self.tries { EXACT } else { NEAR };
            scale = known.next(scale * (width / rows).sqrt(), attempt);
            if scale < known.fits * near || (best.is_some() && attempt + 1 >= 2 * self.tries) {
                break;
            }
        }
        Ok(best)
    }
}

/// The scales tried, as far as they bound the next one.
struct Known {
    /// The largest known to fit, or 0.
    fits: f64,
    /// The smallest known not to fit, or infinity.
    fails: f64,
    /// The largest at which each UV island fits separately.
    most: f64,
}

impl Known {
    /// Returns the next scale to try: the one suggested by the last attempt, clamped between those that fit and do
    /// not.
    fn next(&self, suggested: f64, attempt: usize) -> f64 {
        let Self { fits, fails, most } = *self;
        match (fits > 0.0, fails.is_finite()) {
            (true, true) => suggested.clamp(fits + 0.2 * (fails - fits), fits + 0.6 * (fails - fits)),
            (true, false) => suggested.min(most),
            // If padding is what fills the map, scales must fall quickly.
            _ if attempt < 3 => suggested * 0.99,
            _ => suggested.min(fails * 0.6),
        }
    }
}

/// Returns the longest side of the bounding boxes of UV islands.
fn longest_side(laid: &[Laid]) -> f64 {
    let side = |laid: &Laid| {
        let [low, high] = bounds(laid.iter().flatten().copied());
        (high[0] - low[0]).max(high[1] - low[1])
    };
    laid.iter().map(side).fold(1e-9, f64::max)
}

/// Packs UV islands in several orders; returns the positions and rows of the one with the fewest rows.
fn packed(laid: &[Laid], scale: f64, bin: &Bin, orders: &[usize]) -> Option<(Vec<Placement>, u32)> {
    let masks: Vec<[Mask; 4]> = parallel::tasks(laid.len(), &|island| {
        [0, 1, 2, 3].map(|quarters| Mask::new(&laid[island], quarters, scale, 2 * bin.gap))
    });
    let size = |mask: &Mask, by: usize| match by {
        0 => (mask.width + mask.height()) as usize,
        1 => mask.width.max(mask.height()) as usize,
        2 => mask.cells(),
        _ => mask.width.min(mask.height()) as usize,
    };
    let all = parallel::tasks(orders.len(), &|i| {
        let by = orders[i];
        let mut order: Vec<u32> = (0..masks.len() as u32).collect();
        order.sort_by_cached_key(|island| (Reverse(size(&masks[*island as usize][0], by)), *island));
        pack(&masks, &order, bin)
    });
    all.into_iter().flatten().min_by_key(|(_, rows)| *rows)
}

fn layout(laid: &[Laid], fit: &Fit, cells: &Cells, options: &UnwrapOptions) -> Layout {
    let texels = |v: u32| f64::from(options.padding) + f64::from(v * cells.side);
    let island = |i: usize| {
        let place = fit.places[i];
        (place.quarters, mask_corner(&laid[i], place.quarters), [texels(place.x), texels(place.y)])
    };
    Layout { scale: fit.scale, islands: parallel::collect(laid.len(), island) }
}
