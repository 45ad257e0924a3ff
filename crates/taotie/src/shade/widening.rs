//! Subpixel relief as roughness.

use super::ndf::{MIN_ALPHA, alpha_squared_from_divergence_ggx, divergence_ggx};
use crate::math::{Lane, Vec3};

/// The variance of normals within a pixel or texel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubPixelVariance<L = f32> {
    /// The curvature of the smooth surface, added to α².
    pub curvature: L,
    /// The variance of the normal map's vectors, E|n − mean|² = 1 − |mean|², [0, 1].
    pub normal_variance: L,
}

impl<L: Lane> SubPixelVariance<L> {
    /// The sum, which is added to Beckmann's m², which is twice the variance of a slope: a Gaussian's variances add.
    #[inline(always)]
    pub fn variance(self) -> L {
        self.curvature + self.normal_variance
    }

    /// The roughness of a GGX lobe with this `roughness`, widened by this variance.
    ///
    /// The slopes of GGX have no finite variance to add to. But its facets have a mean normal, and when one
    /// distribution of directions is spread by another, the lengths of their mean vectors multiply. So the mean
    /// normal of the widened lobe is that of the lobe times that of the map. As if GGX were a Gaussian, α² plus
    /// variance would be three to five times as much, and relief would glow.
    ///
    /// Source: Toksvig 2005, "Mipmapping Normal Maps", for the length as a measure; Mardia and Jupp 2000, "Directional
    /// Statistics", 9.2, for the product.
    #[inline(always)]
    pub fn widened(self, roughness: L) -> L {
        let (zero, one) = (roughness.lit(0.0), roughness.lit(1.0));
        let alpha = (roughness * roughness).max(roughness.lit(MIN_ALPHA));
        let own = alpha * alpha;
        let map = one - (one - self.normal_variance).max(zero).sqrt();
        let divergence = divergence_ggx(alpha);
        let squared = alpha_squared_from_divergence_ggx(divergence + map - divergence * map);
        let squared = L::select(zero.lt(self.normal_variance), own.max(squared), own);
        let widened = (squared + self.curvature).min(one).sqrt().sqrt();
        L::select(zero.lt(self.variance()), widened, roughness)
    }
}

/// The addition to α² by the curvature of the smooth surface within a pixel: the squared change of its unit normal
/// between pixels, as the variance of a normal distribution that wide, at most 0.18.
///
/// Source: Tokuyoshi and Kaplanyan 2019, "Improved Geometric Specular Antialiasing", eq. 9 and §4 (σ² = 1/4, κ = 0.18),
/// in its form without directions.
#[inline(always)]
pub fn curvature_variance<L: Lane>(dx: Vec3<L>, dy: Vec3<L>) -> L {
    const SIGMA_SQUARED: f64 = 0.25;
    const MOST: f64 = 0.18;
    let squared = dx.dot(dx) + dy.dot(dy);
    (squared * squared.lit(2.0 * SIGMA_SQUARED)).min(squared.lit(MOST))
}
