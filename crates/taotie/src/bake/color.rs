//! What colour a heavy surface has where.

use super::scan::blend;
use crate::image::Texture;
use crate::math::{Vec2, Vec3};
use crate::mesh::Mesh;
use crate::scene::{Instance, Material, SceneData};

/// The base colours of a scene whose meshes are one: material, texture and vertices.
pub(super) struct Colors {
    /// The first triangle of each instance, and its material.
    parts: Vec<(u32, usize)>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
}

impl Colors {
    /// Of instances whose triangles were joined in order. What is left of their meshes is dropped.
    pub fn new(scene: SceneData, instances: &[Instance]) -> Self {
        let mut first = 0;
        let mut parts = Vec::with_capacity(instances.len());
        for instance in instances {
            parts.push((first, instance.material));
            first += scene.meshes[instance.mesh].triangles().len() as u32;
        }
        Self { parts, materials: scene.materials, textures: scene.textures }
    }

    /// The linear RGB of a point of a triangle; the texture at its finest level, uv set 0.
    pub fn at(&self, mesh: &Mesh, triangle: u32, weights: [f32; 3]) -> [f32; 3] {
        let part = self.parts.partition_point(|(first, _)| *first <= triangle);
        let material = &self.materials[self.parts[part - 1].1];
        let [r, g, b, _] = material.base_color;
        let mut color = Vec3::new(r, g, b);
        let corners = mesh.triangles()[triangle as usize].map(|v| v as usize);
        if !mesh.colors().is_empty() {
            let of = |v: usize| Vec3::new(mesh.colors()[v][0], mesh.colors()[v][1], mesh.colors()[v][2]);
            color = color.mul_elements(blend(corners.map(of), weights));
        }
        if let (Some(texture), Some(uvs)) = (&material.base_color_texture, mesh.uvs().first()) {
            let [a, b, c] = corners.map(|v| uvs[v]);
            let uv = a * weights[0] + b * weights[1] + c * weights[2];
            let uv = texture.transform.apply(Vec2::new(uv.x, uv.y));
            let [r, g, b, _] = texture.sampler.sample(&self.textures[texture.texture], uv, 0.0);
            color = color.mul_elements(Vec3::new(r, g, b));
        }
        color.to_array()
    }
}
