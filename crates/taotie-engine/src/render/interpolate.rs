//! Interpolates vertices to fragments: the values of corners, at points of their triangles.

use super::batch::{Batch, Points, Run, load, load3, splat3, store3};
use super::camera::Eye;
use super::draw::Draw;
use super::lookups::UvSet;
use crate::math::{Pack, Vec3, dispatch_pack};
use crate::raster::{CornerNumbers, PerspectiveTriangle, PlaneSetup, TRIANGLES, Viewport};
use crate::scene::Scene;
use crate::shade::curvature_variance;
use crate::surface::{self, SurfaceMethod};
use fearless_simd::Level;

/// Computes fragments of points on one draw's triangles.
pub(super) struct Interpolation<'p> {
    pub level: Level,
    pub scene: &'p Scene,
    pub draw: &'p Draw<'p>,
    /// `true` if subpixel detail widens highlights.
    pub specular_aa: bool,
    /// `true` if anything depends on the roughness.
    pub takes_roughness: bool,
}

/// The screen positions of the rasteriser's fragments.
pub(super) struct Screen<'p> {
    pub viewport: &'p Viewport,
    /// The draw's vertices in clip space.
    pub clip: &'p [[f32; 4]],
    /// The origin of `batch.points.place`, in pixels from the image's top left corner.
    pub origin: [f64; 2],
}

