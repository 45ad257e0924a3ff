//! The shading normal of each fragment, by the method of its draw.

use super::batch::{Batch, Lanes};
use super::columns::store3;
use super::draw::Draw;
use super::settings::GrazingNormals;
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::pixel::{Frame, MappedNormal, NormalInputs, anisotropy_direction, coat_normal};
use crate::scene::NormalMap;
use fearless_simd::Level;

/// Fills `batch.frame.n` and `batch.frame.smooth`, and the directions of the layers.
pub(super) fn shade_normals(level: Level, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    dispatch_pack!(level, P, token => all_packs::<P>(token, draw, grazing, batch));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    let method = draw.normal_source.method();
    let softened = grazing == GrazingNormals::Soften && method.is_mapped();
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let geometry = at.geometry();
        let front = geometry.front_normal(method, &DrawNormals { at, draw });
        let frame = Frame::new(&geometry, front, side(at, draw), softened);
        store3(frame.n, &mut batch.frame.n, i);
        store3(frame.smooth, &mut batch.frame.smooth, i);
        shade_layers::<P>(token, draw, batch, i);
    }
}

/// The clearcoat's normal, and the direction of anisotropy, once `batch.frame.n` and `batch.frame.smooth` are filled.
#[inline(always)]
fn shade_layers<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &mut Batch, i: usize) {
    if draw.material.clearcoat.is_some() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let frame = at.frame();
        let n = coat_normal(mapped_coat(at, &frame, draw), &frame);
        store3(n, &mut batch.layers.coat_n, i);
    }
    if draw.material.anisotropy.is_some() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let [cos, sin] = &batch.layers.anisotropy_turn;
        let turn = [at.load(cos), at.load(sin)];
        let direction = anisotropy_direction(&at.geometry(), at.load3(&batch.frame.n), turn);
        store3(direction, &mut batch.layers.anisotropy_direction, i);
    }
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
