//! The normal at a point, bent by a normal or height map.

use super::texture_lookup::{LookupPoint, TextureOnMesh};
use crate::math::{Mat4, Vec2, Vec3, poly};
use crate::mesh::Point;
use crate::scene::NormalMap;
use crate::surface::{
    UvDerivatives, bump, decode_normal, decode_object_normal, object_normal, surface_gradient, tangent_normal,
};

/// A normal including the relief of its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedNormal {
    /// Unit, world space.
    pub normal: Vec3,
    /// The variance of the map's normals within the lookup width, [0, 1].
    pub variance: f32,
}

/// Returns the normal from an object-space map.
pub(super) fn of_object_map(
    on: &TextureOnMesh<'_>,
    at: LookupPoint,
    world_from_object: &Mat4,
) -> MappedNormal {
    let lod = on.derivatives(at.point).map_or(0.0, |d| on.lod(&d, at.width));
    let value @ [r, g, b, _] = on.value(on.uv(at.point), lod);
    let matrix = world_from_object.normal_matrix();
    let stored = decode_object_normal(Vec3::new(r, g, b)).to_f64();
    let normal = object_normal(stored, [0, 1, 2].map(|j| matrix.axis(j))).to_f32();
    MappedNormal { normal, variance: on.variance(value, lod) }
}

/// Returns the normal from a tangent-space map; `None` if uvs span no area, so that tangents are undefined.
pub(super) fn of_tangent_map(
    on: &TextureOnMesh<'_>,
    at: LookupPoint,
    map: &NormalMap,
) -> Option<MappedNormal> {
    let lod = on.lod(&on.derivatives(at.point)?, at.width);
    let value @ [r, g, b, _] = on.value(on.uv(at.point), lod);
    let stored = decode_normal(Vec3::new(r, g, b), map.scale, map.green.sign());
    let frame = at.point.frame(on.mesh);
    let variance = (on.variance(value, lod) * map.scale * map.scale).min(1.0);
    Some(MappedNormal {
        normal: tangent_normal(frame.normal, frame.tangent, frame.handedness, stored),
        variance,
    })
}

/// Returns the smooth normal bent by heights in model units; `None` if uvs span no area.
pub(super) fn of_heights(
    on: &TextureOnMesh<'_>,
    at: LookupPoint,
    scale: f32,
    smooth: Vec3,
) -> Option<MappedNormal> {
    let derivatives = on.derivatives(at.point)?;
    let slopes = height_slopes(on, at.point, on.lod(&derivatives, at.width)).map(|slope| slope * scale);
    let UvDerivatives { dp_du, dp_dv, .. } = derivatives;
    let normal = bump(smooth, surface_gradient(smooth, [dp_du, dp_dv], slopes));
    Some(MappedNormal { normal, variance: 0.0 })
}

/// Returns the derivatives of the first channel by u and v: central differences of one texel of the level to each
/// side.
fn height_slopes(on: &TextureOnMesh<'_>, point: Point, lod: f32) -> [f32; 2] {
    let last = (on.texture.levels() - 1) as f32;
    let texels = poly::exp2(lod.clamp(0.0, last));
    let uv = on.uv(point);
    let slope = |size: u32, along: Vec2| {
        let step = texels / size as f32;
        let height = |side: f32| on.value(uv + along * (side * step), lod)[0];
        (height(1.0) - height(-1.0)) / (2.0 * step)
    };
    [slope(on.texture.width(), Vec2::new(1.0, 0.0)), slope(on.texture.height(), Vec2::new(0.0, 1.0))]
}
