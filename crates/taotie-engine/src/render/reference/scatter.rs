//! Chooses where a surface scatters paths: like its base reflects, or like its clearcoat does; mapped normals may be
//! grooves of two facets.

use super::super::batch::{Batch, Lanes};
use super::super::columns::{Column, Column3, get3, set3};
use super::super::draw::Draw;
use super::super::settings::{GrazingNormals, RenderSettings};
use super::super::surface_point::{look_up_albedos, look_up_coat_albedo, shade_normals};
use super::{NormalMapping, ReferenceSettings};
use crate::math::{Lane, Pack, Vec3};
use crate::pixel::{Coat, SurfacePoint, takes_albedos};
use crate::shade::ndf::alpha_from_roughness;
use crate::shade::sampling::{Lobes, ggx_visible_normal, ggx_visible_pdf, mirrored, raised, stretched};
use crate::shade::{Facets, coat_fresnel};
use fearless_simd::Level;

/// The distribution of directions in which a surface point scatters paths.
pub(super) struct Scatter<'s, L> {
    base: ShadingFrame<L>,
    lobes: Lobes<L>,
    coat: Option<CoatLobe<L>>,
    groove: Option<&'s Groove<L>>,
}

/// The clearcoat's lobe.
struct CoatLobe<L> {
    frame: ShadingFrame<L>,
    alpha: L,
    /// The probability of choosing it, (0, 1).
    share: L,
}

/// The local space of a normal, and the viewer in it.
struct ShadingFrame<L> {
    t: Vec3<L>,
    b: Vec3<L>,
    n: Vec3<L>,
    /// The direction to the viewer, raised above the horizon.
    v: Vec3<L>,
}

impl<'s, P: Pack> Scatter<'s, P> {
    /// Creates the distribution; `v` is the true direction to the viewer; the surface may be seen in the mirror of
    /// its groove.
    #[inline(always)]
    pub(super) fn new(surface: &SurfacePoint<P>, v: Vec3<P>, groove: Option<&'s Groove<P>>) -> Self {
        let n = surface.frame.n.normalize_or(surface.frame.v);
        let t = match &surface.layers.anisotropic {
            Some(lobe) => lobe.tangent,
            None => n.any_perpendicular(),
        };
        let base = ShadingFrame::new(n, t, surface.frame.v);
        let mut lobes = Lobes::of(surface.shading, &surface.material.sample, base.v.z);
        if let Some(lobe) = &surface.layers.anisotropic {
            lobes.alpha = [lobe.along, lobe.across];
        }
        if surface.layers.sheen.is_some() {
            lobes.glossy = lobes.glossy * n.x.lit(0.5);
        }
        let coat = surface.layers.coat.as_ref().map(|coat| CoatLobe::new(coat, v, surface));
        Self { base, lobes, coat, groove }
    }

    /// Samples a direction, unit, in world space; it may be below the horizon. `u` in [0, 1)².
    #[inline(always)]
    pub(super) fn direction(&self, [u, around]: [P; 2]) -> Vec3<P> {
        let share = self.coat.as_ref().map_or(u.lit(0.0), |coat| coat.share);
        let rest = stretched(u - share, u.lit(1.0) - share);
        let base = self.base.to_world(self.lobes.direction(self.base.v, [rest, around]));
        let base = self.groove.map_or(base, |groove| groove.leaving(base));
        let Some(coat) = &self.coat else { return base };
        let m = ggx_visible_normal(coat.frame.v, [coat.alpha; 2], [stretched(u, share), around]);
        Vec3::select(u.lt(share), coat.frame.to_world(mirrored(coat.frame.v, m)), base)
    }

    /// The density of [`Self::direction`].
    #[inline(always)]
    pub(super) fn pdf(&self, l: Vec3<P>) -> P {
        let base = match self.groove {
            Some(groove) => groove.pdf(l, |l| self.base_pdf(l)),
            None => self.base_pdf(l),
        };
        let Some(coat) = &self.coat else { return base };
        let by_coat = ggx_visible_pdf(coat.frame.v, coat.frame.to_local(l), [coat.alpha; 2]);
        base + (by_coat - base) * coat.share
    }

    #[inline(always)]
    fn base_pdf(&self, l: Vec3<P>) -> P {
        self.lobes.pdf(self.base.v, self.base.to_local(l))
    }
}

impl<P: Pack> CoatLobe<P> {
    #[inline(always)]
    fn new(coat: &Coat<P>, v: Vec3<P>, surface: &SurfacePoint<P>) -> Self {
        let frame = ShadingFrame::new(coat.n, coat.n.any_perpendicular(), v);
        let reflected = coat.factor * coat_fresnel(frame.v.z.clamp(0.0, 1.0));
        let Vec3 { x, y, z } = surface.material.sample.base_color + surface.material.sample.f0;
        let below = (x + y + z) * x.lit(1.0 / 3.0);
        let share = (reflected / (reflected + below).max(x.lit(1e-6))).clamp(0.1, 0.9);
        Self { frame, alpha: alpha_from_roughness(coat.roughness), share }
    }
}

impl<L: Lane> ShadingFrame<L> {
    /// Creates the frame; `n`, `t` and `v` unit, in world space; `t` perpendicular to `n`.
    #[inline(always)]
    fn new(n: Vec3<L>, t: Vec3<L>, v: Vec3<L>) -> Self {
        let frame = Self { t, b: n.cross(t), n, v };
        let v = frame.to_local(raised(n, v));
        Self { v: Vec3::new(v.x, v.y, v.z.max(v.z.lit(1e-5))), ..frame }
    }

    #[inline(always)]
    fn to_local(&self, world: Vec3<L>) -> Vec3<L> {
        Vec3::new(self.t.dot(world), self.b.dot(world), self.n.dot(world))
    }

    #[inline(always)]
    fn to_world(&self, local: Vec3<L>) -> Vec3<L> {
        (self.t * local.x + self.b * local.y + self.n * local.z).normalize()
    }
}

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
    /// Like [`complete`](super::super::surface_point::complete), and chooses for each fragment whether its viewer
    /// sees the mapped facet directly or in the upright one.
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
            look_up_albedos(level, settings, draw, batch);
            // The clearcoat is over the groove: the true viewer sees it.
            for i in batch.entries() {
                look_up_coat_albedo(draw.material, batch, i, get3(&self.v, i));
            }
        }
    }
}

/// A groove at points of a surface.
pub(super) struct Groove<P> {
    facets: Facets<P>,
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
    fn leaving(&self, l: Vec3<P>) -> Vec3<P> {
        let zero = l.x.lit(0.0);
        let chance = P::select(l.dot(self.facets.t).lt(zero), self.facets.escape(l), l.x.lit(1.0));
        Vec3::select(self.u.lt(chance), l, self.facets.mirrored(l))
    }

    /// The density of [`Self::leaving`] for facets that scatter paths with the density `pdf`.
    #[inline(always)]
    fn pdf(&self, l: Vec3<P>, pdf: impl Fn(Vec3<P>) -> P) -> P {
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
