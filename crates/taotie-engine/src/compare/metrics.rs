//! Metrics of the difference of two images: the root mean square error, the peak signal-to-noise ratio, the
//! difference of each pixel, and the structural similarity.

use super::field::{Field, Plane, RowPart, blurred_differences};
use super::{DisplayImage, one_per_pixel};
use crate::error::{Error, Result};
use crate::math::scalar;
use crate::parallel;

/// Returns the root of the mean squared difference over all channels of all pixels, [0, 1].
///
/// # Errors
/// [`Error::Invalid`] if the sizes differ.
pub fn rmse(a: &DisplayImage, b: &DisplayImage) -> Result<f64> {
    Ok(mean_squared(a, b, None)?.sqrt())
}

/// Returns [`rmse`] over the pixels for which `keep`, one flag per pixel, is `true`; 0 if there are none.
///
/// # Errors
/// [`Error::Invalid`] if the sizes differ, or `keep` has a different length.
pub fn rmse_within(a: &DisplayImage, b: &DisplayImage, keep: &[bool]) -> Result<f64> {
    Ok(mean_squared(a, b, Some(keep))?.sqrt())
}

/// Returns the peak signal-to-noise ratio in decibels, −10 log₁₀ of the mean squared difference, with a peak of 1;
/// infinite for equal images.
///
/// # Errors
/// As [`rmse`].
pub fn psnr(a: &DisplayImage, b: &DisplayImage) -> Result<f64> {
    Ok(decibels(mean_squared(a, b, None)?))
}

/// Returns [`psnr`] over the pixels for which `keep`, one flag per pixel, is `true`; infinite if there are none.
///
/// # Errors
/// As [`rmse_within`].
pub fn psnr_within(a: &DisplayImage, b: &DisplayImage, keep: &[bool]) -> Result<f64> {
    Ok(decibels(mean_squared(a, b, Some(keep))?))
}

fn decibels(squared: f64) -> f64 {
    if squared == 0.0 { f64::INFINITY } else { -10.0 * scalar::log10(squared) }
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

/// Returns the mean over all pixels, or over those to keep; 0 if there are none.
fn mean_squared(a: &DisplayImage, b: &DisplayImage, keep: Option<&[bool]>) -> Result<f64> {
    a.check_same_size(b)?;
    keep.map_or(Ok(()), |keep| one_per_pixel("a mask", a.width(), a.height(), keep.len()))?;
    let is_kept = |i: &usize| keep.is_none_or(|keep| keep[*i]);
    let squared = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)) * (f64::from(*a) - f64::from(*b));
    let (mut sum, mut count) = (0.0, 0usize);
    for i in (0..a.pixels().len()).filter(is_kept) {
        sum = a.pixels()[i].iter().zip(&b.pixels()[i]).map(squared).fold(sum, |sum, v| sum + v);
        count += 3;
    }
    Ok(sum / count.max(1) as f64)
}

/// The side of SSIM's window, in pixels: images must be at least that large.
pub const SSIM_WINDOW: u32 = 11;

/// The standard deviation of the window's Gaussian weights, in pixels.
const SIGMA: f64 = 1.5;
/// (K₁ L)² and (K₂ L)², the range L being 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Returns the mean structural similarity, (−1, 1]; 1 for equal images.
///
/// It is the mean over every window inside the images and over the channels red, green and blue.
///
/// Source: Wang, Bovik, Sheikh and Simoncelli 2004, equations 13 to 17: 11×11 Gaussian weights of standard deviation
/// 1.5, K₁ = 0.01, K₂ = 0.03.
///
/// # Errors
/// [`Error::Invalid`] if the sizes differ or a side is below 11 pixels.
pub fn ssim(a: &DisplayImage, b: &DisplayImage) -> Result<f64> {
    Ok(mean(similarity(a, b)?.into_iter()))
}

