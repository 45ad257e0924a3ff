//! A scene's triangles from a camera: projected and sorted into tiles.

use super::draw::Draw;
use super::view::View;
use crate::error::Result;
use crate::math::{Mat4, SimdLevel, Vec3, dispatch_registers};
use crate::parallel;
use crate::raster::{Bins, Faces, Geometry, Viewport};
use fearless_simd::{Level, Simd, f64x4, prelude::*};

/// Vertices per task.
const BLOCK: usize = 4096;

/// The triangles of an image. Its memory can be reused for the next one.
#[derive(Debug, Default)]
pub(super) struct Projected {
    /// Each draw's vertices in clip space.
    pub clip: Vec<Vec<[f32; 4]>>,
    /// The opaque triangles, which hide everything behind them.
    pub opaque: Bins,
    /// The triangles that may have holes.
    pub layered: Bins,
}

impl Projected {
    /// Projects, clips and bins all draws.
    ///
    /// # Errors
    /// If the SIMD level is not available on this machine.
    pub fn rebuild(
        &mut self,
        draws: &[Draw<'_>],
        view: &View,
        viewport: &Viewport,
        simd: SimdLevel,
    ) -> Result<()> {
        let level = simd.dispatch()?;
        self.clip.resize_with(draws.len(), Vec::new);
        for (draw, clip) in draws.iter().zip(&mut self.clip) {
            project(draw.positions, &view.clip_from_world, level, clip);
        }
        self.opaque.rebuild(&geometry(draws, &self.clip, false), viewport, simd)?;
        self.layered.rebuild(&geometry(draws, &self.clip, true), viewport, simd)
    }
}

/// Replaces `clip` by the images of `positions`, rounded once from double precision.
fn project(positions: &[Vec3], clip_from_world: &Mat4, level: Level, clip: &mut Vec<[f32; 4]>) {
    clip.resize(positions.len(), [0.0; 4]);
    parallel::pieces(clip, BLOCK, &|i, clip| {
        let positions = &positions[i * BLOCK..][..clip.len()];
        dispatch_registers!(level, simd => project_block(simd, clip_from_world, positions, clip));
    });
}

/// The four coordinates of a vertex side by side, two vertices at a time.
#[inline(always)]
fn project_block<S: Simd>(simd: S, m: &Mat4, positions: &[Vec3], clip: &mut [[f32; 4]]) {
    let (pairs, last) = positions.as_chunks::<2>();
    for (pair, clip) in pairs.iter().zip(clip.chunks_exact_mut(2)) {
        let (first, second) = (transform(simd, m, pair[0]), transform(simd, m, pair[1]));
        first.narrow(second).store_slice(clip.as_flattened_mut());
    }
    if let ([position], Some(clip)) = (last, clip.last_mut()) {
        let image = transform(simd, m, *position);
        let both: fearless_simd::f32x8<S> = image.narrow(image);
        clip.copy_from_slice(&both.as_slice()[..4]);
    }
}

/// [`Mat4::transform_homogeneous`], bit for bit.
#[inline(always)]
fn transform<S: Simd>(simd: S, m: &Mat4, p: Vec3) -> f64x4<S> {
    let [a, b, c, d] = &m.columns;
    let (a, b) = (f64x4::from_slice(simd, a), f64x4::from_slice(simd, b));
    let (c, d) = (f64x4::from_slice(simd, c), f64x4::from_slice(simd, d));
    a * f64::from(p.x) + b * f64::from(p.y) + c * f64::from(p.z) + d
}

fn geometry<'g>(draws: &'g [Draw<'_>], clip: &'g [Vec<[f32; 4]>], layered: bool) -> Vec<Geometry<'g>> {
    let pairs = draws.iter().zip(clip);
    pairs
        .filter(|(draw, _)| draw.layered() == layered)
        .map(|(draw, clip)| Geometry {
            clip,
            triangles: draw.mesh.triangles(),
            faces: match (draw.material.double_sided, draw.mirrored) {
                (true, _) => Faces::Both,
                (false, false) => Faces::CounterClockwise,
                (false, true) => Faces::Clockwise,
            },
            first_id: draw.first_triangle,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packs_project_as_single_vertices_do() {
        let m = Mat4::rotation_about(Vec3::new(0.0, 0.6, 0.8), 0.7)
            * Mat4::translation(Vec3::new(0.3, -2.0, 1e-3));
        let positions: Vec<Vec3> =
            (0..7).map(|i| Vec3::new(0.1 * i as f32, 3.7 - 0.9 * i as f32, 1e3 / (i as f32 - 2.5))).collect();
        let expected: Vec<[f32; 4]> =
            positions.iter().map(|p| m.transform_homogeneous(p.to_f64()).map(|v| v as f32)).collect();
        for simd in SimdLevel::available() {
            let mut clip = Vec::new();
            project(&positions, &m, simd.dispatch().unwrap(), &mut clip);
            assert_eq!(clip, expected, "{simd:?}");
        }
    }
}
