//! Mapped normals as grooves of two facets.

use super::super::albedos;
use super::super::batch::{Batch, Lanes};
use super::super::columns::{Column, Column3, get3, set3};
use super::super::draw::Draw;
use super::super::normals::shade_normals;
use super::super::settings::{GrazingNormals, RenderSettings};
use super::settings::{NormalMapping, ReferenceSettings};
use crate::math::{Pack, Vec3};
use crate::pixel::{SurfacePoint, takes_albedos};
use crate::shade::Facets;
use crate::shade::sampling::stretched;
use fearless_simd::Level;

/// Returns true if the draw's normals are interpreted as grooves.
pub(super) fn is_grooved(reference: &ReferenceSettings, draw: &Draw<'_>) -> bool {
    reference.normal_mapping == NormalMapping::Microfacet && draw.normal_source.method().is_mapped()
}

/// The facet visible to each fragment's viewer, in columns.
pub(super) struct Grooves {
    /// Numbers in [0, 1) that choose the facet; afterwards the remainder, as evenly distributed as before.
    pub u: Column,
    /// The true direction to the viewer; the batch contains the direction from which the mapped facet is seen.
    pub v: Column3,
}

impl Grooves {
    /// Like [`complete`](super::super::point::complete), and chooses for each fragment whether its viewer sees the
    /// mapped facet directly or in the upright one.
    pub(super) fn complete(
        &mut self,
        level: Level,
        settings: &RenderSettings,
        draw: &Draw<'_>,
        batch: &mut Batch,
    ) {
        shade_normals(level, draw, GrazingNormals::Keep, batch);
        for i in batch.entries() {
            let facets = Facets::new(get3(&batch.frame.smooth, i), get3(&batch.frame.n, i));
            let v = get3(&batch.geometry.v, i);
            set3(&mut self.v, i, v);
            set3(&mut batch.frame.n, i, facets.p);
            let share = facets.share_of_mirror(v);
            let u = self.u[i];
            self.u[i] = if u < share {
                set3(&mut batch.geometry.v, i, facets.mirrored(v));
                stretched(u, share)
            } else {
                stretched(u - share, 1.0 - share)
            };
        }
        if takes_albedos(settings.shading) {
            albedos::look_up(level, settings, draw, batch);
            // The clearcoat is over the groove: the true viewer sees it.
            for i in batch.entries() {
                albedos::look_up_coat(draw.material, batch, i, get3(&self.v, i));
            }
        }
    }
}

/// A groove at points of a surface.
pub(super) struct Groove<P> {
    pub facets: Facets<P>,
    /// A number in [0, 1), for [`Self::leaving`].
    u: P,
}

impl<P: Pack> Groove<P> {
    #[inline(always)]
    pub(super) fn new(at: Lanes<'_, P>, grooves: &Grooves, surface: &SurfacePoint<P>) -> Self {
        let facets = Facets::new(at.load3(&at.batch.frame.smooth), surface.frame.n);
        Self { facets, u: at.load(&grooves.u) }
    }

    /// Radiance to the viewer per unit of irradiance from `l`, without clearcoat.
    #[inline(always)]
    pub(super) fn reflect(&self, surface: &SurfacePoint<P>, l: Vec3<P>) -> Vec3<P> {
        let zero = l.x.lit(0.0);
        let mut sum = Vec3::splat(zero);
        for (way, share) in self.facets.ways(l) {
            let lit = zero.lt(self.facets.p.dot(way));
            sum += Vec3::select(lit, surface.reflect_base(way) * share, Vec3::splat(zero));
        }
        sum
    }

    /// The direction of a path that leaves the mapped facet towards `l`: `l`, or `l` mirrored by the upright facet.
    #[inline(always)]
    pub(super) fn leaving(&self, l: Vec3<P>) -> Vec3<P> {
        let zero = l.x.lit(0.0);
        let chance = P::select(l.dot(self.facets.t).lt(zero), self.facets.escape(l), l.x.lit(1.0));
        Vec3::select(self.u.lt(chance), l, self.facets.mirrored(l))
    }

    /// The density of [`Self::leaving`] for facets that scatter paths with the density `pdf`.
    #[inline(always)]
    pub(super) fn pdf(&self, l: Vec3<P>, pdf: impl Fn(Vec3<P>) -> P) -> P {
        let (zero, one) = (l.x.lit(0.0), l.x.lit(1.0));
        let (upright, around) = (l.dot(self.facets.t), self.facets.mirrored(l));
        let kept = P::select(upright.lt(zero), self.facets.escape(l), one);
        let turned = P::select(zero.lt(upright), one - self.facets.escape(around), zero);
        let mut sum = zero;
        for (direction, share) in [(l, kept), (around, turned)] {
            sum = sum + pdf(direction) * share;
        }
        sum
    }
}