/// Returns [`ssim`] over the windows around the pixels for which `keep`, one flag per pixel, is `true`; over all windows
/// if none of these is inside the images.
///
/// # Errors
/// As [`ssim`], and [`Error::Invalid`] if `keep` has a different length.
pub fn ssim_within(a: &DisplayImage, b: &DisplayImage, keep: &[bool]) -> Result<f64> {
    one_per_pixel("a mask", a.width(), a.height(), keep.len())?;
    let all = similarity(a, b)?;
    let kept = all.iter().zip(keep).filter(|(_, keep)| **keep).map(|(v, _)| *v);
    match kept.clone().all(f64::is_nan) {
        true => Ok(mean(all.iter().copied())),
        false => Ok(mean(kept)),
    }
}

/// Returns the mean of all values that are numbers, of which there is at least one.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.filter(|v| !v.is_nan()).fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count)
}

/// Returns the structural similarity around each pixel, the mean of its channels; NaN if the window leaves the image.
///
/// # Errors
/// As [`ssim`].
pub fn ssim_map(a: &DisplayImage, b: &DisplayImage) -> Result<Field> {
    Field::new(a.width(), a.height(), similarity(a, b)?.into_iter().map(|v| v as f32).collect())
}

fn similarity(a: &DisplayImage, b: &DisplayImage) -> Result<Vec<f64>> {
    a.check_same_size(b)?;
    let (width, height) = (a.width(), a.height());
    if width.min(height) < SSIM_WINDOW {
        return Err(Error::invalid(
            format!("pictures of {width}x{height}"),
            format!(
                "SSIM uses windows of {SSIM_WINDOW}x{SSIM_WINDOW} pixels; both sides must be at least that large"
            ),
        ));
    }
    let is_grey = |picture: &DisplayImage| picture.pixels().iter().all(|[r, g, b]| r == g && g == b);
    let channels = if is_grey(a) && is_grey(b) { 1 } else { 3 };
    let planes: Vec<[Plane; 2]> = (0..channels).map(|c| channel([a, b], c)).collect();
    let (kernel, radius) = (window(), SSIM_WINDOW as usize / 2);
    let (width, height) = (width as usize, height as usize);
    let parts = blurred_differences([a, b], radius);
    let mut values = vec![f64::NAN; width * height];
    parallel::pieces(&mut values, width, &|y, row| {
        if !(radius..height - radius).contains(&y) {
            return;
        }
        // Equal windows are alike, whatever they show.
        row[radius..width - radius].fill(1.0);
        let columns = parts[y].columns.start.max(radius)..parts[y].columns.end.min(width - radius);
        if columns.is_empty() {
            return;
        }
        let part = RowPart { y, columns };
        let found: Vec<Vec<f64>> =
            planes.iter().map(|pair| channel_similarity(pair, &part, &kernel)).collect();
        for (i, out) in row[part.columns].iter_mut().enumerate() {
            *out = found.iter().fold(0.0, |sum, channel| sum + channel[i]) / f64::from(channels);
        }
    });
    Ok(values)
}

/// Returns a channel of two images.
fn channel(images: [&DisplayImage; 2], channel: u8) -> [Plane; 2] {
    let number = |pixel: &[f32; 3]| f64::from(pixel[usize::from(channel)]);
    images.map(|image| Plane::new((image.width(), SSIM_WINDOW as usize / 2), image.pixels(), number))
}

/// Returns the similarity of a channel around each of some pixels, and of others after them.
fn channel_similarity([a, b]: &[Plane; 2], part: &RowPart, kernel: &[f64]) -> Vec<f64> {
    let across = |strip: Vec<f64>| a.across(&strip, kernel);
    let means = [a, b].map(|plane| across(plane.down(part, kernel)));
    let squares = [(a, a), (b, b), (a, b)].map(|(a, b)| across(a.product_down(b, part, kernel)));
    let [mean_a, mean_b] = &means;
    let of = |i: usize| ssim_of_moments(mean_a[i], mean_b[i], [0, 1, 2].map(|k| squares[k][i]));
    (0..mean_a.len()).map(of).collect()
}

/// Equation 13 of Wang et al. 2004 from the weighted means of a, b, a², b² and a·b.
fn ssim_of_moments(a: f64, b: f64, [aa, bb, ab]: [f64; 3]) -> f64 {
    let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
    let numerator = (2.0 * a * b + C1) * (2.0 * covariance + C2);
    numerator / ((a * a + b * b + C1) * (variance_a + variance_b + C2))
}

