//! Relief that a mesh does not have: a mapped normal as two facets, the microfacet interpretation of normal maps, and
//! relief within a pixel as roughness.

use super::microfacets::{MIN_ALPHA, alpha_squared_from_divergence_ggx, divergence_ggx};
use crate::math::{Lane, Vec3};

/// The minimum cosine between the two normals: a steeper map is turned back, so that the upright facet stays finite.
const LEAST_COSINE: f64 = 0.02;

/// A groove of two facets. Directions are unit and leave the surface.
///
/// A normal map rotates the normal of a surface without moving the surface, which is geometrically impossible: light
/// is lost and created at grazing angles. Here each point is a groove of two facets instead: one with the mapped
/// normal p, and an upright mirror t that compensates, so that the mean of their normals is the surface normal g. The
/// facets hide and mirror as grooves do, so no light is created; light that would meet the mapped facet twice is
/// lost.
///
/// The formulas are those of Schüssler, Heitz, Hanika and Dachsbacher 2017, "Microfacet-based normal mapping for
/// robust Monte Carlo path tracing": §4 for the facets, §5 for their masking, and the form with a specular tangent
/// facet of §6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facets<L> {
    /// The surface normal.
    pub g: Vec3<L>,
    /// The mapped normal, above the surface.
    pub p: Vec3<L>,
    /// The upright facet's normal, perpendicular to `g`, away from `p`.
    pub t: Vec3<L>,
    cos: L,
    sin: L,
}

impl<L: Lane> Facets<L> {
    /// Creates the groove for the unit normals of the surface and of its map.
    ///
    /// Law: the facets' areas 1/cos θ and tan θ, times their normals, add up to `g`
    /// (`laws::facets::the_mean_normal_is_the_surface_s`).
    #[inline(always)]
    pub fn new(g: Vec3<L>, mapped: Vec3<L>) -> Self {
        let one = g.x.lit(1.0);
        let across = mapped - g * g.dot(mapped);
        let side = across.normalize_or(g.any_perpendicular());
        let cos = g.dot(mapped).clamp(LEAST_COSINE, 1.0);
        let sin = (one - cos * cos).max(one.lit(0.0)).sqrt();
        Self { g, p: g * cos + side * sin, t: -side, cos, sin }
    }

    /// The fraction of the upright facet in the area visible from `w`, [0, 1].
    ///
    /// λ_t = tan θ (w·t)⁺ / ((w·p)⁺/cos θ + tan θ (w·t)⁺), and 0 if neither is visible.
    #[inline(always)]
    pub fn share_of_mirror(&self, w: Vec3<L>) -> L {
        let upright = self.sin * positive(w.dot(self.t));
        upright / self.seen(w)
    }

    /// The fraction of the light leaving a facet towards `w` that leaves the groove, [0, 1]: for both facets that
    /// face it; 0 below the surface.
    ///
    /// G₁ = min(1, (w·g)⁺ / ((w·p)⁺/cos θ + tan θ (w·t)⁺))
    ///
    /// Law: λ and G₁ make the visible area equal to that of the flat surface
    /// (`laws::facets::the_seen_area_is_that_of_the_surface`).
    #[inline(always)]
    pub fn escape(&self, w: Vec3<L>) -> L {
        (self.cos * positive(w.dot(self.g)) / self.seen(w)).min(w.x.lit(1.0))
    }

    /// `w` as mirrored by the upright facet.
    #[inline(always)]
    pub fn mirrored(&self, w: Vec3<L>) -> Vec3<L> {
        w - self.t * (w.dot(self.t) * w.x.lit(2.0))
    }

    /// The two paths of light from `l` to the mapped facet: the direction from which it arrives there, and its
    /// fraction, [0, 1].
    ///
    /// Direct: l and G₁(l). Via the mirror, for l·t > 0: l' = [`Self::mirrored`] l and (1 − G₁(l')) G₁(l). The total
    /// is the facet's reflection of both, to the mirrored viewer with weight [`Self::share_of_mirror`] and to the
    /// true viewer with the rest. Light that meets the mirror both ways is included, which the paper omits.
    ///
    /// Law: reciprocity; a white matt facet reflects cos θ of the light, for any viewer (`laws::facets`).
    #[inline(always)]
    pub fn ways(&self, l: Vec3<L>) -> [(Vec3<L>, L); 2] {
        let zero = l.x.lit(0.0);
        let (escape, around) = (self.escape(l), self.mirrored(l));
        let blocked = (l.x.lit(1.0) - self.escape(around)) * escape;
        [(l, escape), (around, L::select(zero.lt(l.dot(self.t)), blocked, zero))]
    }

    /// cos θ times the area that would be visible from `w` if no facet hid another.
    #[inline(always)]
    fn seen(&self, w: Vec3<L>) -> L {
        let area = positive(w.dot(self.p)) + self.sin * positive(w.dot(self.t));
        area.max(area.lit(1e-9))
    }
}

#[inline(always)]
fn positive<L: Lane>(x: L) -> L {
    x.max(x.lit(0.0))
}

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
