//! All triangles of a scene, sorted for rays: the opacity of a surface where a ray hits it, the surfaces that cast
//! shadows, and the shadow rays of fragments.

use super::batch::{BATCH, Batch, get3};
use super::draw::{Draw, Draws};
use crate::math::{Vec2, Vec3};
use crate::pixel::{CLEAR, LightSource, MaterialUniforms, PassedLight};
use crate::scene::{AlphaMode, Scene, TextureRef};
use crate::trace::{Bvh, Hit, Ray};
use fearless_simd::Level;

/// All triangles of a scene, sorted for rays. Hits refer to them by their indices over all draws.
pub(super) struct SceneTree(pub Bvh);

impl SceneTree {
    /// Sorts all triangles for at least `rays` rays, which are traced at a SIMD level.
    pub(super) fn new(draws: &Draws<'_>, rays: u64, level: Level) -> Self {
        /// The number of rays per triangle from which sorting for many rays pays off.
        const MANY: u64 = 8;
        let triangles = |draw: &Draw<'_>| -> Vec<[Vec3; 3]> {
            draw.mesh.triangles().iter().map(|t| t.map(|v| draw.positions[v as usize])).collect()
        };
        let corners: Vec<_> = draws.all.iter().flat_map(triangles).collect();
        let many = rays / MANY > corners.len() as u64;
        let bvh = if many { Bvh::for_many_rays(&corners) } else { Bvh::build(&corners) };
        Self(bvh.at(level))
    }
}

/// The surfaces that cast shadows. Blended ones cast none, and transmitting ones none where half of the light passes.
#[derive(Clone, Copy)]
pub(super) struct Casters<'t> {
    pub tree: &'t SceneTree,
    pub draws: &'t Draws<'t>,
}

impl Casters<'_> {
    /// Returns true if nothing blocks the ray from `origin` along `direction` up to `limit` of its lengths.
    pub(super) fn sees(&self, origin: Vec3, direction: Vec3, limit: f32) -> bool {
        !self.tree.0.occluded(&Ray::new(origin, direction), limit, |hit| self.blocks(hit))
    }

    /// Returns true if the surface exists at the point hit.
    fn blocks(&self, hit: &Hit) -> bool {
        let draw = self.draws.of(hit.triangle);
        let passes = || Footprint::of(draw, hit).passed(self.draws.scene, draw) >= CLEAR;
        match draw.material.alpha {
            _ if draw.material.transmits() && passes() => false,
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => Footprint::of(draw, hit).alpha(self.draws.scene, draw) >= cutoff,
            AlphaMode::Blend => false,
        }
    }
}

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
        Self::at(draw, hit.triangle, hit.weights)
    }

    /// The same for a point given by the weights of the triangle's corners.
    pub(super) fn at(draw: &Draw<'_>, triangle: u32, weights: [f32; 3]) -> Self {
        Self { vertices: draw.vertices(triangle), weights }
    }

    /// Opacity: factor, texture and vertex colour.
    pub(super) fn alpha(&self, scene: &Scene, draw: &Draw<'_>) -> f32 {
        self.color(scene, draw)[3]
    }

    /// The share of light that passes through a thin surface, as [`PassedLight`].
    pub(super) fn passed(&self, scene: &Scene, draw: &Draw<'_>) -> f32 {
        let material = draw.material;
        let Some(transmission) = material.transmission.as_ref().filter(|_| material.transmits()) else {
            return 0.0;
        };
        let texel =
            |texture: &Option<TextureRef>| texture.as_ref().map_or([1.0; 4], |t| self.texel(scene, draw, t));
        let [r, g, b, _] = self.color(scene, draw);
        let passed = PassedLight {
            transmission: transmission.factor * texel(&transmission.texture)[0],
            metallic: material.metallic * texel(&material.metallic_roughness_texture)[2],
            base_color: Vec3::new(r, g, b),
            f0: MaterialUniforms::new(material).dielectric_f0
                * (material.specular.factor * texel(&material.specular.factor_texture)[3]),
        };
        passed.share()
    }

    /// Base colour and alpha: factor, texture and vertex colour.
    fn color(&self, scene: &Scene, draw: &Draw<'_>) -> [f32; 4] {
        let mut color = draw.material.base_color;
        if let Some(texture) = &draw.material.base_color_texture {
            let texel = self.texel(scene, draw, texture);
            color = std::array::from_fn(|c| color[c] * texel[c]);
        }
        if !draw.mesh.colors().is_empty() {
            let [a, b, c] = self.vertices.map(|v| draw.mesh.colors()[v as usize]);
            let [x, y, z] = self.weights;
            color = std::array::from_fn(|i| color[i] * (a[i] * x + b[i] * y + c[i] * z));
        }
        color
    }

    fn texel(&self, scene: &Scene, draw: &Draw<'_>, texture: &TextureRef) -> [f32; 4] {
        let uvs = draw.mesh.uvs().get(texture.uv_set);
        let uv = uvs.map_or(Vec2::default(), |uvs| {
            let [a, b, c] = self.vertices.map(|v| uvs[v as usize]);
            a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
        });
        let uv = texture.transform.apply(uv);
        texture.sampler.sample(&scene.textures()[texture.texture], uv, POINT)
    }
}

/// Fills `batch.lit.visibility`. `origins` are the origins of the rays.
pub(super) fn trace_shadows(
    casters: Casters<'_>,
    sources: &[LightSource<f32>],
    origins: &[Vec3; BATCH],
    batch: &mut Batch,
) {
    for (light, source) in sources.iter().enumerate() {
        for (i, origin) in origins.iter().enumerate().take(batch.len) {
            let to_light = source.ray_from(*origin);
            let faces = get3(&batch.frame.n, i).dot(to_light) > 0.0;
            let seen = faces && casters.sees(*origin, to_light, source.ray_limit());
            batch.lit.visibility[light][i] = f32::from(u8::from(seen));
        }
    }
}

/// A flat triangle of a smooth surface.
pub(super) struct SmoothTriangle {
    pub corners: [Vec3; 3],
    /// The normals at the corners: unit, on the visible side.
    pub normals: [Vec3; 3],
}

impl SmoothTriangle {
    /// The origin of shadow rays: the point of the smooth surface above the triangle's `point`, so that a low-poly
    /// mesh does not shade itself in facets (Hanika 2021, "Hacking the Shadow Terminator"), moved by `offset`, a
    /// small distance along the geometric normal, against rounding errors.
    pub(super) fn shadow_origin(&self, point: Vec3, weights: [f32; 3], offset: Vec3) -> Vec3 {
        let mut shift = Vec3::default();
        for ((corner, normal), weight) in self.corners.into_iter().zip(self.normals).zip(weights) {
            let height = (point - corner).dot(normal).min(0.0);
            shift += normal * (-height * weight);
        }
        // A surface seen from behind bulges away from the viewer: no shift.
        let shift = if shift.dot(offset) > 0.0 { shift } else { Vec3::default() };
        point + shift + offset
    }
}
