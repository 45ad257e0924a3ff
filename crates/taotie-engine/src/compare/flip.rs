//! FLIP: how different two images look when one is flipped to the other in place.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020. Section
//! and equation numbers below are the paper's; where it leaves a choice, the authors' published code decides (half
//! widths of three standard deviations, images extended beyond their border).

use super::DisplayImage;
use super::color::{XYZ_FROM_RGB, lab_from_linear, opponent, product};
use super::field::{Field, Plane, RowPart, blurred_differences};
use crate::error::{Error, Result};
use crate::math::srgb::linear_from_srgb;
use crate::math::{Vec3, scalar};
use crate::parallel;
use std::f64::consts::PI;

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
    let eye = Eye::new(pixels_per_degree.into());
    let width = reference.width() as usize;
    let parts = blurred_differences([reference, test], eye.border());
    let [a, b] = [reference, test].map(|image| Opponent::new(image, eye.border()));
    let most = largest_difference();
    let mut values = vec![0.0; reference.pixels().len()];
    parallel::pieces(&mut values, width, &|y, row| {
        let part = &parts[y];
        let pixels = eye.seen(&a, part).into_iter().zip(eye.seen(&b, part));
        for (out, (a, b)) in row[part.columns.clone()].iter_mut().zip(pixels) {
            if a != b {
                let difference = redistributed(color_distance(a.lab, b.lab), most);
                *out = scalar::pow(difference, 1.0 - feature_difference(a.features, b.features)) as f32;
            }
        }
    });
    Field::new(reference.width(), reference.height(), values)
}

/// An image in YCxCz, which is CIELAB without its cube root: §4.1.1.
struct Opponent {
    /// The achromatic channel, red to green, blue to yellow.
    channels: [Plane; 3],
}

impl Opponent {
    fn new(image: &DisplayImage, border: usize) -> Self {
        let decoder = Decoder::new();
        let colors = parallel::collect(image.pixels().len(), |i| decoder.opponent(image.pixels()[i]));
        let plane = |channel: fn(&Vec3<f64>) -> f64| Plane::new((image.width(), border), &colors, channel);
        Self { channels: [plane(|c| c.x), plane(|c| c.y), plane(|c| c.z)] }
    }
}

/// A pixel as the eye perceives it.
#[derive(Clone, PartialEq)]
struct SeenPixel {
    /// The colour after the eye's blur: L*, and a* and b* after Hunt's effect.
    lab: Vec3<f64>,
    /// The strengths of edges and points here, [0, √2] each.
    features: [f64; 2],
}

/// The eye's filters at a resolution.
struct Eye {
    /// The contrast sensitivity of each channel: Gaussians with their share of the sum.
    sensitivities: [Vec<(f64, Vec<f64>)>; 3],
    features: Kernels,
}

impl Eye {
    fn new(pixels_per_degree: f64) -> Self {
        Self {
            sensitivities: SENSITIVITIES.map(|sum| gaussians(sum, pixels_per_degree)),
            features: Kernels::new(0.5 * EDGE_WIDTH * pixels_per_degree),
        }
    }

    /// Returns the number of pixels that the filters reach.
    fn border(&self) -> usize {
        self.sensitivities[0][0].1.len().max(self.features.blur.len()) / 2
    }

    /// Returns pixels of an image as they are perceived.
    fn seen(&self, image: &Opponent, part: &RowPart) -> Vec<SeenPixel> {
        if part.columns.is_empty() {
            return Vec::new();
        }
        let features = self.features.strengths(&image.channels[0], part);
        let [y, cx, cz] = [0, 1, 2].map(|c| blurred(&image.channels[c], part, &self.sensitivities[c]));
        let mut last = (Vec3::default(), hunt_lab_from_opponent(Vec3::default()));
        let pixel = |i: usize| {
            let color = Vec3::new(y[i], cx[i], cz[i]);
            // Neighbours are often equal.
            if last.0 != color {
                last = (color, hunt_lab_from_opponent(color));
            }
            SeenPixel { lab: last.1, features: features[i] }
        };
        (0..part.columns.len()).map(pixel).collect()
    }
}

/// The exponent q_c and the bend (p_c, p_t) of the scale of differences, §4.1.3.
const EXPONENT: f64 = 0.7;
const BEND: (f64, f64) = (0.4, 0.95);

/// Decodes sRGB colours; the linear values of 8-bit codes are precomputed.
struct Decoder {
    /// The linear value of each 8-bit code.
    linear: Vec<f64>,
}

impl Decoder {
    fn new() -> Self {
        Self { linear: (0..=255).map(|code| linear_from_srgb(of_code(code).into())).collect() }
    }

    /// Returns the colour in YCxCz, which is CIELAB without its cube root, from one in [0, 1]: §4.1.1.
    fn opponent(&self, encoded: [f32; 3]) -> Vec3<f64> {
        opponent(product(&XYZ_FROM_RGB, Vec3::from_array(encoded.map(|v| self.linear(v)))))
    }

