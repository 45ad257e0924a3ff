//! Vertices to fragments: what corners hold, at points of their triangles.

use super::batch::{Batch, Column3, Run, UvSet, load, splat3, store3};
use super::prepare::{Draw, NormalSource};
use super::view::Eye;
use crate::math::{Column, Pack, Vec3, dispatch_pack};
use crate::raster::{PerspectiveTriangle, Viewport};
use crate::scene::Scene;
use crate::shade::bend;
use crate::surface;
use fearless_simd::Level;

/// Makes fragments of points on one draw's triangles.
pub(super) struct Interpolation<'p, 'a> {
    pub level: Level,
    pub scene: &'p Scene,
    pub draw: &'p Draw<'a>,
    /// Whether what is too fine for the pixel widens highlights.
    pub specular_aa: bool,
    /// Whether anything depends on the roughness.
    pub takes_roughness: bool,
}

/// Where the rasteriser's fragments lie.
pub(super) struct Screen<'p> {
    pub viewport: &'p Viewport,
    /// The draw's vertices in clip space.
    pub clip: &'p [[f32; 4]],
    /// What `batch.place` counts from, pixels from the picture's top left corner.
    pub origin: [f64; 2],
}

/// What a triangle's corners hold, as the first corner's and how far the others are from it: two weights do, and what
/// is the same at all corners stays as it is.
struct Corners<T> {
    first: T,
    to_second: T,
    to_third: T,
}

impl Corners<Vec3> {
    fn new(values: &[Vec3], vertices: [u32; 3]) -> Self {
        let [a, b, c] = vertices.map(|v| values[v as usize]);
        Self { first: a, to_second: b - a, to_third: c - a }
    }

    #[inline(always)]
    fn at<P: Pack>(&self, token: P::Token, [_, second, third]: [P; 3]) -> Vec3<P> {
        splat3(token, self.first)
            + splat3::<P>(token, self.to_second) * second
            + splat3::<P>(token, self.to_third) * third
    }

    /// The change where the weights change so.
    #[inline(always)]
    fn change<P: Pack>(&self, token: P::Token, [_, second, third]: [P; 3]) -> Vec3<P> {
        splat3::<P>(token, self.to_second) * second + splat3::<P>(token, self.to_third) * third
    }
}

impl Corners<f32> {
    fn new([a, b, c]: [f32; 3]) -> Self {
        Self { first: a, to_second: b - a, to_third: c - a }
    }

    #[inline(always)]
    fn at<P: Pack>(&self, token: P::Token, weights: [P; 3]) -> P {
        P::splat(token, self.first) + self.change(token, weights)
    }

    #[inline(always)]
    fn change<P: Pack>(&self, token: P::Token, [_, second, third]: [P; 3]) -> P {
        P::splat(token, self.to_second) * second + P::splat(token, self.to_third) * third
    }
}

impl Interpolation<'_, '_> {
    /// Fills the weights of fragments from their places on the screen.
    pub(super) fn weigh(&self, screen: &Screen<'_>, batch: &mut Batch) {
        dispatch_pack!(self.level, P, token => self.weigh_packs::<P>(token, screen, batch));
    }

    /// Fills what follows from the corners and the weights. `eye` is where they are seen from; without one `batch.v`
    /// must be filled.
    pub(super) fn interpolate(&self, eye: Option<Eye>, batch: &mut Batch) {
        let sets = self.draw.mesh.uvs().len();
        batch.uv_sets.resize_with(sets, UvSet::default);
        dispatch_pack!(self.level, P, token => self.interpolate_packs::<P>(token, eye, batch));
    }

    /// The corners of a triangle, whose number counts over all draws.
    fn vertices(&self, triangle: u32) -> [u32; 3] {
        self.draw.mesh.triangles()[(triangle - self.draw.first_triangle) as usize]
    }

