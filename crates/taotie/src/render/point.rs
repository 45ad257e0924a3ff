//! A point of a surface with everything that its reflection depends on.

use super::albedos;
use super::batch::{Batch, load, load3, splat3};
use super::layers::{Coat, Fibres, Terminator};
use super::normals::shade_normals;
use super::prepare::Draw;
use super::settings::{GrazingNormals, RenderSettings};
use super::substance::{substance, takes_albedos, takes_layers};
use crate::math::{Pack, Vec3};
use crate::scene::Material;
use crate::shade::dfg::Dfg;
use crate::shade::{self, Angles, Shading, Stretch, Substance};
use fearless_simd::Level;

/// Fills what points of a surface need beside interpolated and looked up values: the shading normals and the directional
/// albedos of the lobes.
pub(super) fn complete(level: Level, settings: &RenderSettings, draw: &Draw<'_>, batch: &mut Batch) {
    let shading = settings.shading;
    let grazing = if shading.is_printed() { GrazingNormals::Keep } else { settings.grazing_normals };
    shade_normals(level, draw, grazing, batch);
    if takes_albedos(shading) {
        albedos::look_up(level, (shading, settings.energy), draw, batch);
    }
}

/// What is known of a model before any fragment: where it is a constant, what other models need is not even compiled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model {
    pub shading: Shading,
    /// Whether there may be lacquer, fibres or stretched highlights.
    pub layered: bool,
}

impl Model {
    pub(super) fn new(shading: Shading, material: &Material) -> Self {
        let layers =
            material.clearcoat.is_some() || material.sheen.is_some() || material.anisotropy.is_some();
        Self { shading, layered: takes_layers(shading) && layers }
    }
}

/// Points of a surface: a pack of fragments, or one.
pub(super) struct SurfacePoint<L> {
    pub shading: Shading,
    pub substance: Substance<L>,
    /// k_a, linear RGB.
    pub ambient: Vec3<L>,
    /// Emitted radiance that reaches the viewer, linear RGB.
    pub emitted: Vec3<L>,
    /// The shading normal, unit, world space.
    pub n: Vec3<L>,
    /// Unit, to the viewer, world space.
    pub v: Vec3<L>,
    terminator: Terminator<L>,
    pub stretch: Option<Stretch<L>>,
    pub coat: Option<Coat<L>>,
    pub fibres: Option<Fibres<L>>,
}

impl<P: Pack> SurfacePoint<P> {
    /// The fragments of `batch` from `i` on.
    #[inline(always)]
    pub(super) fn new(
        token: P::Token,
        Model { shading, layered }: Model,
        material: &Material,
        batch: &Batch,
        i: usize,
    ) -> Self {
        let (substance, ambient) = substance(token, shading, material, batch, i);
        let (n, v) = (load3(token, &batch.n, i), load3(token, &batch.v, i));
        let stretched = layered && material.anisotropy.is_some();
        let stretch = stretched.then(|| {
            let tangent = load3(token, &batch.layers.stretch_tangent, i);
            let strength = load(token, &batch.layers.stretch, i);
            Stretch::new(tangent, n.cross(tangent), substance.roughness, strength)
        });
        let coat = (layered && material.clearcoat.is_some()).then(|| Coat::new(token, batch, i));
        let fibres = (layered && material.sheen.is_some()).then(|| Fibres::new(token, batch, i));
        let emitted: Vec3<P> = load3(token, &batch.emissive, i);
        let emitted = coat.as_ref().map_or(emitted, |coat| emitted * coat.kept);
        let terminator = Terminator::new(token, batch, i);
        Self { shading, substance, ambient, emitted, n, v, terminator, stretch, coat, fibres }
    }

    /// Radiance to the viewer per unit of irradiance on a plane that faces the light in direction `l` (unit, world
    /// space), linear RGB: f · n·l.
    #[inline(always)]
    pub(super) fn reflect(&self, l: Vec3<P>) -> Vec3<P> {
        let reflected = self.reflect_bare(l);
        match &self.coat {
            Some(coat) => coat.over(reflected, self.v, l),
            None => reflected,
        }
    }

    /// As [`Self::reflect`], without the lacquer.
    #[inline(always)]
    pub(super) fn reflect_bare(&self, l: Vec3<P>) -> Vec3<P> {
        let angles = Angles::new(self.n, self.v, l);
        let mut reflected = match &self.stretch {
            Some(stretch) => shade::reflect_stretched(&self.substance, stretch, &angles, [self.v, l]),
            None => shade::reflect(self.shading, &self.substance, &angles),
        };
        if let Some(fibres) = &self.fibres {
            reflected = fibres.over(reflected, &angles);
        }
        reflected * self.terminator.share(l)
    }

    /// Radiance to the viewer of what the environment sends, linear RGB; `batch.surround` and its tables must be
    /// filled.
    #[inline(always)]
    pub(super) fn surrounded(&self, token: P::Token, batch: &Batch, i: usize) -> Vec3<P> {
        let weights = shade::surround(self.shading, &self.substance, &dfg(token, batch, i));
        let occlusion: P = load(token, &batch.occlusion, i);
        let mean = load3(token, &batch.surround.mean, i) * occlusion;
        let n_dot_v = self.n.dot(self.v).clamp(0.0, 1.0);
        let seen = shade::specular_occlusion(n_dot_v, occlusion, self.substance.roughness);
        let gathered = load3(token, &batch.surround.specular, i) * seen;
        let mut radiance = weights.specular.mul_elements(gathered) + weights.diffuse.mul_elements(mean);
        if let Some(fibres) = &self.fibres {
            radiance = fibres.over_mean(radiance, mean);
        }
        match &self.coat {
            Some(coat) => coat.over_surround(radiance, load3(token, &batch.surround.coat, i)),
            None => radiance,
        }
    }
}

/// The directional albedos of the fragments' lobe.
#[inline(always)]
pub(super) fn dfg<P: Pack>(token: P::Token, batch: &Batch, i: usize) -> Dfg<P> {
    let [scale, bias, edge, diffuse_edge] = P::load_pixels(token, &batch.dfg[i..]);
    Dfg { scale, bias, edge, diffuse_edge }
}

/// A colour of the material for all fragments.
#[inline(always)]
pub(super) fn everywhere<P: Pack>(token: P::Token, rgb: [f32; 3]) -> Vec3<P> {
    splat3(token, Vec3::from_array(rgb))
}
