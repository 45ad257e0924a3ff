//! Two facets for a mapped normal: the microfacet interpretation of normal maps.
//!
//! A normal map rotates the normal of a surface without moving the surface, which is geometrically impossible: light
//! is lost and created at grazing angles. Here each point is a groove of two facets instead: one with the mapped
//! normal p, and an upright mirror t that compensates, so that the mean of their normals is the surface normal g. The
//! facets hide and mirror as grooves do, so no light is created; light that would meet the mapped facet twice is
//! lost.
//!
//! The formulas are those of Schüssler, Heitz, Hanika and Dachsbacher 2017, "Microfacet-based normal mapping for
//! robust Monte Carlo path tracing": §4 for the facets, §5 for their masking, and the form with a specular tangent
//! facet of §6.

use crate::math::{Lane, Vec3};

/// The minimum cosine between the two normals: a steeper map is turned back, so that the upright facet stays finite.
const LEAST_COSINE: f64 = 0.02;

/// A groove of two facets. Directions are unit and leave the surface.
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
