//! A model whose shape is known: its surface, and rays against it.

use taotie_engine::bake::TexturedMesh;
use taotie_engine::error::{Error, Result};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Point;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::trace::{Bvh, Hit, Ray};

/// The height above the surface at which rays start, as a fraction of the model's size: that of the renderer's shadow rays.
const OFFSET: f64 = 1e-5;

/// A model in world space.
pub struct Model {
    /// The scene that was read.
    pub scene: Scene,
    /// All its triangles with their materials.
    pub surface: TexturedMesh,
    bvh: Bvh,
    offset: f64,
}

impl Model {
    /// Takes over a scene.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it has no triangles, [`Error::Limit`] beyond 2^32 − 1 vertices.
    pub fn new(scene: Scene) -> Result<Self> {
        let surface = TexturedMesh::new(scene.clone())?;
        let mesh = surface.mesh();
        if mesh.triangles().is_empty() {
            return Err(Error::invalid("the model", "it has no triangles"));
        }
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.corners(t));
        let offset = OFFSET * mesh.diagonal();
        Ok(Self { scene, surface, bvh, offset })
    }

    /// Rejects a model whose materials cannot be measured.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it has no texture coordinates.
    pub fn check_maps(&self) -> Result<()> {
        match self.surface.map_places().is_empty() {
            true => {
                let why = "it has no texture coordinates, which lay out the maps; unwrap it first, e.g. with `taotie bake`";
                Err(Error::invalid("the model", why))
            }
            false => Ok(()),
        }
    }

    /// Returns the indices of the materials that triangles have, in order.
    pub fn materials(&self) -> Vec<usize> {
        let count = self.scene.materials().len();
        let mut is_used = vec![false; count];
        self.scene.instances().iter().for_each(|instance| is_used[instance.material] = true);
        (0..count).filter(|i| is_used[*i]).collect()
    }

    /// Returns a material.
    pub fn material(&self, index: usize) -> &Material {
        &self.scene.materials()[index]
    }

    /// Returns the unit normal of a triangle, on the side from which it is counter-clockwise; zero if it has no area.
    pub fn facet(&self, triangle: u32) -> Vec3<f64> {
        let [a, b, c] = self.surface.mesh().corners(triangle as usize).map(Vec3::to_f64);
        (b - a).cross(c - a).normalize_or(Vec3::splat(0.0))
    }

    /// Returns a point moved off the surface along a unit normal, where rays start.
    pub fn lifted(&self, position: Vec3<f64>, facet: Vec3<f64>) -> Vec3<f64> {
        position + facet * self.offset
    }

    /// Returns true if the surface hides a lifted point from `to`: `limit` is 1 for a position `to` away, infinite for a
    /// direction.
    pub fn hides(&self, from: Vec3<f64>, to: Vec3<f64>, limit: f32) -> bool {
        let ray = Ray::new(from.to_f32(), to.to_f32());
        self.bvh.occluded(&ray, limit, |hit| self.surface.is_solid_at(hit.point()))
    }

    /// Returns the first triangle that a ray from `eye` meets.
    pub fn first(&self, eye: Vec3<f64>, along: Vec3<f64>) -> Option<Hit> {
        self.bvh.nearest(&Ray::new(eye.to_f32(), along.to_f32()), f32::INFINITY)
    }

    /// Returns the interpolated unit normal at a point.
    pub fn smooth(&self, point: Point) -> Vec3<f64> {
        point.normal(self.surface.mesh()).to_f64().normalize_or(Vec3::splat(0.0))
    }

    /// Returns the position of a point.
    pub fn position(&self, point: Point) -> Vec3<f64> {
        point.position(self.surface.mesh()).to_f64()
    }
}

/// A texel whose centre a triangle covers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Texel {
    /// Its number, row by row from the top.
    pub index: u32,
    /// The triangle that covers its centre.
    pub triangle: u32,
    /// World space.
    pub position: Vec3<f64>,
    /// Unit normal of the triangle.
    pub facet: Vec3<f64>,
    /// Unit normal, interpolated between vertices.
    pub smooth: Vec3<f64>,
    /// Unit normal as a renderer shades it: with the normal map.
    pub normal: Vec3<f64>,
    /// The variance of the normal map's vectors within the texel, [0, 1].
    pub variance: f64,
    /// The angle by which the normal differs from those of the texels around, root mean square, radians.
    pub bend: f64,
    /// The side of the texel on the surface, model units.
    pub width: f64,
    /// The model's metallic there.
    pub metallic: f64,
    /// The model's alpha there; 1 if it is opaque.
    pub alpha: f64,
}
