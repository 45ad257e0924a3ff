//! The places where two images differ.

use super::options::{DiffOptions, Metric};
use super::pair::{ImageContent, ImagePair};
use crate::compare::{self, ColorMap, DisplayImage, Field};
use crate::error::Result;

/// The difference at each pixel, and how to show it.
///
/// ```
/// use taotie::comparison::diff::{DiffOptions, ImagePair, Metric, NamedBitmap};
///
/// # use taotie::image::{Bitmap, Texels};
/// # let grey = |code: u8| Bitmap::new(16, 16, 1, Texels::U8(vec![[code, code, code, 255]; 256]));
/// # let (black, white) = (grey(0)?, grey(255)?);
/// # let a = NamedBitmap { name: "black.png", bitmap: &black };
/// # let b = NamedBitmap { name: "white.png", bitmap: &white };
/// // `a` is black and `b` is white.
/// let options = DiffOptions { metric: Some(Metric::Rmse), ..DiffOptions::default() };
/// let map = ImagePair::new([a, b], &options)?.difference_map(&options)?;
/// assert_eq!((map.field.values()[0], map.top), (1.0, 1.0));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DifferenceMap {
    /// The numbers.
    pub field: Field,
    /// The quantity.
    pub title: &'static str,
    /// Its unit; may be empty.
    pub unit: &'static str,
    /// The colours.
    pub map: ColorMap,
    /// The number that maps to the last colour; the first is 0.
    pub top: f32,
}

impl ImagePair {
    /// Returns the difference at each pixel by the requested metric, else by FLIP or by the angle.
    ///
    /// # Errors
    /// As [`ImagePair::figures`].
    pub fn difference_map(&self, options: &DiffOptions) -> Result<DifferenceMap> {
        match &self.content {
            ImageContent::Normals([(a, _), (b, _)]) => {
                Ok(angle(compare::angular_error(&a.normals, &b.normals)?))
            }
            ImageContent::Pictures([a, b]) => of_pictures([a, b], options),
        }
    }
}

fn angle(field: Field) -> DifferenceMap {
    let top = scale(&field);
    DifferenceMap { field, title: "angle between normals", unit: "°", map: ColorMap::Viridis, top }
}

fn of_pictures([a, b]: [&DisplayImage; 2], options: &DiffOptions) -> Result<DifferenceMap> {
    let shown = |field, title, map, top| DifferenceMap { field, title, unit: "", map, top };
    Ok(match options.metric.unwrap_or(Metric::Flip) {
        Metric::Ssim => {
            let map = compare::ssim_map(a, b)?;
            let unlike = map.values().iter().map(|v| 1.0 - v).collect();
            shown(Field::new(map.width(), map.height(), unlike)?, "1 - SSIM", ColorMap::Viridis, 1.0)
        }
        Metric::Psnr | Metric::Rmse => {
            let field = compare::difference(a, b)?;
            let top = scale(&field);
            shown(field, "mean absolute difference", ColorMap::Viridis, top)
        }
        Metric::Flip | Metric::Angle => {
            let field = compare::flip(a, b, options.pixels_per_degree as f32)?;
            shown(field, "FLIP", ColorMap::Magma, 1.0)
        }
    })
}

/// Returns a scale robust against a few outliers: the 95 % quantile, else the largest number, else 1.
fn scale(field: &Field) -> f32 {
    let summary = field.summary();
    let tops = summary.map_or([0.0; 2], |summary| [summary.p95, summary.max]);
    tops.into_iter().map(|top| top as f32).find(|top| *top > 0.0).unwrap_or(1.0)
}
