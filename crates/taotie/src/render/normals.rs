//! The shading normal of each fragment, by the method of its draw.

use super::batch::{Batch, Lanes};
use super::columns::store3;
use super::draw::{Draw, NormalSource};
use super::settings::GrazingNormals;
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::pixel::{Frame, Geometry, MappedNormal, anisotropy_direction, coat_normal};
use crate::scene::{GreenChannel, NormalMap};
use fearless_simd::Level;

/// Fills `batch.frame.n` and `batch.frame.smooth`, and the directions of the layers.
pub(super) fn shade_normals(level: Level, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    dispatch_pack!(level, P, token => all_packs::<P>(token, draw, grazing, batch));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    let softened = grazing == GrazingNormals::Soften && draw.normal_source.is_mapped();
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let geometry = at.geometry();
        let frame = Frame::new(&geometry, front_normal(at, &geometry, draw), side(at, draw), softened);
        store3(frame.n, &mut batch.frame.n, i);
        store3(frame.smooth, &mut batch.frame.smooth, i);
        shade_layers::<P>(token, draw, batch, i);
    }
}

/// The clearcoat's normal, and the direction of anisotropy, where `batch.frame.n` and `batch.frame.smooth` are there.
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

/// The clearcoat's normal on the side that is seen, before it is turned towards the viewer.
#[inline(always)]
fn mapped_coat<P: Pack>(at: Lanes<'_, P>, frame: &Frame<P>, draw: &Draw<'_>) -> Vec3<P> {
    let map = draw.material.clearcoat.as_ref().and_then(|coat| coat.normal.as_ref());
    match map.filter(|_| !draw.tangents.is_empty()) {
        Some(map) => {
            let texel = mapped(at, map, at.load3(&at.batch.layers.coat_map));
            at.geometry().tangent_mapped(texel) * side(at, draw)
        }
        None => frame.smooth,
    }
}

/// The shading normal of the front.
#[inline(always)]
fn front_normal<P: Pack>(at: Lanes<'_, P>, geometry: &Geometry<P>, draw: &Draw<'_>) -> Vec3<P> {
    let batch = at.batch;
    match &draw.normal_source {
        NormalSource::Facet => geometry.facet(),
        NormalSource::Smooth => geometry.smooth(),
        NormalSource::Bump(..) => geometry.bumped(
            [at.load3(&batch.geometry.dp_du), at.load3(&batch.geometry.dp_dv)],
            [at.load(&batch.texels.dh_du), at.load(&batch.texels.dh_dv)],
        ),
        NormalSource::BumpPrinted(_, factor) => {
            let matrix = normal_matrix(at, draw);
            geometry.bumped_as_printed(at.splat(*factor), at.load(&batch.texels.dh_du), matrix)
        }
        NormalSource::ObjectMap(_) => {
            Geometry::object_mapped(at.load3(&batch.texels.map), normal_matrix(at, draw))
        }
        NormalSource::TangentMap(map) => {
            geometry.tangent_mapped(mapped(at, map, at.load3(&batch.texels.map)))
        }
    }
}

#[inline(always)]
fn normal_matrix<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> [Vec3<P>; 3] {
    let [x, y, z] = draw.normal_matrix;
    [at.splat3(x), at.splat3(y), at.splat3(z)]
}

#[inline(always)]
fn mapped<P: Pack>(at: Lanes<'_, P>, map: &NormalMap, stored: Vec3<P>) -> MappedNormal<P> {
    let green = match map.green {
        GreenChannel::Up => 1.0,
        GreenChannel::Down => -1.0,
    };
    MappedNormal { stored, scale: at.splat(map.scale), green: at.splat(green) }
}

/// Seen from behind, the surface's normal is exactly the opposite one, relief and all: 1, or −1 there.
#[inline(always)]
fn side<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> P {
    let turns = draw.material.double_sided || at.batch.both_sides;
    if turns { at.load(&at.batch.geometry.facing) } else { at.splat(1.0) }
}
