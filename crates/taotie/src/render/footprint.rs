//! A single point of a triangle, for rays that need the opacity of a surface.

use super::draw::Draw;
use crate::math::Vec2;
use crate::scene::Scene;
use crate::trace::Hit;

/// A point of a triangle by its corners' barycentric weights.
pub(super) struct Footprint {
    vertices: [u32; 3],
    weights: [f32; 3],
}

/// The log2 of texels per pixel for a point without extent: it is looked up in the finest level.
const POINT: f32 = -50.0;

impl Footprint {
    /// The point where a ray hit a triangle of `draw`, given by its index over all draws.
    pub(super) fn of(draw: &Draw<'_>, hit: &Hit) -> Self {
        Self { vertices: draw.vertices(hit.triangle), weights: hit.weights }
    }

    /// Opacity: factor, texture and vertex colour.
    pub(super) fn alpha(&self, scene: &Scene, draw: &Draw<'_>) -> f32 {
        let mut alpha = draw.material.base_color[3];
        if let Some(texture) = &draw.material.base_color_texture {
            let uvs = draw.mesh.uvs().get(texture.uv_set);
            let uv = uvs.map_or(Vec2::default(), |uvs| {
                let [a, b, c] = self.vertices.map(|v| uvs[v as usize]);
                a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
            });
            let uv = texture.transform.apply(uv);
            alpha *= texture.sampler.sample(&scene.textures()[texture.texture], uv, POINT)[3];
        }
        if !draw.mesh.colors().is_empty() {
            let [a, b, c] = self.vertices.map(|v| draw.mesh.colors()[v as usize][3]);
            alpha *= a * self.weights[0] + b * self.weights[1] + c * self.weights[2];
        }
        alpha
    }
}
