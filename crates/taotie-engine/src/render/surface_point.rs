//! Fragments of a batch as points of a surface, the inputs of the pixel program: their shading normals, by the method
//! of their draw, and the directional albedos of their lobes, looked up in the tables.

use super::batch::{Batch, Column, Lanes, get3, store3};
use super::draw::Draw;
use super::settings::{GrazingNormals, RenderSettings};
use crate::math::{Pack, Vec3, Words, dispatch_pack};
use crate::pixel::{
    Anisotropic, Coat, EnvironmentTexels, Frame, Geometry, MappedNormal, MaterialPoint, MaterialUniforms,
    MaterialValues, Model, NormalInputs, PointLayers, Sheen, SurfacePoint, anisotropy_direction,
    anisotropy_turn, coat_albedo, coat_normal, is_cook_torrance, lobe_slope, own_turn, sheen_albedo,
    takes_albedos, takes_compensation, takes_layers,
};
use crate::scene::{Anisotropy, Material, NormalMap};
use crate::shade::dfg::{self, Dfg, TablePosition};
use crate::shade::{AnisotropicLobe, Energy, Shading};
use fearless_simd::Level;

/// Fills what points of a surface need in addition to interpolated and looked-up values: the shading normals and the
/// directional albedos of the lobes.
pub(super) fn complete(level: Level, settings: &RenderSettings, draw: &Draw<'_>, batch: &mut Batch) {
    shade_normals(level, draw, settings.grazing_normals, batch);
    if takes_albedos(settings.shading) {
        look_up_albedos(level, settings, draw, batch);
    }
}

impl<P: Pack> Lanes<'_, P> {
    /// The interpolated geometry.
    #[inline(always)]
    pub(super) fn geometry(&self) -> Geometry<P> {
        let batch = self.batch;
        Geometry {
            n_geom: self.load3(&batch.geometry.n_geom),
            normal: self.load3(&batch.geometry.normal),
            tangent: self.load3(&batch.geometry.tangent),
            handedness: self.load(&batch.geometry.handedness),
            facing: self.load(&batch.geometry.facing),
            v: self.load3(&batch.geometry.v),
        }
    }

    /// The directions, once shading normals are filled.
    #[inline(always)]
    pub(super) fn frame(&self) -> Frame<P> {
        let batch = self.batch;
        Frame {
            n: self.load3(&batch.frame.n),
            smooth: self.load3(&batch.frame.smooth),
            v: self.load3(&batch.geometry.v),
        }
    }

    /// The material's factors.
    #[inline(always)]
    pub(super) fn uniforms(&self, material: &Material) -> MaterialUniforms<P> {
        MaterialUniforms::new(material).map(|factor| self.splat(factor))
    }

    /// The material's values.
    #[inline(always)]
    pub(super) fn values(&self) -> MaterialValues<P> {
        let batch = self.batch;
        MaterialValues {
            tint: self.load3(&batch.material.tint),
            metallic: self.load(&batch.material.metallic),
            roughness: self.load(&batch.material.roughness),
            specular: self.load(&batch.material.specular),
            specular_color: self.load3(&batch.material.specular_color),
            occlusion: self.load(&batch.material.occlusion),
            emissive: self.load3(&batch.material.emissive),
            variance: self.load(&batch.material.variance),
        }
    }

    /// The anisotropy, if the material has one.
    #[inline(always)]
    pub(super) fn anisotropic(&self) -> Anisotropic<P> {
        let layers = &self.batch.layers;
        Anisotropic {
            direction: self.load3(&layers.anisotropy_direction),
            strength: self.load(&layers.anisotropy),
            roughness: self.load(&self.batch.material.roughness),
        }
    }

    /// Everything that reflection depends on.
    #[inline(always)]
    pub(super) fn surface_point(
        &self,
        Model { shading, layered }: Model,
        material: &Material,
    ) -> SurfacePoint<P> {
        let frame = self.frame();
        let compensated = self.batch.albedos.compensated && takes_compensation(shading);
        let dfg = compensated.then(|| self.dfg());
        let mut point = MaterialPoint::new(shading, &self.uniforms(material), &self.values(), dfg);
        if material.transmits() {
            point = point.transmitting(shading, self.load(&self.batch.material.transmission));
        }
        let layers = match layered {
            true => self.layers(material, frame.n),
            false => PointLayers { anisotropic: None, coat: None, sheen: None },
        };
        SurfacePoint { shading, material: point, frame, layers }
    }

    #[inline(always)]
    fn layers(&self, material: &Material, n: Vec3<P>) -> PointLayers<P> {
        let layers = &self.batch.layers;
        PointLayers {
            anisotropic: material.anisotropy.is_some().then(|| {
                let Anisotropic { direction, strength, roughness } = self.anisotropic();
                AnisotropicLobe::new(direction, n.cross(direction), roughness, strength)
            }),
            coat: material.clearcoat.is_some().then(|| Coat {
                n: self.load3(&layers.coat_n),
                factor: self.load(&layers.coat),
                roughness: self.load(&layers.coat_roughness),
                albedo: self.load(&layers.coat_albedo),
            }),
            sheen: material.sheen.is_some().then(|| Sheen {
                color: self.load3(&layers.sheen_color),
                roughness: self.load(&layers.sheen_roughness),
                albedo: self.load(&layers.sheen_albedo),
            }),
        }
    }

    /// The environment's light, if it was looked up.
    #[inline(always)]
    pub(super) fn environment(&self) -> EnvironmentTexels<P> {
        let radiance = &self.batch.environment.radiance;
        EnvironmentTexels {
            specular: self.load3(&radiance.specular),
            mean: self.load3(&radiance.mean),
            coat: self.load3(&radiance.coat),
        }
    }
}

