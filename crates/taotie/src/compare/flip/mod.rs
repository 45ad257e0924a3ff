//! FLIP: how different two images look when one is flipped to the other in place.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020. Section
//! and equation numbers below are the paper's; where it leaves a choice, the authors' published code decides (half
//! widths of three standard deviations, images extended beyond their border).

mod color;
mod features;
mod spatial;

use super::plane::Plane;
use super::{DisplayImage, Field};
use crate::error::{Error, Result};
use crate::math::{Vec3, scalar};
use crate::parallel;

/// FLIP's default resolution, in pixels per degree: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Returns FLIP's error map, [0, 1]: 0 where the images look alike. It is symmetric in `reference` and `test`.
///
/// `pixels_per_degree` is the resolution of the image as seen by the viewer; the published code's default is
/// [`PIXELS_PER_DEGREE`].
///
/// # Errors
/// [`Error::Invalid`] if the sizes differ or `pixels_per_degree` is outside [1, 1000].
pub fn flip(reference: &DisplayImage, test: &DisplayImage, pixels_per_degree: f32) -> Result<Field> {
    reference.check_same_size(test)?;
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        return Err(Error::invalid(
            format!("{pixels_per_degree} pixels per degree"),
            "use a value from 1 to 1000; a screen at arm's length has about 67",
        ));
    }
    let [reference, test] = [reference, test].map(|picture| seen(picture, pixels_per_degree.into()));
    let most = color::largest_difference();
    let error = |i: usize| {
        let (a, b) = (&reference.pixels[i], &test.pixels[i]);
        if a == b {
            return 0.0;
        }
        let difference = color::redistributed(color::difference(a.lab, b.lab), most);
        scalar::pow(difference, 1.0 - features::difference(a.features, b.features)) as f32
    };
    let values = parallel::collect(reference.pixels.len(), error);
    Field::new(reference.width, reference.height, values)
}

/// An image as the eye perceives it.
struct Seen {
    width: u32,
    height: u32,
    pixels: Vec<SeenPixel>,
}

#[derive(Clone, Default, PartialEq)]
struct SeenPixel {
    /// The colour after the eye's blur: L*, and a* and b* after Hunt's effect.
    lab: Vec3<f64>,
    /// The strengths of edges and points here, [0, √2] each.
    features: [f64; 2],
}

fn seen(picture: &DisplayImage, pixels_per_degree: f64) -> Seen {
    let decoder = color::Decoder::new();
    let opponent = parallel::collect(picture.pixels.len(), |i| decoder.opponent(picture.pixels[i]));
    let plane = |component: fn(&Vec3<f64>) -> f64| Plane::new(picture.width, &opponent, component);
    let [achromatic, red_green, blue_yellow] = [plane(|c| c.x), plane(|c| c.y), plane(|c| c.z)];
    let features = features::strengths(&plane(|c| (c.x + 16.0) / 116.0), pixels_per_degree);
    let blurred = spatial::blurred([achromatic, red_green, blue_yellow], pixels_per_degree);
    let lab = perceived(&blurred, picture.width as usize);
    let pixel = |i: usize| SeenPixel { lab: lab[i], features: features[i] };
    let pixels = parallel::collect(lab.len(), pixel);
    Seen { width: picture.width, height: picture.height, pixels }
}

/// Returns L*, a* and b* of blurred colours, row by row; equal neighbours, as in a background, are converted once.
fn perceived(blurred: &[Vec3<f64>], width: usize) -> Vec<Vec3<f64>> {
    let mut all = vec![Vec3::default(); blurred.len()];
    parallel::pieces(&mut all, width, &|y, row| {
        let mut last = None;
        for (out, color) in row.iter_mut().zip(&blurred[y * width..]) {
            *out = match last {
                Some((known, lab)) if known == *color => lab,
                _ => color::hunt_lab_from_opponent(*color),
            };
            last = Some((*color, *out));
        }
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(color: [f32; 3]) -> DisplayImage {
        DisplayImage::new(24, 20, vec![color; 480]).unwrap()
    }

    fn mean(a: &DisplayImage, b: &DisplayImage) -> f64 {
        flip(a, b, PIXELS_PER_DEGREE).unwrap().summary().unwrap().mean
    }

    /// Returns colour noise, always the same.
    fn noise(seed: u32) -> DisplayImage {
        let value = |i: u32, c: u32| ((i * 3 + c + seed).wrapping_mul(2_654_435_761) >> 24) as u8;
        let pixels: Vec<_> = (0..480).map(|i| [value(i, 0), value(i, 1), value(i, 2)]).collect();
        DisplayImage::from_8bit(24, 20, &pixels).unwrap()
    }

    /// The largest difference of colour is that of green and blue (§4.1.3); black and white come close.
    #[test]
    fn flat_pictures_differ_by_their_colors_alone() {
        assert!((mean(&flat([0.0, 1.0, 0.0]), &flat([0.0, 0.0, 1.0])) - 1.0).abs() < 1e-6);
        let [black, white] = [flat([0.0; 3]), flat([1.0; 3])];
        let most = color::largest_difference();
        let expected = color::redistributed(scalar::pow(100.0, 0.7), most);
        assert!((mean(&black, &white) - expected).abs() < 1e-6 && expected > 0.9);
    }

    #[test]
    fn equal_pictures_look_alike() {
        let error = flip(&noise(1), &noise(1), PIXELS_PER_DEGREE).unwrap();
        assert!(error.values().iter().all(|v| *v == 0.0));
    }

    #[test]
    fn pictures_may_change_places() {
        let (there, back) =
            (flip(&noise(1), &noise(7), 40.0).unwrap(), flip(&noise(7), &noise(1), 40.0).unwrap());
        assert_eq!(there.values(), back.values());
        assert!(there.values().iter().all(|v| (0.0..=1.0).contains(v) && *v > 0.0));
    }

    /// Small pixels blend in the eye.
    #[test]
    fn the_farther_the_smaller() {
        let near = flip(&noise(1), &noise(7), 20.0).unwrap().summary().unwrap().mean;
        let far = flip(&noise(1), &noise(7), 200.0).unwrap().summary().unwrap().mean;
        assert!(far < near / 2.0, "{far} against {near}");
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let small = DisplayImage::new(1, 1, vec![[0.0; 3]]).unwrap();
        assert!(flip(&small, &flat([0.0; 3]), 67.0).unwrap_err().to_string().contains("24x20"));
        for wrong in [0.0, -1.0, f32::NAN, 1e6] {
            assert!(flip(&small, &small, wrong).is_err());
        }
        assert_eq!(flip(&small, &small, 67.0).unwrap().values(), [0.0]);
    }
}
