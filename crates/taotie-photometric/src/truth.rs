//! Known normals: how many errors are within the uncertainty that was stated for them.

use crate::estimate::Estimate;
use taotie_engine::compare::angle_deg;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Image;
use taotie_engine::math::Vec3;

/// Fractions of errors within their uncertainty, in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// Along the axis of the larger standard deviation: within one (0.68 is expected) and two (0.95).
    pub major: [f64; 2],
    /// Along the axis of the smaller one.
    pub minor: [f64; 2],
    /// Within the radius that is shown (0.68).
    pub radius: f64,
}

impl Estimate {
    /// Compares the best normals with true ones, of unit length with a fourth channel above 0; `None` if they share
    /// no pixel.
    pub fn coverage(&self, truth: &Image) -> Option<Coverage> {
        let (mut axes, mut radius, mut count) = ([[0.0; 2]; 2], 0.0, 0.0);
        for (pixel, best) in self.pixels.iter().zip(&self.best) {
            let [x, y, z, has] = truth.pixels()[*pixel as usize];
            let (Some(best), true) = (best, has > 0.0) else { continue };
            let truth = Vec3::new(x, y, z).to_f64();
            let error = best.tangents().map(|t| t.dot(truth));
            let [ax, ay] = best.covariance.main_axis();
            let along = [ax * error[0] + ay * error[1], ax * error[1] - ay * error[0]];
            for ((within, error), variance) in axes.iter_mut().zip(along).zip(best.covariance.eigenvalues()) {
                for (k, within) in within.iter_mut().enumerate() {
                    let is_within = error.abs() < (k + 1) as f64 * variance.sqrt();
                    *within += f64::from(u8::from(is_within));
                }
            }
            radius += f64::from(u8::from(angle_deg(best.normal, truth) <= best.sigma_deg));
            count += 1.0;
        }
        let [major, minor] = axes.map(|within| within.map(|sum| sum / count));
        (count > 0.0).then_some(Coverage { major, minor, radius: radius / count })
    }
}

/// Returns true normals at the size of the photographs: those of a picture that is a whole number of times larger are
/// averaged over each pixel, and pixels that it covers only in part have none.
///
/// # Errors
/// [`Error::Invalid`] if the size is not a multiple.
pub fn averaged(truth: &Image, [width, height]: [u32; 2]) -> Result<Image> {
    let times = truth.width() / width.max(1);
    if times == 0 || [truth.width(), truth.height()] != [width * times, height * times] {
        return Err(Error::invalid(
            format!("true normals of {}x{}", truth.width(), truth.height()),
            format!("the photographs have {width}x{height}; both must be alike, or the normals a multiple"),
        ));
    }
    let mut averaged = Image::new(width, height, [0.0; 4])?;
    for (i, pixel) in averaged.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % width * times, i as u32 / width * times);
        let all = (0..times * times).map(|k| truth.pixel(x + k % times, y + k / times));
        let mut sum = Vec3::splat(0.0);
        let mut covered = true;
        for n in all {
            sum += Vec3::new(n[0], n[1], n[2]).to_f64();
            covered &= n[3] > 0.0;
        }
        let n = sum.normalize_or(Vec3::splat(0.0)).to_f32();
        if covered && n.length() > 0.0 {
            *pixel = [n.x, n.y, n.z, 1.0];
        }
    }
    Ok(averaged)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_normals_are_averaged_where_they_cover_a_pixel() {
        let mut fine = Image::new(4, 2, [0.0, 0.0, 1.0, 1.0]).unwrap();
        fine.pixels_mut()[0] = [1.0, 0.0, 0.0, 1.0];
        fine.pixels_mut()[3] = [0.0; 4];
        let coarse = averaged(&fine, [2, 1]).unwrap();
        let [x, _, z, has] = coarse.pixels()[0];
        assert!((x / z - 1.0 / 3.0).abs() < 1e-6 && has == 1.0);
        assert_eq!(coarse.pixels()[1], [0.0; 4]);
        assert!(averaged(&fine, [3, 1]).unwrap_err().to_string().contains("4x2"));
        assert!(averaged(&fine, [8, 4]).is_err());
    }
}
