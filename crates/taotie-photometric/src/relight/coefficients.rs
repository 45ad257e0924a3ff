//! Coefficients of a basis, fitted to photographs.

use super::basis::Basis;
use super::colors::{BATCH, ColorReader};
use super::fit::Projection;
use super::image::{ColorModel, PIECE, Relightable};
use super::plane::Plane;
use taotie_engine::error::Result;
use taotie_engine::{Progress, parallel};
use taotie_io::Bytes;

/// Bytes of a pixel and photograph while coefficients are fitted: three floats.
const COLOR: u64 = 12;

/// Coefficients as numbers: those of red, green and blue of each term.
#[derive(Debug, Clone)]
pub struct Coefficients {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The functions of the light.
    pub basis: Basis,
    /// The map from samples to coefficients.
    pub projection: Projection,
    /// Red, green and blue of each term.
    pub planes: Vec<Vec<f32>>,
}

impl Coefficients {
    /// Fits a basis to photographs.
    ///
    /// # Errors
    /// Those of reading them; [`taotie_engine::Error::Limit`], [`taotie_engine::Error::Cancelled`].
    pub fn fit(photographs: &ColorReader, basis: Basis, progress: Progress<'_>) -> Result<Self> {
        let (width, height) = photographs.size();
        let pixels = u64::from(width) * u64::from(height);
        let what = format!("coefficients of {width}x{height} pixels");
        let bytes = pixels * (basis.terms() as u64 * COLOR * 2 + BATCH as u64 * (COLOR + 16));
        photographs.limits().check(what, Bytes(bytes))?;
        let projection = Projection::new(basis, photographs.lights());
        let mut planes = vec![vec![0.0_f32; pixels as usize]; 3 * basis.terms()];
        photographs.each(progress, &mut |k, colors| {
            let factors = &projection.factors[k];
            for (plane, sums) in planes.iter_mut().enumerate() {
                let (factor, channel) = (factors[plane / 3] as f32, plane % 3);
                parallel::pieces(sums, PIECE, &|piece, sums| {
                    let colors = &colors[piece * PIECE..];
                    sums.iter_mut().zip(colors).for_each(|(sum, color)| *sum += factor * color[channel]);
                });
            }
        })?;
        Ok(Self { width, height, basis, projection, planes })
    }

    /// Stores the coefficients in 8 bits.
    pub fn stored(&self, colors: ColorModel) -> Relightable {
        let planes = match colors {
            ColorModel::Rgb => {
                let terms = self.planes.chunks(3);
                terms.flat_map(|channels| Plane::quantised(&channels.iter().collect::<Vec<_>>())).collect()
            }
            ColorModel::Lrgb => self.factored(),
        };
        Relightable { width: self.width, height: self.height, basis: self.basis, colors, planes }
    }

    /// Returns each pixel's coefficients as a colour times a brightness: the product that is closest over the lights.
    fn factored(&self) -> Vec<Plane> {
        let (count, terms) = (self.planes[0].len(), self.basis.terms());
        let values = parallel::collect(count, |i| {
            let channels: [Vec<f64>; 3] = std::array::from_fn(|channel| {
                (0..terms).map(|term| f64::from(self.planes[3 * term + channel][i])).collect()
            });
            self.factored_pixel(&channels)
        });
        let plane = |k: usize| values.iter().map(|value| value[k]).collect::<Vec<f32>>();
        let color = (0..3).map(|channel| Plane::of_colors(&plane(channel)));
        color.chain((0..terms).flat_map(|term| Plane::quantised(&[&plane(3 + term)]))).collect()
    }

    /// Returns the colour and then the coefficients of the brightness, at most 16 of them, of one pixel. The colour is
    /// that under the brightest light, so that brightness is at most about 1.
    fn factored_pixel(&self, channels: &[Vec<f64>; 3]) -> [f32; 19] {
        /// Steps of alternating least squares; coefficients of a matt surface agree after one.
        const STEPS: usize = 3;
        let terms = channels[0].len();
        let mut color = [1.0_f64; 3];
        let mut grey = vec![0.0; terms];
        for _ in 0..STEPS {
            let square: f64 = color.iter().map(|v| v * v).sum::<f64>().max(1e-12);
            for (term, grey) in grey.iter_mut().enumerate() {
                *grey = (0..3).map(|c| channels[c][term] * color[c]).sum::<f64>() / square;
            }
            let square = self.projection.mean_product(&grey, &grey).max(1e-12);
            color = std::array::from_fn(|c| {
                (self.projection.mean_product(&channels[c], &grey) / square).max(0.0)
            });
        }
        let most = color.iter().fold(0.0_f64, |most, v| most.max(*v));
        let peak = self.projection.peak(&grey);
        let scale = (most * peak).clamp(0.0, 1.0) / most.max(1e-12);
        let mut values = [0.0; 19];
        for (value, color) in values.iter_mut().zip(color) {
            *value = (color * scale) as f32;
        }
        for (value, grey) in values[3..].iter_mut().zip(grey) {
            *value = if scale > 0.0 { (grey / scale) as f32 } else { 0.0 };
        }
        values
    }
}