/// The window's weights along one axis; they sum to 1.
fn window() -> [f64; SSIM_WINDOW as usize] {
    let weights = std::array::from_fn(|i| {
        let x = i as f64 - f64::from(SSIM_WINDOW / 2);
        scalar::exp(-x * x / (2.0 * SIGMA * SIGMA))
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
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
    fn a_border_that_is_not_kept_changes_no_figure() {
        let value = |x: u32, y: u32| ((x * 7 + y * 3) % 11) as f32 / 11.0;
        let [a, b] = [0.0, 0.1].map(|more| picture(32, |x, y| (value(x, y) + more).min(1.0)));
        let padded = |image: &DisplayImage| {
            picture(64, |x, y| match (16..48).contains(&x) && (16..48).contains(&y) {
                true => image.pixels()[((y - 16) * 32 + x - 16) as usize][0],
                false => 0.25,
            })
        };
        let (wide_a, wide_b) = (padded(&a), padded(&b));
        let inside = |border: u32| -> Vec<bool> {
            let is = |v: u32| (16 + border..48 - border).contains(&v);
            (0..64 * 64).map(|i| is(i % 64) && is(i / 64)).collect()
        };
        assert_eq!(rmse_within(&wide_a, &wide_b, &inside(0)).unwrap(), rmse(&a, &b).unwrap());
        assert_eq!(psnr_within(&wide_a, &wide_b, &inside(0)).unwrap(), psnr(&a, &b).unwrap());
        assert!(rmse(&wide_a, &wide_b).unwrap() < 0.6 * rmse(&a, &b).unwrap());
        // Windows around these pixels do not leave the smaller images.
        let [within, whole] = [ssim_within(&wide_a, &wide_b, &inside(5)), ssim(&a, &b)].map(Result::unwrap);
        assert!((within - whole).abs() < 1e-12, "{within} {whole}");
        let nothing = vec![false; 64 * 64];
        assert_eq!(rmse_within(&wide_a, &wide_b, &nothing).unwrap(), 0.0);
        assert_eq!(ssim_within(&wide_a, &wide_b, &nothing).unwrap(), ssim(&wide_a, &wide_b).unwrap());
        assert!(ssim_within(&a, &b, &nothing).is_err() && rmse_within(&a, &b, &nothing).is_err());
    }

    #[test]
    fn other_sizes_are_named() {
        let why =
            rmse(&flat(0.0), &DisplayImage::new(1, 1, vec![[0.0; 3]]).unwrap()).unwrap_err().to_string();
        assert!(why.contains("4x3") && why.contains("1x1"), "{why}");
    }

    fn picture(side: u32, value: impl Fn(u32, u32) -> f32) -> DisplayImage {
        let pixels = (0..side * side).map(|i| [value(i % side, i / side); 3]).collect();
        DisplayImage::new(side, side, pixels).unwrap()
    }

    #[test]
    fn equal_pictures_are_one_and_opposite_ones_below_zero() {
        let checks = picture(16, |x, y| ((x + y) % 2) as f32);
        let opposite = picture(16, |x, y| ((x + y + 1) % 2) as f32);
        assert!((ssim(&checks, &checks).unwrap() - 1.0).abs() < 1e-12);
        assert!(ssim(&checks, &opposite).unwrap() < -0.9);
    }

    #[test]
    fn flat_pictures_differ_in_luminance_alone() {
        let value = ssim(&picture(11, |_, _| 0.25), &picture(11, |_, _| 0.75)).unwrap();
        let expected = (2.0 * 0.25 * 0.75 + C1) / (0.25 * 0.25 + 0.75 * 0.75 + C1);
        assert!((value - expected).abs() < 1e-9, "{value} is not {expected}");
    }

    #[test]
    fn the_map_has_numbers_where_the_window_fits() {
        let map =
            ssim_map(&picture(12, |x, _| x as f32 / 12.0), &picture(12, |_, y| y as f32 / 12.0)).unwrap();
        assert_eq!(map.summary().unwrap().count, 4);
        assert!(
            ssim(&picture(10, |_, _| 0.0), &picture(10, |_, _| 0.0))
                .unwrap_err()
                .to_string()
                .contains("10x10")
        );
    }
}
