//! Comparison: the angle between normals, the difference of colours, the error and the likeness of images, and images of
//! them.
//!
//! Nothing here depends on the number of threads: pixels are independent of one another, and sums run in the order
//! of pixels.

mod angle;
mod ciede2000;
mod display_image;
mod error;
mod field;
mod flip;
mod heat;
mod lab;
mod plane;
mod ssim;
mod stored;

pub use angle::{angle_deg, angular_error};
pub use ciede2000::{ciede2000, color_difference};
pub use display_image::DisplayImage;
pub use error::{difference, psnr, rmse};
pub use field::{Field, Summary};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use heat::{ColorMap, heat};
pub use ssim::{SSIM_WINDOW, ssim, ssim_map};
pub use stored::{NormalEncoding, StoredNormals, stored_normals, stored_picture};

use crate::error::{Error, Result};

/// That two sizes are one.
///
/// # Errors
/// [`Error::Invalid`] that names both.
fn same_size(a: (u32, u32), b: (u32, u32)) -> Result<()> {
    if a == b {
        return Ok(());
    }
    Err(Error::invalid(
        format!("sizes {}x{} and {}x{}", a.0, a.1, b.0, b.1),
        "only pictures of one size can be compared; render or resample one of them to the size of the other",
    ))
}

/// Checks that there is one element for each pixel of an image that is not empty.
///
/// # Errors
/// [`Error::Invalid`] where it is not so.
fn one_per_pixel(what: &str, width: u32, height: u32, count: usize) -> Result<()> {
    if width == 0 || height == 0 || count as u64 != u64::from(width) * u64::from(height) {
        return Err(Error::invalid(
            format!("{what} of {width}x{height}"),
            format!("it has {count} elements; it must have one for each pixel, and at least one pixel"),
        ));
    }
    Ok(())
}
