//! BSDFs, for eight fragments at a time: evaluation, which is emission and the reflection of every light, of the
//! environment and of the direction in which a path continues; and sampling, which chooses where a surface scatters
//! paths: like its base reflects, or like its clearcoat does; mapped normals may be grooves of two facets.

use super::super::batch::{Batch, Column, Column3, Lanes, ZERO, ZERO3, get3, set3, store3};
use super::super::draw::Draw;
use super::super::settings::{GrazingNormals, RenderSettings};
use super::super::surface_point::{look_up_albedos, look_up_coat_albedo, shade_normals};
use super::{NormalMapping, ReferenceSettings};
use crate::math::{Lane, Pack, Vec3, dispatch_eight};
use crate::pixel::{Coat, Incidence, LightSource, Model, SurfacePoint, takes_albedos};
use crate::scene::Material;
use crate::shade::microfacets::alpha_from_roughness;
use crate::shade::sampling::{Lobes, ggx_visible_normal, ggx_visible_pdf, mirrored, raised, stretched};
use crate::shade::{Facets, Shading, coat_fresnel};
use fearless_simd::Level;

/// A BSDF query: the inputs of evaluation in addition to the fragments.
pub(super) struct BsdfQuery<'t> {
    /// The number of surfaces that the paths have met before.
    pub depth: u32,
    pub shading: Shading,
    pub material: &'t Material,
    pub sources: &'t [LightSource<f32>],
    pub ambient: Vec3,
    /// `true` if light behind the shading normal is shadowed.
    pub shadows: bool,
    /// `true` if there are directions to the environment.
    pub sky: bool,
    /// `true` if paths continue.
    pub onward: bool,
    /// `true` if mapped normals are grooves.
    pub grooved: bool,
}

/// A batch of BSDF evaluations: directions of fragments and the results for them.
pub(super) struct BsdfBatch {
    /// Numbers in [0, 1) that choose where the path continues.
    pub u: [Column; 2],
    pub grooves: Grooves,
    /// The sampled direction of the environment's light; unit, in world space.
    pub to_sky: Column3,
    /// The direction in which the path continues; unit, in world space.
    pub onward: Column3,
    /// The densities of [`Scatter`] in both directions.
    pub sky_pdf: Column,
    pub onward_pdf: Column,
    /// The light without any of these: emission and reflected ambient light.
    pub own: Column3,
    /// Reflected light of each source, unshadowed.
    pub lit: Vec<Column3>,
    /// Radiance per unit of irradiance from both directions, 0 behind the shading normal.
    pub from_sky: Column3,
    pub from_onward: Column3,
}

impl BsdfBatch {
    pub(super) fn new(sources: usize) -> Box<Self> {
        Box::new(Self {
            u: [ZERO; 2],
            grooves: Grooves { u: ZERO, v: ZERO3 },
            to_sky: ZERO3,
            onward: ZERO3,
            sky_pdf: ZERO,
            onward_pdf: ZERO,
            own: ZERO3,
            lit: vec![ZERO3; sources],
            from_sky: ZERO3,
            from_onward: ZERO3,
        })
    }
}

/// Fills the results for the fragments of `batch`, whose normals are known.
pub(super) fn evaluate(level: Level, query: &BsdfQuery<'_>, batch: &Batch, bsdf: &mut BsdfBatch) {
    dispatch_eight!(level, P, token => all_packs::<P>(token, query, batch, bsdf));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, query: &BsdfQuery<'_>, batch: &Batch, bsdf: &mut BsdfBatch) {
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let seen: Seen<P> = Seen::new(at, query, bsdf);
        store3(seen.surface.own(at.splat3(query.ambient)), &mut bsdf.own, i);
        let scatter = Scatter::new(&seen.surface, seen.from, seen.groove.as_ref());
        let [u, v] = &bsdf.u;
        let onward = scatter.direction([at.load(u), at.load(v)]);
        store3(onward, &mut bsdf.onward, i);
        let position = at.load3(&batch.geometry.position);
        // One loop over all directions, so that reflection is compiled once.
        for request in query.requests() {
            let unit = |l| Incidence { l, irradiance: at.splat3(ONE) };
            let Incidence { l, irradiance } = match request {
                Request::Light(number) => {
                    query.sources[number].map(|value| at.splat(value)).incidence(position)
                }
                Request::Sky => unit(at.load3(&bsdf.to_sky)),
                Request::Onward => unit(onward),
            };
            let shadowed = query.shadows || !matches!(request, Request::Light(_));
            let reflected = seen.reflected(l, shadowed).mul_elements(irradiance);
            let pdf = match request {
                Request::Light(_) => reflected.x,
                Request::Sky | Request::Onward => scatter.pdf(l),
            };
            bsdf.answer(request, i, reflected, pdf);
        }
    }
}

