//! Relief too fine for a pixel, as roughness.

use super::ndf::{MIN_ALPHA, alpha_from_divergence_ggx, divergence_ggx};
use crate::math::Vec3;

/// What hides within a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hidden {
    /// What the bend of the smooth surface adds to α².
    pub bend: f32,
    /// The variance of the normal map's vectors, E|n − mean|² = 1 − |mean|², [0, 1].
    pub relief: f32,
}

impl Hidden {
    /// What it adds to Beckmann's m², which is twice the variance of a slope: a Gaussian's variances add.
    pub fn variance(self) -> f32 {
        self.bend + self.relief
    }

    /// The roughness of a GGX lobe that shows `roughness` and what is hidden.
    ///
    /// The slopes of GGX have no variance to which one could add. But its facets have a mean normal, and where one
    /// distribution of directions is spread by another, the lengths of their mean vectors multiply. So the widened
    /// lobe is the one whose mean normal is that of the lobe times that of the map. As if GGX were a Gaussian, α² plus
    /// variance would be three to five times as much, and relief would glow.
    ///
    /// Source: Toksvig 2005, "Mipmapping Normal Maps", for the length as a measure; Mardia and Jupp 2000, "Directional
    /// Statistics", 9.2, for the product.
    pub fn widened(self, roughness: f32) -> f32 {
        if self.variance() <= 0.0 {
            return roughness;
        }
        let alpha = (roughness * roughness).max(MIN_ALPHA as f32);
        let mut squared = alpha * alpha;
        if self.relief > 0.0 {
            let [own, map] = [divergence_ggx(alpha), 1.0 - (1.0 - self.relief).max(0.0).sqrt()];
            let spread = alpha_from_divergence_ggx(own + map - own * map);
            squared = squared.max(spread * spread);
        }
        (squared + self.bend).min(1.0).sqrt().sqrt()
    }
}

/// What the bend of the smooth surface within a pixel adds to α²: the squared change of its unit normal from pixel
/// to pixel, as the variance of a normal distribution that wide, at most 0.18.
///
/// Source: Tokuyoshi and Kaplanyan 2019, "Improved Geometric Specular Antialiasing", eq. 9 and §4 (σ² = 1/4, κ = 0.18),
/// in its form without directions.
pub fn bend(dx: Vec3, dy: Vec3) -> f32 {
    const SIGMA_SQUARED: f32 = 0.25;
    const MOST: f32 = 0.18;
    (2.0 * SIGMA_SQUARED * (dx.dot(dx) + dy.dot(dy))).min(MOST)
}
