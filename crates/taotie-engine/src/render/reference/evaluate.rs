//! Evaluates BSDFs: emission, and reflection of every light, of the environment and of the direction in which a path
//! continues, for eight fragments at a time.

use super::super::batch::{Batch, Lanes};
use super::super::columns::{Column, Column3, ZERO, ZERO3, store3};
use super::scatter::{Groove, Grooves, Scatter};
use crate::math::{Pack, Vec3, dispatch_eight};
use crate::pixel::{Incidence, LightSource, Model, SurfacePoint};
use crate::scene::Material;
use crate::shade::Shading;
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