/// Fills `batch.frame.n` and `batch.frame.smooth`, and the directions of the layers.
pub(super) fn shade_normals(level: Level, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    dispatch_pack!(level, P, token => all_packs::<P>(token, draw, grazing, batch));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    let method = draw.normal_source.method();
    let anisotropy = draw.material.anisotropy.as_ref().map(|anisotropy| (anisotropy, own_turn(anisotropy)));
    let softened = grazing == GrazingNormals::Soften && method.is_mapped();
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let geometry = at.geometry();
        let front = geometry.front_normal(method, &DrawNormals { at, draw });
        let frame = Frame::new(&geometry, front, side(at, draw), softened);
        store3(frame.n, &mut batch.frame.n, i);
        store3(frame.smooth, &mut batch.frame.smooth, i);
        if draw.material.clearcoat.is_some() {
            let at: Lanes<'_, P> = batch.lanes(token, i);
            let n = coat_normal(mapped_coat(at, &frame, draw), &frame);
            store3(n, &mut batch.layers.coat_n, i);
        }
        if let Some((anisotropy, own)) = anisotropy {
            let direction = turned_tangent::<P>(batch.lanes(token, i), anisotropy, own);
            store3(direction, &mut batch.layers.anisotropy_direction, i);
        }
    }
}

/// The direction of anisotropy, once `batch.frame.n` is filled; `own` is the material's turn.
#[inline(always)]
fn turned_tangent<P: Pack>(at: Lanes<'_, P>, anisotropy: &Anisotropy, own: [f32; 2]) -> Vec3<P> {
    let own = own.map(|part| at.splat(part));
    let [red, green] = &at.batch.layers.anisotropy_texel;
    let turn = match anisotropy.texture {
        Some(_) => anisotropy_turn(own, [at.load(red), at.load(green)]),
        None => own,
    };
    anisotropy_direction(&at.geometry(), at.load3(&at.batch.frame.n), turn)
}

/// The clearcoat's normal on the visible side, before it is turned towards the viewer.
#[inline(always)]
fn mapped_coat<P: Pack>(at: Lanes<'_, P>, frame: &Frame<P>, draw: &Draw<'_>) -> Vec3<P> {
    let map = draw.material.clearcoat.as_ref().and_then(|coat| coat.normal.as_ref());
    match map.filter(|_| !draw.tangents.is_empty()) {
        Some(map) => {
            let texel = mapped(at, Some(map), at.load3(&at.batch.layers.coat_map));
            at.geometry().tangent_mapped(texel) * side(at, draw)
        }
        None => frame.smooth,
    }
}

/// The columns and factors read by the method of a draw.
struct DrawNormals<'b, P: Pack> {
    at: Lanes<'b, P>,
    draw: &'b Draw<'b>,
}