    #[inline(always)]
    fn weigh_packs<P: Pack>(&self, token: P::Token, screen: &Screen<'_>, batch: &mut Batch) {
        let spacing = P::splat(token, screen.viewport.pattern.spacing());
        for Run { triangle, start, end } in batch.runs.iter().copied() {
            let corners = self.vertices(triangle).map(|v| screen.clip[v as usize]);
            let triangle = PerspectiveTriangle::new(corners, screen.viewport, screen.origin);
            for i in (start..end).step_by(P::LANES) {
                let [x, y] = [P::load(token, &batch.place[0][i..]), P::load(token, &batch.place[1][i..])];
                let bary = triangle.at(x, y);
                for corner in 0..3 {
                    bary.weights[corner].store(&mut batch.weights[corner][i..]);
                    (bary.d_x[corner] * spacing).store(&mut batch.d_x[corner][i..]);
                    (bary.d_y[corner] * spacing).store(&mut batch.d_y[corner][i..]);
                }
            }
        }
    }

    #[inline(always)]
    fn interpolate_packs<P: Pack>(&self, token: P::Token, eye: Option<Eye>, batch: &mut Batch) {
        for run in 0..batch.runs.len() {
            let run = batch.runs[run];
            let vertices = self.vertices(run.triangle);
            self.geometry::<P>(token, eye, (run, vertices), batch);
            self.normals::<P>(token, (run, vertices), batch);
            self.uvs::<P>(token, (run, vertices), batch);
            if !self.draw.mesh.colors().is_empty() {
                self.colors::<P>(token, (run, vertices), batch);
            }
        }
    }

    /// Position, sight and side.
    #[inline(always)]
    fn geometry<P: Pack>(
        &self,
        token: P::Token,
        eye: Option<Eye>,
        (run, vertices): (Run, [u32; 3]),
        batch: &mut Batch,
    ) {
        let positions = Corners::<Vec3>::new(&self.draw.positions, vertices);
        let sign = if self.draw.mirrored { -1.0 } else { 1.0 };
        let front = positions.to_second.cross(positions.to_third);
        let front = front.normalize_or(Vec3::new(0.0, 0.0, 1.0)) * sign;
        let n_front: Vec3<P> = splat3(token, front);
        let (zero, one) = (P::splat(token, 0.0), P::splat(token, 1.0));
        for i in (run.start..run.end).step_by(P::LANES) {
            let position = positions.at::<P>(token, weights(token, &batch.weights, i));
            let v = match eye {
                Some(Eye::Point(eye)) => (splat3(token, eye) - position).normalize_or(n_front),
                Some(Eye::Direction(direction)) => splat3(token, direction),
                None => Vec3::new(
                    load(token, &batch.v[0], i),
                    load(token, &batch.v[1], i),
                    load(token, &batch.v[2], i),
                ),
            };
            let facing = P::select(n_front.dot(v).lt(zero), -one, one);
            store3(position, &mut batch.position, i);
            if eye.is_some() {
                store3(v, &mut batch.v, i);
            }
            store3(n_front * facing, &mut batch.n_geom, i);
            facing.store(&mut batch.facing[i..]);
        }
    }

