//! What is looked at: meshes, materials, textures, instances, lights, cameras, and how they move. Data, and the poses
//! that follow from it.

pub mod animation;
mod camera;
mod light;
mod material;
mod material_textures;
mod presets;

pub use camera::{Camera, Orbit, Projection, fitting_distance, rigid};
pub use light::{Falloff, Light, LightKind, from_view, three_point_rig};
pub use material::{
    AlphaMode, Anisotropy, Classic, Clearcoat, GreenChannel, HeightMap, Material, NormalMap, NormalSpace,
    Sheen, Specular, TextureRef, UvTransform,
};
pub use presets::{PRESETS, Preset, preset};

use crate::image::Texture;
use crate::math::{Mat4, Vec3};
use crate::mesh::Mesh;

/// A scene. Indices in it are in range: the readers and [`Scene::bounds`] rely on that.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// The meshes, object space.
    pub meshes: Vec<Mesh>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The textures that materials name by index.
    pub textures: Vec<Texture>,
    /// What is placed where.
    pub instances: Vec<Instance>,
    /// The lights of the file, world space.
    pub lights: Vec<Light>,
    /// The cameras of the file, world space.
    pub cameras: Vec<Camera>,
}

/// A mesh placed in the world with a material.
#[derive(Debug, Clone, Copy)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Takes object space to world space.
    pub world_from_object: Mat4,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner of least coordinates.
    pub min: Vec3<f64>,
    /// The corner of greatest coordinates.
    pub max: Vec3<f64>,
}

impl Bounds {
    /// The middle.
    pub fn center(&self) -> Vec3<f64> {
        (self.min + self.max) * 0.5
    }

    /// The least box around both.
    pub fn united(&self, other: &Self) -> Self {
        let pick = |a: Vec3<f64>, b: Vec3<f64>, of: fn(f64, f64) -> f64| {
            Vec3::new(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z))
        };
        Self { min: pick(self.min, other.min, f64::min), max: pick(self.max, other.max, f64::max) }
    }

    /// The length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }
}

impl Scene {
    /// The world-space box around every triangle's corners, or `None` where there is no triangle.
    pub fn bounds(&self) -> Option<Bounds> {
        let mut bounds: Option<Bounds> = None;
        for p in self.corners() {
            let point = Bounds { min: p, max: p };
            bounds = Some(bounds.map_or(point, |b| b.united(&point)));
        }
        bounds
    }

    /// Every corner of every triangle, world space, as often as it is used.
    pub fn corners(&self) -> impl Iterator<Item = Vec3<f64>> + '_ {
        self.instances.iter().flat_map(|instance| {
            let mesh = &self.meshes[instance.mesh];
            mesh.triangles().iter().flatten().map(|index| {
                instance.world_from_object.transform_point(mesh.positions()[*index as usize].to_f64())
            })
        })
    }

    /// How many triangles the instances draw.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.meshes[i.mesh].triangles().len()).sum()
    }
}
