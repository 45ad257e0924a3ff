//! The shading normal of each fragment, by the method of its draw.

use super::batch::{Batch, load, load3, splat3, store3};
use super::prepare::{Draw, NormalSource};
use crate::math::Vec3;
use crate::scene::{GreenChannel, NormalMap};
use crate::surface;
use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};

/// Fills `batch.n`.
pub(super) fn shade_normals(level: Level, draw: &Draw<'_>, batch: &mut Batch) {
    dispatch!(level, simd => all_packs(simd, draw, batch));
}

#[inline(always)]
fn all_packs<S: Simd>(simd: S, draw: &Draw<'_>, batch: &mut Batch) {
    for i in batch.packs() {
        let n = pack_normal(simd, draw, batch, i);
        let n = face_viewer(simd, draw, batch, i, n);
        store3(n, &mut batch.n, i);
    }
}

/// The normal of the front.
#[inline(always)]
fn pack_normal<S: Simd>(simd: S, draw: &Draw<'_>, batch: &Batch, i: usize) -> Vec3<f32x8<S>> {
    let interpolated = load3(simd, &batch.normal, i);
    match draw.normal_source {
        NormalSource::Facet => load3(simd, &batch.n_geom, i) * load(simd, &batch.facing, i),
        NormalSource::Smooth => interpolated.normalize_or(load3(simd, &batch.n_geom, i)),
        NormalSource::Bump(..) => {
            let n = interpolated.normalize_or(load3(simd, &batch.n_geom, i));
            let gradient = surface::surface_gradient(
                n,
                load3(simd, &batch.dp_du, i),
                load3(simd, &batch.dp_dv, i),
                load(simd, &batch.dh_du, i),
                load(simd, &batch.dh_dv, i),
            );
            surface::bump(n, gradient)
        }
        NormalSource::BumpPrinted(_, factor) => {
            let n = interpolated.normalize_or(load3(simd, &batch.n_geom, i));
            let bumped = surface::bump_printed(n, f32x8::splat(simd, factor), load(simd, &batch.dh_du, i));
            let [x, y, z] = draw.normal_matrix.map(|column| splat3(simd, column));
            x * bumped.x + y * bumped.y + z * bumped.z
        }
        NormalSource::ObjectMap(_) => {
            let stored = surface::decode_object_normal(load3(simd, &batch.map, i));
            surface::object_normal(stored, draw.normal_matrix.map(|column| splat3(simd, column)))
        }
        NormalSource::TangentMap(map) => {
            let stored = decode(simd, map, load3(simd, &batch.map, i));
            let tangent = load3(simd, &batch.tangent, i);
            surface::tangent_normal(interpolated, tangent, load(simd, &batch.handedness, i), stored)
        }
    }
}

#[inline(always)]
fn decode<S: Simd>(simd: S, map: &NormalMap, stored: Vec3<f32x8<S>>) -> Vec3<f32x8<S>> {
    let green = match map.green {
        GreenChannel::Up => 1.0,
        GreenChannel::Down => -1.0,
    };
    surface::decode_normal(stored, f32x8::splat(simd, map.scale), f32x8::splat(simd, green))
}

/// Seen from behind, the surface's normal is exactly the opposite one, relief and all.
#[inline(always)]
fn face_viewer<S: Simd>(
    simd: S,
    draw: &Draw<'_>,
    batch: &Batch,
    i: usize,
    n: Vec3<f32x8<S>>,
) -> Vec3<f32x8<S>> {
    if draw.material.double_sided { n * load(simd, &batch.facing, i) } else { n }
}