    /// Normal, tangent, and how much the surface bends.
    #[inline(always)]
    fn normals<P: Pack>(&self, token: P::Token, (run, vertices): (Run, [u32; 3]), batch: &mut Batch) {
        let draw = self.draw;
        let normals = match draw.normal_source {
            NormalSource::BumpPrinted(..) => Corners::<Vec3>::new(draw.mesh.normals(), vertices),
            _ => Corners::<Vec3>::new(&draw.normals, vertices),
        };
        let bends = self.specular_aa && !matches!(draw.normal_source, NormalSource::Facet);
        let smooth = Corners::<Vec3>::new(&draw.normals, vertices);
        for i in (run.start..run.end).step_by(P::LANES) {
            store3(normals.at::<P>(token, weights(token, &batch.weights, i)), &mut batch.normal, i);
            let mut bent = P::splat(token, 0.0);
            if bends {
                let d_x = smooth.change::<P>(token, weights(token, &batch.d_x, i));
                let d_y = smooth.change::<P>(token, weights(token, &batch.d_y, i));
                bent = bend(d_x, d_y);
            }
            bent.store(&mut batch.bend[i..]);
        }
        if !draw.tangents.is_empty() {
            self.tangents::<P>(token, (run, vertices), batch);
        }
        if let NormalSource::Bump(map, _) | NormalSource::BumpPrinted(map, _) = draw.normal_source {
            let uvs = &draw.mesh.uvs()[map.texture.uv_set];
            let uvs = vertices.map(|v| map.texture.transform.apply(uvs[v as usize]));
            let corners = vertices.map(|v| draw.positions[v as usize]);
            let zero = (Vec3::default(), Vec3::default());
            let (dp_du, dp_dv) = surface::uv_derivatives(corners, uvs).map_or(zero, |d| (d.dp_du, d.dp_dv));
            for i in (run.start..run.end).step_by(P::LANES) {
                store3::<P>(splat3(token, dp_du), &mut batch.dp_du, i);
                store3::<P>(splat3(token, dp_dv), &mut batch.dp_dv, i);
            }
        }
    }

    #[inline(always)]
    fn tangents<P: Pack>(&self, token: P::Token, (run, vertices): (Run, [u32; 3]), batch: &mut Batch) {
        let corners = vertices.map(|v| self.draw.tangents[v as usize]);
        let [[_, _, _, handedness], ..] = corners;
        let [a, b, c] = corners.map(|[x, y, z, _]| Vec3::new(x, y, z));
        let tangents = Corners { first: a, to_second: b - a, to_third: c - a };
        let handedness = P::splat(token, handedness);
        for i in (run.start..run.end).step_by(P::LANES) {
            store3(tangents.at::<P>(token, weights(token, &batch.weights, i)), &mut batch.tangent, i);
            handedness.store(&mut batch.handedness[i..]);
        }
    }

    #[inline(always)]
    fn uvs<P: Pack>(&self, token: P::Token, (run, vertices): (Run, [u32; 3]), batch: &mut Batch) {
        for (set, uvs) in batch.uv_sets.iter_mut().zip(self.draw.mesh.uvs()) {
            let [a, b, c] = vertices.map(|v| uvs[v as usize]);
            let axes = [Corners::<f32>::new([a.x, b.x, c.x]), Corners::<f32>::new([a.y, b.y, c.y])];
            for i in (run.start..run.end).step_by(P::LANES) {
                for (axis, corners) in axes.iter().enumerate() {
                    let at = corners.at::<P>(token, weights(token, &batch.weights, i));
                    at.store(&mut set.uv[axis][i..]);
                    let d_x = corners.change::<P>(token, weights(token, &batch.d_x, i));
                    d_x.store(&mut set.d_x[axis][i..]);
                    let d_y = corners.change::<P>(token, weights(token, &batch.d_y, i));
                    d_y.store(&mut set.d_y[axis][i..]);
                }
            }
        }
    }

    #[inline(always)]
    fn colors<P: Pack>(&self, token: P::Token, (run, vertices): (Run, [u32; 3]), batch: &mut Batch) {
        let [a, b, c] = vertices.map(|v| self.draw.mesh.colors()[v as usize]);
        for channel in 0..4 {
            let corners = Corners::<f32>::new([a[channel], b[channel], c[channel]]);
            for i in (run.start..run.end).step_by(P::LANES) {
                let at = corners.at::<P>(token, weights(token, &batch.weights, i));
                at.store(&mut batch.color[channel][i..]);
            }
        }
    }
}

#[inline(always)]
fn weights<P: Pack>(token: P::Token, columns: &Column3, i: usize) -> [P; 3] {
    let [a, b, c]: &[Column; 3] = columns;
    [load(token, a, i), load(token, b, i), load(token, c, i)]
}