impl Interpolation<'_> {
    /// Fills the weights of fragments from their screen positions.
    pub(super) fn weigh(&self, screen: &Screen<'_>, batch: &mut Batch) {
        dispatch_pack!(self.level, P, token => self.weigh_packs::<P>(token, screen, batch));
    }

    /// Fills everything that follows from the corners and the weights. `eye` is the viewpoint; without one,
    /// `batch.geometry.v` must be filled.
    pub(super) fn interpolate(&self, eye: Option<Eye>, batch: &mut Batch) {
        let sets = self.draw.mesh.uvs().len();
        batch.points.uv_sets.resize_with(sets, UvSet::default);
        dispatch_pack!(self.level, P, token => self.interpolate_packs::<P>(token, eye, batch));
    }

    #[inline(always)]
    fn weigh_packs<P: Pack>(&self, token: P::Token, screen: &Screen<'_>, batch: &mut Batch) {
        let Batch { len, points: Points { runs, corners, place: [x, y], weights, d_x, d_y, .. }, .. } = batch;
        let setup = PlaneSetup::new(screen.viewport, screen.origin);
        for runs in runs.chunks(TRIANGLES) {
            let planes = setup.planes(&self.clip_corners(screen.clip, runs));
            for (i, run) in runs.iter().enumerate() {
                let planes = planes.each_ref().map(|[c, a, b]| [c[i], a[i], b[i]]);
                corners.write::<P, 3>(token, *run, planes);
            }
        }
        let spacing = P::splat(token, screen.viewport.pattern.spacing());
        for i in (0..*len).step_by(P::LANES) {
            let plane = |corner: usize| {
                let Vec3 { x, y, z } = corners.written3::<P>(token, corner, i);
                [x, y, z]
            };
            let triangle = PerspectiveTriangle { planes: [plane(0), plane(1), plane(2)] };
            let bary = triangle.at(load(token, x, i), load(token, y, i));
            for corner in 0..3 {
                bary.weights[corner].store(&mut weights[corner][i..]);
                (bary.d_x[corner] * spacing).store(&mut d_x[corner][i..]);
                (bary.d_y[corner] * spacing).store(&mut d_y[corner][i..]);
            }
        }
    }

    /// The corners' (x, y, w) in clip space of at most [`TRIANGLES`] triangles.
    #[inline(always)]
    fn clip_corners(&self, clip: &[[f32; 4]], runs: &[Run]) -> CornerNumbers<f64> {
        let mut corners = [[[0.0; TRIANGLES]; 3]; 3];
        for (i, run) in runs.iter().enumerate() {
            for (corner, vertex) in corners.iter_mut().zip(self.draw.vertices(run.triangle)) {
                let [x, y, _, w] = clip[vertex as usize];
                (corner[0][i], corner[1][i], corner[2][i]) = (x.into(), y.into(), w.into());
            }
        }
        corners
    }

    #[inline(always)]
    fn interpolate_packs<P: Pack>(&self, token: P::Token, eye: Option<Eye>, batch: &mut Batch) {
        self.geometry::<P>(token, eye, batch);
        self.normals::<P>(token, batch);
        if !self.draw.tangents.is_empty() {
            self.tangents::<P>(token, batch);
        }
        self.uv_derivatives::<P>(token, batch);
        self.uvs::<P>(token, batch);
        if !self.draw.mesh.colors().is_empty() {
            self.colors::<P>(token, batch);
        }
    }

    /// Writes vectors of the corners for all fragments.
    #[inline(always)]
    fn write_vectors<P: Pack>(&self, token: P::Token, values: &[Vec3], batch: &mut Batch) {
        for run in batch.points.runs.iter().copied() {
            let corners = self.draw.vertices(run.triangle).map(|v| values[v as usize].to_array());
            batch.points.corners.write_differences::<P, 3>(token, run, corners);
        }
    }

    /// Fills position, viewing direction and side.
    #[inline(always)]
    fn geometry<P: Pack>(&self, token: P::Token, eye: Option<Eye>, batch: &mut Batch) {
        self.write_vectors::<P>(token, self.draw.positions, batch);
        let sign = P::splat(token, if self.draw.mirrored { -1.0 } else { 1.0 });
        let up: Vec3<P> = splat3(token, Vec3::new(0.0, 0.0, 1.0));
        let (zero, one) = (P::splat(token, 0.0), P::splat(token, 1.0));
        for i in batch.packs::<P>() {
            let corners = &batch.points.corners;
            let (to_second, to_third) =
                (corners.written3::<P>(token, 1, i), corners.written3::<P>(token, 2, i));
            let n_front = to_second.cross(to_third).normalize_or(up) * sign;
            let position = corners.at3::<P>(token, &batch.points.weights, i);
            let v = match eye {
                Some(Eye::Point(eye)) => (splat3(token, eye) - position).normalize_or(n_front),
                Some(Eye::Direction(direction)) => splat3(token, direction),
                None => load3(token, &batch.geometry.v, i),
            };
            let facing = P::select(n_front.dot(v).lt(zero), -one, one);
            store3(position, &mut batch.geometry.position, i);
            if eye.is_some() {
                store3(v, &mut batch.geometry.v, i);
            }
            store3(n_front * facing, &mut batch.geometry.n_geom, i);
            facing.store(&mut batch.geometry.facing[i..]);
        }
    }

    /// Fills the normal, and the curvature of the surface.
    #[inline(always)]
    fn normals<P: Pack>(&self, token: P::Token, batch: &mut Batch) {
        let draw = self.draw;
        self.write_vectors::<P>(token, draw.normals, batch);
        let bends = self.specular_aa && draw.normal_source.method() != SurfaceMethod::Facet;
        for i in batch.packs::<P>() {
            let mut bent = P::splat(token, 0.0);
            if bends {
                let d_x = batch.points.corners.change3::<P>(token, &batch.points.d_x, i);
                let d_y = batch.points.corners.change3::<P>(token, &batch.points.d_y, i);
                bent = curvature_variance(d_x, d_y);
            }
            bent.store(&mut batch.geometry.curvature[i..]);
            store3(
                batch.points.corners.at3::<P>(token, &batch.points.weights, i),
                &mut batch.geometry.normal,
                i,
            );
        }
        if draw.normal_source.method() == SurfaceMethod::BumpPrinted {
            self.write_vectors::<P>(token, draw.mesh.normals(), batch);
            for i in batch.packs::<P>() {
                store3(
                    batch.points.corners.at3::<P>(token, &batch.points.weights, i),
                    &mut batch.geometry.normal,
                    i,
                );
            }
        }
    }

    /// The derivatives of the position with respect to the uv of a height map.
    #[inline(always)]
    fn uv_derivatives<P: Pack>(&self, token: P::Token, batch: &mut Batch) {
        let Some((map, _)) = self.draw.normal_source.height_map() else {
            return;
        };
        let uvs = &self.draw.mesh.uvs()[map.texture.uv_set];
        for Run { triangle, start, end } in batch.points.runs.iter().copied() {
            let vertices = self.draw.vertices(triangle);
            let uvs = vertices.map(|v| map.texture.transform.apply(uvs[v as usize]));
            let corners = vertices.map(|v| self.draw.positions[v as usize]);
            let zero = (Vec3::default(), Vec3::default());
            let (dp_du, dp_dv) = surface::uv_derivatives(corners, uvs).map_or(zero, |d| (d.dp_du, d.dp_dv));
            for i in (start..end).step_by(P::LANES) {
                store3::<P>(splat3(token, dp_du), &mut batch.geometry.dp_du, i);
                store3::<P>(splat3(token, dp_dv), &mut batch.geometry.dp_dv, i);
            }
        }
    }

    #[inline(always)]
    fn tangents<P: Pack>(&self, token: P::Token, batch: &mut Batch) {
        for run in batch.points.runs.iter().copied() {
            let mut corners = self.draw.vertices(run.triangle).map(|v| self.draw.tangents[v as usize]);
            // The first corner's handedness applies to the whole triangle.
            let [[_, _, _, handedness], ..] = corners;
            for corner in &mut corners {
                corner[3] = handedness;
            }
            batch.points.corners.write_differences::<P, 4>(token, run, corners);
        }
        for i in batch.packs::<P>() {
            store3(
                batch.points.corners.at3::<P>(token, &batch.points.weights, i),
                &mut batch.geometry.tangent,
                i,
            );
            batch.points.corners.written::<P>(token, 0, 3, i).store(&mut batch.geometry.handedness[i..]);
        }
    }

    #[inline(always)]
    fn uvs<P: Pack>(&self, token: P::Token, batch: &mut Batch) {
        let Batch { len, points: Points { runs, corners, weights, d_x, d_y, uv_sets, .. }, .. } = batch;
        for (set, uvs) in uv_sets.iter_mut().zip(self.draw.mesh.uvs()) {
            for run in runs.iter().copied() {
                let numbers =
                    self.draw.vertices(run.triangle).map(|v| [uvs[v as usize].x, uvs[v as usize].y]);
                corners.write_differences::<P, 2>(token, run, numbers);
            }
            for i in (0..*len).step_by(P::LANES) {
                for axis in 0..2 {
                    corners.at::<P>(token, weights, axis, i).store(&mut set.uv[axis][i..]);
                    corners.change::<P>(token, d_x, axis, i).store(&mut set.d_x[axis][i..]);
                    corners.change::<P>(token, d_y, axis, i).store(&mut set.d_y[axis][i..]);
                }
            }
        }
    }

    #[inline(always)]
    fn colors<P: Pack>(&self, token: P::Token, batch: &mut Batch) {
        for run in batch.points.runs.iter().copied() {
            let corners = self.draw.vertices(run.triangle).map(|v| self.draw.mesh.colors()[v as usize]);
            batch.points.corners.write_differences::<P, 4>(token, run, corners);
        }
        for i in batch.packs::<P>() {
            for channel in 0..4 {
                let at = batch.points.corners.at::<P>(token, &batch.points.weights, channel, i);
                at.store(&mut batch.points.color[channel][i..]);
            }
        }
    }
}
