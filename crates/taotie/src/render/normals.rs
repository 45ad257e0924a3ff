//! The shading normal of each fragment, by the method of its draw.

use super::batch::{Batch, load, load3, splat3, store3};
use super::prepare::{Draw, NormalSource};
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::scene::{GreenChannel, NormalMap};
use crate::surface;
use fearless_simd::Level;

/// Fills `batch.n`.
pub(super) fn shade_normals(level: Level, draw: &Draw<'_>, batch: &mut Batch) {
    dispatch_pack!(level, P, token => all_packs::<P>(token, draw, batch));
}

#[inline(always)]
fn all_packs<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &mut Batch) {
    for i in batch.packs::<P>() {
        let n: Vec3<P> = pack_normal(token, draw, batch, i);
        let n = face_viewer(token, draw, batch, i, n);
        store3(n, &mut batch.n, i);
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
                load3(token, &batch.dp_du, i),
                load3(token, &batch.dp_dv, i),
                load(token, &batch.dh_du, i),
                load(token, &batch.dh_dv, i),
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

/// Seen from behind, the surface's normal is exactly the opposite one, relief and all.
#[inline(always)]
fn face_viewer<P: Pack>(token: P::Token, draw: &Draw<'_>, batch: &Batch, i: usize, n: Vec3<P>) -> Vec3<P> {
    let turns = draw.material.double_sided || batch.both_sides;
    if turns { n * load(token, &batch.facing, i) } else { n }
}