    fn linear(&self, encoded: f32) -> f64 {
        let code = (encoded * 255.0 + 0.5) as u8;
        match of_code(code) == encoded {
            true => self.linear[usize::from(code)],
            false => linear_from_srgb(encoded.into()),
        }
    }
}

/// Returns the linear value of an 8-bit code.
fn of_code(code: u8) -> f32 {
    f32::from(code) / 255.0
}

/// Returns L*, and a* and b* adjusted for Hunt's effect, of a colour in YCxCz that is first clamped to the gamut of a
/// screen: §4.1.2.
fn hunt_lab_from_opponent(color: Vec3<f64>) -> Vec3<f64> {
    let y = (color.x + 16.0) / 116.0;
    let xyz = Vec3::new(y + color.y / 500.0, y, y - color.z / 200.0);
    hunt_lab_from_rgb(rgb_from_xyz(xyz).map(|v| v.clamp(0.0, 1.0)))
}

/// Returns the distance of two colours: city block in lightness, Euclidean in chroma (HyAB), to the power q_c.
fn color_distance(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    let d = a - b;
    scalar::pow(d.x.abs() + (d.y * d.y + d.z * d.z).sqrt(), EXPONENT)
}

/// Returns the largest distance that a screen can show: that of its green and its blue.
fn largest_difference() -> f64 {
    let [green, blue] = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)].map(hunt_lab_from_rgb);
    color_distance(green, blue)
}

/// Maps a distance to FLIP's scale, [0, 1]: the lower 40 % of `largest` take 95 % of it.
fn redistributed(difference: f64, largest: f64) -> f64 {
    let (low, bend) = (BEND.0 * largest, BEND.1);
    match difference < low {
        true => bend / low * difference,
        // Colours are rounded: two that come close to the extremes may be farther apart than the maximum.
        false => (bend + (difference - low) / (largest - low) * (1.0 - bend)).min(1.0),
    }
}

