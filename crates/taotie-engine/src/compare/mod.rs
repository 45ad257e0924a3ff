//! Comparison: angles between normals, differences of colours, error metrics and similarity of images, and heat maps.
//!
//! Nothing here depends on the number of threads: pixels are independent of one another, and sums run in the order
//! of pixels.

mod color;
mod display_image;
mod field;
mod flip;
mod metrics;
mod normals;
mod plane;

pub use color::{ciede2000, color_difference};
pub use display_image::DisplayImage;
pub use display_image::stored_picture;
pub use field::{ColorMap, Field, Summary, heat};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use metrics::{SSIM_WINDOW, ssim_map};
pub use metrics::{difference, psnr, rmse, ssim};
pub use normals::stored_normals;
pub use normals::{NormalEncoding, StoredNormals, angle_deg, angular_error};

use crate::error::{Error, Result};

/// Checks that two sizes are equal.
///
/// # Errors
/// [`Error::Invalid`], which names both.
fn same_size(a: (u32, u32), b: (u32, u32)) -> Result<()> {
    if a == b {
        return Ok(());
    }
    Err(Error::invalid(
        format!("sizes {}x{} and {}x{}", a.0, a.1, b.0, b.1),
        "images must have the same size; render or resample one of them to match the other",
    ))
}

/// Checks that there is one element for each pixel of an image that is not empty.
///
/// # Errors
/// [`Error::Invalid`] if not.
fn one_per_pixel(what: &str, width: u32, height: u32, count: usize) -> Result<()> {
    if width == 0 || height == 0 || count as u64 != u64::from(width) * u64::from(height) {
        return Err(Error::invalid(
            format!("{what} of {width}x{height}"),
            format!("it has {count} elements; it must have one for each pixel, and at least one pixel"),
        ));
    }
    Ok(())
}
