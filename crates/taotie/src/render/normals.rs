//! The shading normal of each fragment, by the method of its draw.

use super::GrazingNormals;
use super::batch::{Batch, load, load3, splat3, store3};
use super::layers::squared_slope;
use super::prepare::{Draw, NormalSource};
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
    let soften = grazing == GrazingNormals::Soften && is_mapped(&draw.normal_source);
    for i in batch.packs::<P>() {
        let side: P = side(token, draw, batch, i);
        let smooth = load3(token, &batch.normal, i).normalize_or(load3(token, &batch.n_geom, i)) * side;
        let mut n: Vec3<P> = pack_normal(token, draw, batch, i) * side;
        if soften {
            n = towards_viewer(n, smooth, load3(token, &batch.v, i));
            squared_slope(smooth, n).store(&mut batch.bump[i..]);
        } else {
            P::splat(token, 0.0).store(&mut batch.bump[i..]);
        }
        store3(n, &mut batch.n, i);
        store3(smooth, &mut batch.smooth, i);
        shade_layers(token, draw, batch, i, n);
    }
}

/// Whether a picture turns the normals, and not as printed.
pub(super) fn is_mapped(source: &NormalSource<'_>) -> bool {
    match source {
        NormalSource::Facet | NormalSource::Smooth | NormalSource::BumpPrinted(..) => false,
        NormalSource::Bump(..) | NormalSource::ObjectMap(_) | NormalSource::TangentMap(_) => true,
    }
}

/// The least n·v that a mapped normal keeps where the smooth normal has as much, and where it has none.
const LEAST_N_DOT_V: f64 = 0.25;
const LEAST_AT_RIM: f64 = 0.01;

/// A mapped normal that turns away from a viewer who sees the surface, bent towards him until he just sees it: the least
/// change there is, and without a step, where mirroring the normal would light the wrong side of every steep slope.
#[inline(always)]
fn towards_viewer<P: Pack>(n: Vec3<P>, smooth: Vec3<P>, v: Vec3<P>) -> Vec3<P> {
    let zero = n.x.lit(0.0);
    let least = smooth.dot(v).clamp(LEAST_AT_RIM, LEAST_N_DOT_V);
    let lacking = (least - n.dot(v)).max(zero);
    Vec3::select(zero.lt(lacking), (n + v * lacking).normalize_or(smooth), n)
}

/// The lacquer's normal, and the direction of stretched highlights.
#[inline(always)]
fn shade_layers<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &mut Batch, i: usize, n: Vec3<P>) {
    let (tangent, handedness): (Vec3<P>, P) =
        (load3(token, &batch.tangent, i), load(token, &batch.handedness, i));
    if let Some(coat) = &draw.material.clearcoat {
        let smooth: Vec3<P> = load3(token, &batch.smooth, i);
        let coat_n = match coat.normal.as_ref().filter(|_| !draw.tangents.is_empty()) {
            Some(map) => {
                let stored = decode(token, map, load3(token, &batch.layers.coat_map, i));
                let normal = load3(token, &batch.normal, i);
                surface::tangent_normal(normal, tangent, handedness, stored) * side(token, draw, batch, i)
            }
            None => smooth,
        };
        store3(towards_viewer(coat_n, smooth, load3(token, &batch.v, i)), &mut batch.layers.coat_n, i);
    }
    if draw.material.anisotropy.is_some() {
        let [cos, sin] = [0, 1].map(|c| load(token, &batch.layers.stretch_turn[c], i));
        let across = n.cross(tangent) * handedness;
        let along = tangent * cos + across * sin;
        let flat = along - n * n.dot(along);
        store3(flat.normalize_or(n.any_perpendicular()), &mut batch.layers.stretch_tangent, i);
    }
}

/// The normal of the front.
#[inline(always)]
fn pack_normal<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &Batch, i: usize) -> Vec3<P> {
    let interpolated = load3(token, &batch.normal, i);
    match draw.normal_source {
        NormalSource::Facet => load3(token, &batch.n_geom, i) * load(token, &batch.facing, i),
        NormalSource::Smooth => interpolated.normalize_or(load3(token, &batch.n_geom, i)),
        NormalSource::Bump(..) => {
            let n = interpolated.normalize_or(load3(token, &batch.n_geom, i));
            let gradient = surface::surface_gradient(
                n,
                [load3(token, &batch.dp_du, i), load3(token, &batch.dp_dv, i)],
                [load(token, &batch.dh_du, i), load(token, &batch.dh_dv, i)],
            );
            surface::bump(n, gradient)
        }
        NormalSource::BumpPrinted(_, factor) => {
            let n = interpolated.normalize_or(load3(token, &batch.n_geom, i));
            let bumped = surface::bump_printed(n, P::splat(token, factor), load(token, &batch.dh_du, i));
            let [x, y, z] = draw.normal_matrix.map(|column| splat3(token, column));
            x * bumped.x + y * bumped.y + z * bumped.z
        }
        NormalSource::ObjectMap(_) => {
            let stored = surface::decode_object_normal(load3(token, &batch.map, i));
            surface::object_normal(stored, draw.normal_matrix.map(|column| splat3(token, column)))
        }
        NormalSource::TangentMap(map) => {
            let stored = decode(token, map, load3(token, &batch.map, i));
            let tangent = load3(token, &batch.tangent, i);
            surface::tangent_normal(interpolated, tangent, load(token, &batch.handedness, i), stored)
        }
    }
}

#[inline(always)]
fn decode<P: Pack>(token: P::Token, map: &NormalMap, stored: Vec3<P>) -> Vec3<P> {
    let green = match map.green {
        GreenChannel::Up => 1.0,
        GreenChannel::Down => -1.0,
    };
    surface::decode_normal(stored, P::splat(token, map.scale), P::splat(token, green))
}

/// Seen from behind, the surface's normal is exactly the opposite one, relief and all: 1, or −1 there.
#[inline(always)]
fn side<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &Batch, i: usize) -> P {
    let turns = draw.material.double_sided || batch.both_sides;
    if turns { load(token, &batch.facing, i) } else { P::splat(token, 1.0) }
}