fn hunt_lab_from_rgb(linear: Vec3<f64>) -> Vec3<f64> {
    let lab = lab_from_linear(linear);
    Vec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

/// Linear sRGB from XYZ by Cramer's rule.
fn rgb_from_xyz(v: Vec3<f64>) -> Vec3<f64> {
    let [x, y, z] = XYZ_FROM_RGB;
    let column = |c: usize| Vec3::new(x[c], y[c], z[c]);
    let (r, g, b) = (column(0), column(1), column(2));
    let (gb, br, rg) = (g.cross(b), b.cross(r), r.cross(g));
    Vec3::new(v.dot(gb), v.dot(br), v.dot(rg)) / r.dot(gb)
}

/// A sum of Gaussians a·√(π/b)·exp(−π²d²/b), d in degrees: (a, b) of each.
type Sensitivity = &'static [(f64, f64)];

/// Table 1, after Johnson and Fairchild 2003: achromatic, red to green, blue to yellow.
const SENSITIVITIES: [Sensitivity; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// The b of the broadest Gaussian.
const BROADEST: f64 = 0.04;

/// Returns a channel of YCxCz filtered by the contrast sensitivity of the eye, equations 2 to 4. Each Gaussian separates
/// into rows and columns, so their sum is a weighted sum of separable filters.
fn blurred(channel: &Plane, part: &RowPart, sensitivity: &[(f64, Vec<f64>)]) -> Vec<f64> {
    let mut sum = vec![0.0; part.columns.len()];
    for (share, kernel) in sensitivity {
        for (sum, value) in sum.iter_mut().zip(channel.across(&channel.down(part, kernel), kernel)) {
            *sum += share * value;
        }
    }
    sum
}

/// Returns the Gaussians of a sensitivity with their share of the sum.
fn gaussians(sensitivity: Sensitivity, pixels_per_degree: f64) -> Vec<(f64, Vec<f64>)> {
    let weighted: Vec<_> =
        sensitivity.iter().map(|(a, b)| weighted_gaussian(*a, *b, pixels_per_degree)).collect();
    let total = weighted.iter().fold(0.0, |sum, (weight, _)| sum + weight);
    weighted.into_iter().map(|(weight, kernel)| (weight / total, kernel)).collect()
}

/// Returns the weight of a Gaussian in two dimensions, and the Gaussian in one dimension normalised to a sum of 1.
fn weighted_gaussian(a: f64, b: f64, pixels_per_degree: f64) -> (f64, Vec<f64>) {
    let radius = (3.0 * (BROADEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let value = |x: i32| {
        let degrees = f64::from(x) / pixels_per_degree;
        scalar::exp(-PI * PI * degrees * degrees / b)
    };
    let kernel: Vec<f64> = (-radius..=radius).map(value).collect();
    let sum: f64 = kernel.iter().sum();
    (a * (PI / b).sqrt() * sum * sum, kernel.into_iter().map(|v| v / sum).collect())
}

/// The distance from peak to trough of the eye's edge detector, degrees: §4.2.1.
const EDGE_WIDTH: f64 = 0.082;

/// Returns the difference of features, [0, 1]: §4.2.2 with the exponent q_f = 0.5.
fn feature_difference(a: [f64; 2], b: [f64; 2]) -> f64 {
    let most = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    (most * std::f64::consts::FRAC_1_SQRT_2).sqrt()
}

/// A Gaussian and its first two derivatives in one dimension.
struct Kernels {
    blur: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

impl Kernels {
    fn new(deviation: f64) -> Self {
        let radius = (3.0 * deviation).ceil() as i32;
        let kernel = |factor: &dyn Fn(f64) -> f64| {
            let value = |x: i32| {
                factor(f64::from(x)) * scalar::exp(-f64::from(x * x) / (2.0 * deviation * deviation))
            };
            balanced((-radius..=radius).map(value).collect())
        };
        Self {
            blur: kernel(&|_| 1.0),
            edge: kernel(&|x| -x),
            point: kernel(&|x| x * x / (deviation * deviation) - 1.0),
        }
    }

    /// Returns the strengths at some pixels of edges and points, whose change is immediately visible: the lengths of the
    /// gradient and of the vector of second derivatives of the blurred lightness, §4.2.1.
    fn strengths(&self, achromatic: &Plane, part: &RowPart) -> Vec<[f64; 2]> {
        let [blur, edge, point] =
            [&self.blur, &self.edge, &self.point].map(|kernel| achromatic.down(part, kernel));
        let across = |strip: &[f64], kernel: &[f64]| achromatic.across(strip, kernel);
        let edges = [across(&blur, &self.edge), across(&edge, &self.blur)];
        let points = [across(&blur, &self.point), across(&point, &self.blur)];
        // Lightness is (achromatic + 16) / 116; the sum of a derivative's weights is 0.
        let length = |[x, y]: &[Vec<f64>; 2], i: usize| (x[i] * x[i] + y[i] * y[i]).sqrt() / 116.0;
        (0..part.columns.len()).map(|i| [length(&edges, i), length(&points, i)]).collect()
    }
}

/// The kernel with positive weights that sum to 1 and negative ones that sum to −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| kernel.iter().filter(|v| **v * sign > 0.0).fold(0.0, |sum, v| sum + v.abs());
    let (positive, negative) = (sum(1.0), sum(-1.0));
    kernel.iter().map(|v| if *v < 0.0 { v / negative } else { v / positive }).collect()
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
        let most = largest_difference();
        let expected = redistributed(scalar::pow(100.0, 0.7), most);
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

    #[test]
    fn white_is_a_hundred_and_has_no_hue() {
        let lab = hunt_lab_from_opponent(Decoder::new().opponent([1.0; 3]));
        assert!((lab - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-9, "{lab:?}");
    }

    #[test]
    fn values_of_codes_and_between_them_are_decoded_alike() {
        let decoder = Decoder::new();
        let between = (0..=255u8).map(|code| of_code(code) * 0.999);
        for value in (0..=255).map(of_code).chain(between) {
            assert_eq!(decoder.linear(value), linear_from_srgb(value.into()), "{value}");
        }
    }

    #[test]
    fn the_way_to_the_opponent_space_has_a_way_back() {
        let rgb = Vec3::new(0.9, 0.2, 0.4);
        assert!((rgb_from_xyz(product(&XYZ_FROM_RGB, rgb)) - rgb).length() < 1e-12);
    }

    #[test]
    fn the_scale_has_its_bend_and_its_ends() {
        assert_eq!(redistributed(0.0, 50.0), 0.0);
        assert!((redistributed(20.0, 50.0) - 0.95).abs() < 1e-12);
        assert!((redistributed(50.0, 50.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_step_is_an_edge_of_full_strength_and_a_flat_plane_is_none() {
        let strengths = |lightness: fn(usize) -> f64| {
            let pixels: Vec<f64> = (0..64 * 3).map(|i| lightness(i % 64) * 116.0 - 16.0).collect();
            let kernels = Kernels::new(0.5 * EDGE_WIDTH * 67.0);
            let plane = Plane::new((64, kernels.blur.len() / 2), &pixels, |v| *v);
            kernels.strengths(&plane, &RowPart { y: 1, columns: 0..64 })
        };
        let step = strengths(|x| if x < 32 { 0.0 } else { 1.0 });
        let strongest = step.iter().fold(0.0f64, |most, s| most.max(s[0]));
        assert!((0.9..=1.0).contains(&strongest), "{strongest}");
        assert!(strengths(|_| 0.7).iter().flatten().all(|v| *v < 1e-14));
    }

    #[test]
    fn the_largest_change_is_one() {
        assert!((feature_difference([0.0, 2.0f64.sqrt()], [0.0, 0.0]) - 1.0).abs() < 1e-12);
        assert_eq!(feature_difference([0.3, 0.4], [0.3, 0.4]), 0.0);
    }
}
