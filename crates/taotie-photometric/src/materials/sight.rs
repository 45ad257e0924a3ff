//! Which texels a photograph shows, lit: by rays towards the camera and the light, from the texel's centre and around it.

use super::frame::{Frame, LampPlace, Projected, Projection};
use super::model::{Model, Texel};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::shade::SubPixelVariance;

/// The least n · v and n · l: below, the surface is seen or lit at a grazing angle, and errors of its normal matter.
const GRAZING: f64 = 0.2;
/// Pixels around a texel that must show the same surface, so that no border mixes into it.
const BORDER: f64 = 1.0;
/// The least cosine between the normals of the texel and of the surface around it.
const EDGE: f64 = 0.9;
/// The corners of a texel's surroundings.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];

/// A photograph's camera, ready to see texels.
pub struct Sight<'a> {
    model: &'a Model,
    frame: &'a Frame,
    projection: Projection,
    view_from_world: Mat4,
}

/// A texel as a photograph shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Its centre in the image.
    pub projected: Projected,
    /// Half the side of the square of pixels that show it.
    pub reach: f64,
}

/// The geometry of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incident {
    /// Unit vector towards the camera.
    pub v: Vec3<f64>,
    /// Unit vector towards the light.
    pub l: Vec3<f64>,
    /// Irradiance on a surface that faces it, linear RGB.
    pub irradiance: Vec3<f64>,
    /// The variance of the normals that a sample is averaged over: within the texel's normal map, and to the texels around.
    pub variance: SubPixelVariance<f64>,
}

/// The variance of the places that a sample is averaged over, in each direction, relative to the square of its pixel, or of its
/// texel if that is larger: a box, and twice that for interpolation between pixels.
const SPREAD: f64 = 0.25;

impl Frame {
    /// Returns the directions and light of a texel's sample, whose width is `footprint` texels.
    pub fn incident(&self, texel: &Texel, footprint: f64) -> Incident {
        let v = (self.world_from_view.axis(3) - texel.position).normalize_or(texel.facet);
        let (to, irradiance) = self.lamp.seen_from(texel.position);
        let across = texel.bend * footprint;
        let variance =
            SubPixelVariance { curvature: 2.0 * SPREAD * across * across, normal_variance: texel.variance };
        Incident { v, l: to.normalize_or(texel.facet), irradiance, variance }
    }
}

impl<'a> Sight<'a> {
    /// Prepares the camera of a photograph of this size.
    pub fn new(model: &'a Model, frame: &'a Frame, size: [u32; 2]) -> Self {
        let view_from_world = frame.world_from_view.inverse_affine().unwrap_or(Mat4::IDENTITY);
        Self { model, frame, projection: frame.lens.projection(size), view_from_world }
    }

    /// Returns the texel's place if it is in the picture and faces the camera, whether hidden or not.
    pub fn facing(&self, texel: &Texel) -> Option<Projected> {
        let projected = self.projection.project(self.view_from_world.transform_point(texel.position))?;
        (texel.facet.dot(self.frame.incident(texel, 1.0).v) > GRAZING).then_some(projected)
    }

    /// Returns the texel as the photograph shows it; `None` if it, or anything around it, is hidden or in shadow, or it is
    /// seen or lit at a grazing angle.
    pub fn of(&self, texel: &Texel) -> Option<Seen> {
        let projected = self.projection.project(self.view_from_world.transform_point(texel.position))?;
        let Incident { v, l, .. } = self.frame.incident(texel, 1.0);
        let is_grazing = |n: Vec3<f64>| n.dot(v) < GRAZING || n.dot(l) < GRAZING;
        if [texel.facet, texel.smooth, texel.normal].into_iter().any(is_grazing) {
            return None;
        }
        let reach = (0.5 * texel.width / projected.pixel).max(0.5) + BORDER;
        if self.projection.margin(projected.place) < reach {
            return None;
        }
        let eye = self.frame.world_from_view.axis(3);
        let from = self.model.lifted(texel.position, texel.facet);
        if self.model.hides(from, eye - from, 1.0) || self.is_shadowed(from) {
            return None;
        }
        let seen = Seen { projected, reach };
        CORNERS.iter().all(|corner| self.continues(texel, &seen, *corner)).then_some(seen)
    }

    /// Returns true if the surface that a corner of the texel's surroundings shows is the texel's, of the same material, and lit.
    fn continues(&self, texel: &Texel, seen: &Seen, corner: [f64; 2]) -> bool {
        let Seen { projected, reach } = *seen;
        let eye = self.frame.world_from_view.axis(3);
        let place = [0, 1].map(|axis| projected.place[axis] + corner[axis] * reach);
        let along = self.frame.world_from_view.transform_vector(self.projection.direction(place));
        let Some(hit) = self.model.first(eye, along) else { return false };
        let point = hit.point();
        let position = self.model.position(point);
        let off = (position - texel.position).dot(texel.facet).abs();
        let material = |triangle: u32| self.model.surface.material_number(triangle);
        off < 2.0 * reach * projected.pixel
            && material(hit.triangle) == material(texel.triangle)
            && self.model.smooth(point).dot(texel.smooth) > EDGE
            && !self.is_shadowed(self.model.lifted(position, self.model.facet(point.triangle)))
    }

    fn is_shadowed(&self, from: Vec3<f64>) -> bool {
        let (to, _) = self.frame.lamp.seen_from(from);
        let limit = match self.frame.lamp.place {
            LampPlace::Towards(_) => f32::INFINITY,
            LampPlace::At(_) => 1.0,
        };
        self.model.hides(from, to, limit)
    }
}