/// A direction for which reflection is requested.
#[derive(Clone, Copy)]
enum Request {
    /// The direction towards a light, by its index.
    Light(usize),
    /// The direction towards the environment.
    Sky,
    /// The direction in which the path continues.
    Onward,
}

impl BsdfQuery<'_> {
    #[inline(always)]
    fn requests(&self) -> impl Iterator<Item = Request> {
        let sources = self.sources.len();
        let all = (0..sources + 2).map(move |number| match number {
            number if number < sources => Request::Light(number),
            number if number == sources => Request::Sky,
            _ => Request::Onward,
        });
        let (sky, onward) = (self.sky, self.onward);
        all.filter(move |request| match request {
            Request::Light(_) => true,
            Request::Sky => sky,
            Request::Onward => onward,
        })
    }
}

impl BsdfBatch {
    /// Stores the results of entries from `i` onwards; the density only if it is needed.
    #[inline(always)]
    fn answer<P: Pack>(&mut self, request: Request, i: usize, reflected: Vec3<P>, pdf: P) {
        match request {
            Request::Light(number) => store3(reflected, &mut self.lit[number], i),
            Request::Sky => {
                store3(reflected, &mut self.from_sky, i);
                pdf.store(&mut self.sky_pdf[i..]);
            }
            Request::Onward => {
                store3(reflected, &mut self.from_onward, i);
                pdf.store(&mut self.onward_pdf[i..]);
            }
        }
    }
}

const ONE: Vec3 = Vec3::new(1.0, 1.0, 1.0);

/// Points of a surface from a viewpoint.
struct Seen<P> {
    surface: SurfacePoint<P>,
    /// The true direction to the viewer.
    from: Vec3<P>,
    groove: Option<Groove<P>>,
}

impl<P: Pack> Seen<P> {
    #[inline(always)]
    fn new(at: Lanes<'_, P>, query: &BsdfQuery<'_>, bsdf: &BsdfBatch) -> Self {
        let model = Model::new(query.shading, query.material);
        let surface = at.surface_point(model, query.material);
        if !query.grooved {
            return Self { from: surface.frame.v, surface, groove: None };
        }
        let groove = Groove::new(at, &bsdf.grooves, &surface);
        Self { surface, from: at.load3(&bsdf.grooves.v), groove: Some(groove) }
    }

    /// Radiance per unit of irradiance; 0 if the light is `shadowed` and behind the shading normal.
    #[inline(always)]
    fn reflected(&self, l: Vec3<P>, shadowed: bool) -> Vec3<P> {
        let Some(groove) = &self.groove else { return self.reflected_flat(l, shadowed) };
        let reflected = groove.reflect(&self.surface, l);
        match &self.surface.layers.coat {
            Some(coat) => coat.over(reflected, self.from, l),
            None => reflected,
        }
    }

    #[inline(always)]
    fn reflected_flat(&self, l: Vec3<P>, shadowed: bool) -> Vec3<P> {
        let reflected = self.surface.reflect(l);
        if !shadowed {
            return reflected;
        }
        let zero = l.x.lit(0.0);
        Vec3::select(zero.lt(self.surface.frame.n.dot(l)), reflected, Vec3::splat(zero))
    }
}

/// The distribution of directions in which a surface point scatters paths.
struct Scatter<'s, L> {
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
    fn new(surface: &SurfacePoint<P>, v: Vec3<P>, groove: Option<&'s Groove<P>>) -> Self {
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
    fn direction(&self, [u, around]: [P; 2]) -> Vec3<P> {
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
    fn pdf(&self, l: Vec3<P>) -> P {
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
struct Groove<P> {
    facets: Facets<P>,
    /// A number in [0, 1), for [`Self::leaving`].
    u: P,
}

impl<P: Pack> Groove<P> {
    #[inline(always)]
    fn new(at: Lanes<'_, P>, grooves: &Grooves, surface: &SurfacePoint<P>) -> Self {
        let facets = Facets::new(at.load3(&at.batch.frame.smooth), surface.frame.n);
        Self { facets, u: at.load(&grooves.u) }
    }

    /// Radiance to the viewer per unit of irradiance from `l`, without clearcoat.
    #[inline(always)]
    fn reflect(&self, surface: &SurfacePoint<P>, l: Vec3<P>) -> Vec3<P> {
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
