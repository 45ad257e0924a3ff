//! The shading normal of each fragment, by the method of its draw.

use super::batch::{Batch, Lanes};
use super::columns::store3;
use super::draw::{Draw, NormalSource};
use super::layers::squared_slope;
use super::settings::GrazingNormals;
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::scene::{GreenChannel, NormalMap};
use crate::surface;
use fearless_simd::Level;

/// Fills `batch.n`, `batch.smooth` and `batch.bump`, and the directions of the layers.
pub(super) fn shade_normals(level: Level, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    dispatch_pack!(level, P, token => all_packs::<P>(token, draw, grazing, batch));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, draw: &Draw<'_>, grazing: GrazingNormals, batch: &mut Batch) {
    let soften = grazing == GrazingNormals::Soften && draw.normal_source.is_mapped();
    for i in batch.packs::<P>() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let side = side(at, draw);
        let smooth = at.load3(&batch.normal).normalize_or(at.load3(&batch.n_geom)) * side;
        let mut n = pack_normal(at, draw) * side;
        if soften {
            n = towards_viewer(n, smooth, at.load3(&batch.v));
            squared_slope(smooth, n).store(&mut batch.bump[i..]);
        } else {
            at.splat(0.0).store(&mut batch.bump[i..]);
        }
        store3(n, &mut batch.n, i);
        store3(smooth, &mut batch.smooth, i);
        shade_layers::<P>(token, draw, batch, i);
    }
}

/// The least n·v that a mapped normal keeps where the smooth normal has as much, and where it has none.
const LEAST_N_DOT_V: f64 = 0.25;
const LEAST_AT_RIM: f64 = 0.01;

/// A mapped normal that turns away from a viewer who sees the surface, turned back until it is just seen: the least
/// change there is, and without a step, where mirroring the normal would light the wrong side of every steep slope.
#[inline(always)]
fn towards_viewer<P: Pack>(n: Vec3<P>, smooth: Vec3<P>, v: Vec3<P>) -> Vec3<P> {
    let zero = n.x.lit(0.0);
    let least = smooth.dot(v).clamp(LEAST_AT_RIM, LEAST_N_DOT_V);
    let lacking = (least - n.dot(v)).max(zero);
    Vec3::select(zero.lt(lacking), (n + v * lacking).normalize_or(smooth), n)
}

/// The clearcoat's normal, and the direction of anisotropy, where `batch.n` and `batch.smooth` are there.
#[inline(always)]
fn shade_layers<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &mut Batch, i: usize) {
    if draw.material.clearcoat.is_some() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let smooth = at.load3(&batch.smooth);
        let coat_n = towards_viewer(coat_normal(at, draw), smooth, at.load3(&batch.v));
        store3(coat_n, &mut batch.layers.coat_n, i);
    }
    if draw.material.anisotropy.is_some() {
        let at: Lanes<'_, P> = batch.lanes(token, i);
        let (n, tangent) = (at.load3(&batch.n), at.load3(&batch.tangent));
        let [cos, sin] = &batch.layers.anisotropy_turn;
        let (cos, sin) = (at.load(cos), at.load(sin));
        let across = n.cross(tangent) * at.load(&batch.handedness);
        let along = tangent * cos + across * sin;
        let flat = along - n * n.dot(along);
        store3(flat.normalize_or(n.any_perpendicular()), &mut batch.layers.anisotropy_direction, i);
    }
}

/// The clearcoat's normal, before it is turned towards the viewer.
#[inline(always)]
fn coat_normal<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> Vec3<P> {
    let batch = at.batch;
    let map = draw.material.clearcoat.as_ref().and_then(|coat| coat.normal.as_ref());
    match map.filter(|_| !draw.tangents.is_empty()) {
        Some(map) => {
            let stored = decode(at, map, at.load3(&batch.layers.coat_map));
            let (normal, tangent) = (at.load3(&batch.normal), at.load3(&batch.tangent));
            let handedness = at.load(&batch.handedness);
            surface::tangent_normal(normal, tangent, handedness, stored) * side(at, draw)
        }
        None => at.load3(&batch.smooth),
    }
}

/// The normal of the front.
#[inline(always)]
fn pack_normal<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> Vec3<P> {
    let batch = at.batch;
    let interpolated = at.load3(&batch.normal);
    match &draw.normal_source {
        NormalSource::Facet => at.load3(&batch.n_geom) * at.load(&batch.facing),
        NormalSource::Smooth => interpolated.normalize_or(at.load3(&batch.n_geom)),
        NormalSource::Bump(..) => {
            let n = interpolated.normalize_or(at.load3(&batch.n_geom));
            let gradient = surface::surface_gradient(
                n,
                [at.load3(&batch.dp_du), at.load3(&batch.dp_dv)],
                [at.load(&batch.dh_du), at.load(&batch.dh_dv)],
            );
            surface::bump(n, gradient)
        }
        NormalSource::BumpPrinted(_, factor) => {
            let n = interpolated.normalize_or(at.load3(&batch.n_geom));
            let bumped = surface::bump_printed(n, at.splat(*factor), at.load(&batch.dh_du));
            let [x, y, z] = normal_matrix(at, draw);
            x * bumped.x + y * bumped.y + z * bumped.z
        }
        NormalSource::ObjectMap(_) => {
            let stored = surface::decode_object_normal(at.load3(&batch.map));
            surface::object_normal(stored, normal_matrix(at, draw))
        }
        NormalSource::TangentMap(map) => {
            let stored = decode(at, map, at.load3(&batch.map));
            let tangent = at.load3(&batch.tangent);
            surface::tangent_normal(interpolated, tangent, at.load(&batch.handedness), stored)
        }
    }
}

#[inline(always)]
fn normal_matrix<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> [Vec3<P>; 3] {
    let [x, y, z] = draw.normal_matrix;
    [at.splat3(x), at.splat3(y), at.splat3(z)]
}

#[inline(always)]
fn decode<P: Pack>(at: Lanes<'_, P>, map: &NormalMap, stored: Vec3<P>) -> Vec3<P> {
    let green = match map.green {
        GreenChannel::Up => 1.0,
        GreenChannel::Down => -1.0,
    };
    surface::decode_normal(stored, at.splat(map.scale), at.splat(green))
}

/// Seen from behind, the surface's normal is exactly the opposite one, relief and all: 1, or −1 there.
#[inline(always)]
fn side<P: Pack>(at: Lanes<'_, P>, draw: &Draw<'_>) -> P {
    let turns = draw.material.double_sided || at.batch.both_sides;
    if turns { at.load(&at.batch.facing) } else { at.splat(1.0) }
}
