//! The colour of a high-poly surface at a point.

use crate::image::Texture;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::scene::{Instance, Material, SceneData};

/// The base colours of a scene whose meshes are one: material, texture and vertices.
pub(super) struct Colors {
    /// The first triangle of each instance, and its material.
    parts: Vec<(u32, usize)>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
}

impl Colors {
    /// Takes the colours of instances whose triangles were joined in order. The rest of their meshes is dropped.
    pub fn new(scene: SceneData, instances: &[Instance]) -> Self {
        let mut first = 0;
        let mut parts = Vec::with_capacity(instances.len());
        for instance in instances {
            parts.push((first, instance.material));
            first += scene.meshes[instance.mesh].triangles().len() as u32;
        }
        Self { parts, materials: scene.materials, textures: scene.textures }
    }

    /// Returns the linear RGB at a point; the texture at its finest level, uv set 0.
    pub fn at(&self, mesh: &Mesh, point: Point) -> [f32; 3] {
        let part = self.parts.partition_point(|(first, _)| *first <= point.triangle);
        let material = &self.materials[self.parts[part - 1].1];
        let [r, g, b, _] = material.base_color;
        let mut color = Vec3::new(r, g, b);
        if !mesh.colors().is_empty() {
            color = color.mul_elements(point.color(mesh));
        }
        if let (Some(texture), Some(_)) = (&material.base_color_texture, mesh.uvs().first()) {
            let uv = texture.transform.apply(point.uv(mesh, 0));
            let [r, g, b, _] = texture.sampler.sample(&self.textures[texture.texture], uv, 0.0);
            color = color.mul_elements(Vec3::new(r, g, b));
        }
        color.to_array()
    }
}
