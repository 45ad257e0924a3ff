//! The root mean square error, the peak signal-to-noise ratio, and the difference of each pixel.

use super::{DisplayImage, Field};
use crate::error::Result;
use crate::math::scalar;

/// Returns the root of the mean squared difference over all channels of all pixels, [0, 1].
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the sizes differ.
pub fn rmse(a: &DisplayImage, b: &DisplayImage) -> Result<f64> {
    Ok(mean_squared(a, b)?.sqrt())
}

/// Returns the peak signal-to-noise ratio in decibels, −10 log₁₀ of the mean squared difference, with a peak of 1;
/// infinite for equal images.
///
/// # Errors
/// As [`rmse`].
pub fn psnr(a: &DisplayImage, b: &DisplayImage) -> Result<f64> {
    let squared = mean_squared(a, b)?;
    Ok(if squared == 0.0 { f64::INFINITY } else { -10.0 * scalar::log10(squared) })
}

/// Returns the mean absolute difference of the three channels, per pixel, [0, 1].
///
/// # Errors
/// As [`rmse`].
pub fn difference(a: &DisplayImage, b: &DisplayImage) -> Result<Field> {
    a.check_same_size(b)?;
    let mean = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f32>() / 3.0;
    Field::new(a.width(), a.height(), a.pixels().iter().zip(b.pixels()).map(mean).collect())
}

fn mean_squared(a: &DisplayImage, b: &DisplayImage) -> Result<f64> {
    a.check_same_size(b)?;
    let channels = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    let squared = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)) * (f64::from(*a) - f64::from(*b));
    let sum = channels.map(squared).fold(0.0, |sum, v| sum + v);
    Ok(sum / (a.pixels().len() * 3) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: f32) -> DisplayImage {
        DisplayImage::new(4, 3, vec![[value; 3]; 12]).unwrap()
    }

    #[test]
    fn a_tenth_everywhere_is_twenty_decibels() {
        assert!((rmse(&flat(0.5), &flat(0.6)).unwrap() - 0.1).abs() < 1e-7);
        assert!((psnr(&flat(0.5), &flat(0.6)).unwrap() - 20.0).abs() < 1e-5);
        assert_eq!(rmse(&flat(0.0), &flat(1.0)).unwrap(), 1.0);
        assert_eq!(psnr(&flat(1.0), &flat(0.0)).unwrap(), 0.0);
    }

    #[test]
    fn equal_pictures_differ_in_nothing() {
        assert_eq!(rmse(&flat(0.3), &flat(0.3)).unwrap(), 0.0);
        assert_eq!(psnr(&flat(0.3), &flat(0.3)).unwrap(), f64::INFINITY);
    }

    #[test]
    fn pixels_differ_by_the_mean_of_their_channels() {
        let red = DisplayImage::new(2, 1, vec![[0.75, 0.0, 0.0], [0.0; 3]]).unwrap();
        let black = DisplayImage::new(2, 1, vec![[0.0; 3]; 2]).unwrap();
        assert_eq!(difference(&black, &red).unwrap().values(), [0.25, 0.0]);
    }

    #[test]
    fn other_sizes_are_named() {
        let why =
            rmse(&flat(0.0), &DisplayImage::new(1, 1, vec![[0.0; 3]]).unwrap()).unwrap_err().to_string();
        assert!(why.contains("4x3") && why.contains("1x1"), "{why}");
    }
}