impl<P: Pack> NormalInputs<P> for DrawNormals<'_, P> {
    #[inline(always)]
    fn bump(&self) -> ([Vec3<P>; 2], [P; 2]) {
        let Batch { geometry, texels, .. } = self.at.batch;
        let dp = [self.at.load3(&geometry.dp_du), self.at.load3(&geometry.dp_dv)];
        (dp, [self.at.load(&texels.dh_du), self.at.load(&texels.dh_dv)])
    }

    #[inline(always)]
    fn printed_bump(&self) -> [P; 2] {
        let factor = self.draw.normal_source.height_map().map_or(0.0, |(_, factor)| factor);
        [self.at.splat(factor), self.at.load(&self.at.batch.texels.dh_du)]
    }

    #[inline(always)]
    fn texel(&self) -> MappedNormal<P> {
        mapped(self.at, self.draw.normal_source.normal_map(), self.at.load3(&self.at.batch.texels.map))
    }

    #[inline(always)]
    fn normal_matrix(&self) -> [Vec3<P>; 3] {
        let [x, y, z] = self.draw.normal_matrix;
        [self.at.splat3(x), self.at.splat3(y), self.at.splat3(z)]
    }
}

#[inline(always)]
fn mapped<P: Pack>(at: Lanes<'_, P>, map: Option<&NormalMap>, stored: Vec3<P>) -> MappedNormal<P> {
    let (scale, green) = map.map_or((1.0, 1.0), |map| (map.scale, map.green.sign()));
    MappedNormal { stored, scale: at.splat(scale), green: at.splat(green) }
}

/// Seen from behind, the surface's normal is exactly the opposite one, including relief: 1, or −1 from behind.
#[inline(always)]
fn side<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> P {
    let turns = draw.material.double_sided || at.batch.both_sides;
    if turns { at.load(&at.batch.geometry.facing) } else { at.splat(1.0) }
}

/// Fills `batch.albedos.dfg` and the albedos of the layers.
pub(super) fn look_up_albedos(level: Level, settings: &RenderSettings, draw: &Draw<'_>, batch: &mut Batch) {
    let shading = settings.shading;
    batch.albedos.compensated = settings.energy == Energy::Compensated;
    let mut places = Places { node: Words::ZERO, across: Column::ZERO, down: Column::ZERO };
    dispatch_pack!(level, P, token => places.find::<P>(token, shading, draw.material, batch));
    let shares = places.across.iter().zip(places.down.iter());
    let entries = batch.albedos.dfg[..batch.len].iter_mut().zip(places.node.iter().zip(shares));
    if is_cook_torrance(shading) {
        entries.for_each(|(dfg, (node, (x, y)))| *dfg = Dfg::of_cook_torrance_at(*node, [*x, *y]));
    } else {
        entries.for_each(|(dfg, (node, (x, y)))| *dfg = Dfg::of_ggx_at(*node, [*x, *y]));
    }
    let material = draw.material;
    if takes_layers(shading) && (material.clearcoat.is_some() || material.sheen.is_some()) {
        for i in 0..batch.len {
            look_up_layer_albedos(material, batch, i);
        }
    }
}

/// The table positions at which fragments are looked up.
struct Places {
    node: Words,
    across: Column,
    down: Column,
}

impl Places {
    #[inline(always)]
    fn find<P: Pack>(&mut self, token: P::Token, shading: Shading, material: &Material, batch: &Batch) {
        for i in batch.packs::<P>() {
            let at: Lanes<'_, P> = batch.lanes(token, i);
            let n_dot_v = at.load3(&batch.frame.n).dot(at.load3(&batch.geometry.v));
            let place = match is_cook_torrance(shading) {
                true => {
                    let slope = lobe_slope(&at.uniforms(material), &at.values());
                    TablePosition::of_cook_torrance(n_dot_v, slope)
                }
                false => TablePosition::of_ggx(n_dot_v, at.load(&batch.material.roughness)),
            };
            place.node.store_words(&mut self.node[i..]);
            place.across.store(&mut self.across[i..]);
            place.down.store(&mut self.down[i..]);
        }
    }
}

/// Fills the clearcoat's albedo of entry `i` as seen from `v`.
pub(super) fn look_up_coat_albedo(material: &Material, batch: &mut Batch, i: usize, v: Vec3) {
    if material.clearcoat.is_some() {
        let cosine = get3(&batch.layers.coat_n, i).dot(v);
        batch.layers.coat_albedo[i] = coat_albedo(&dfg::of_ggx(cosine, batch.layers.coat_roughness[i]));
    }
}

fn look_up_layer_albedos(material: &Material, batch: &mut Batch, i: usize) {
    let v = get3(&batch.geometry.v, i);
    look_up_coat_albedo(material, batch, i, v);
    if material.sheen.is_some() {
        let cosine = get3(&batch.frame.n, i).dot(v);
        batch.layers.sheen_albedo[i] = sheen_albedo(dfg::of_sheen(cosine, batch.layers.sheen_roughness[i]));
    }
}
