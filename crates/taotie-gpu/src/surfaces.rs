//! Surfaces ready to draw: their vertices and triangles, and the factors and textures of their materials.

use crate::gpu::{Gpu, Result};
use crate::pipelines::SurfacePipeline;
use crate::textures::{Samplers, Textures};
use std::collections::HashMap;
use std::sync::Arc;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::render::Surface;
use taotie_engine::scene::TextureRole;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{SurfaceFactors, TextureSlot, VertexInput};
use wgpu::{BindGroup, BindGroupEntry, BindingResource, Buffer, BufferUsages, RenderPass, TextureView};

/// A surface ready to draw: its shader and all inputs of it.
pub(crate) struct SurfaceDraw {
    pub pipeline: Arc<SurfacePipeline>,
    pub material: BindGroup,
    /// The vertex attributes, in the order of the shader's inputs.
    pub vertices: Vec<Buffer>,
    pub triangles: Buffer,
    /// The number of indices.
    pub count: u32,
    /// `true` if it is blended.
    pub blended: bool,
}

impl SurfaceDraw {
    /// Binds everything except the triangles.
    pub(crate) fn bind(&self, pass: &mut RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline.pipeline);
        pass.set_bind_group(1, &self.material, &[]);
        for (slot, buffer) in self.vertices.iter().enumerate() {
            pass.set_vertex_buffer(slot as u32, buffer.slice(..));
        }
    }
}

/// The textures that a surface's shader reads.
struct BoundTexture {
    binding: u32,
    view: TextureView,
    /// The sampler and its binding.
    sampler: Option<(u32, wgpu::Sampler)>,
}

/// The textures of a scene, and their samplers.
pub(crate) struct MaterialTextures {
    pub textures: Textures,
    pub samplers: Samplers,
}

impl MaterialTextures {
    /// Binds the factors and textures of a surface.
    ///
    /// # Errors
    /// If the driver rejects them or memory runs out.
    pub(crate) fn bind(
        &mut self,
        gpu: &Gpu,
        pipeline: &SurfacePipeline,
        factors: &SurfaceFactors<'_>,
    ) -> Result<BindGroup> {
        let bytes = pipeline.interface.material_bytes(factors);
        let uniforms = gpu.buffer("the factors of a material", &bytes, BufferUsages::UNIFORM)?;
        let slots = pipeline.interface.textures.iter();
        let bound: Vec<_> = slots.filter_map(|slot| self.texture(gpu, slot, factors)).collect();
        let mut entries = vec![BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }];
        entries.extend(bound.iter().flat_map(BoundTexture::entries));
        bind(gpu, pipeline, &entries)
    }

    /// The texture of a slot; `None` if the slot belongs to the frame.
    fn texture(
        &mut self,
        gpu: &Gpu,
        slot: &TextureSlot,
        factors: &SurfaceFactors<'_>,
    ) -> Option<BoundTexture> {
        let used = TextureRole::named(slot.name)?.of(factors.material)?;
        let view = self.textures.view(used.texture)?.clone();
        let sampler = slot.sampler.map(|binding| (binding, self.samplers.get(gpu, &used.sampler)));
        Some(BoundTexture { binding: slot.binding, view, sampler })
    }
}

impl BoundTexture {
    fn entries(&self) -> impl Iterator<Item = BindGroupEntry<'_>> {
        let view = (self.binding, BindingResource::TextureView(&self.view));
        let sampler = self.sampler.as_ref();
        let sampler = sampler.map(|(binding, sampler)| (*binding, BindingResource::Sampler(sampler)));
        let both = std::iter::once(view).chain(sampler);
        both.map(|(binding, resource)| BindGroupEntry { binding, resource })
    }
}

fn bind(gpu: &Gpu, pipeline: &SurfacePipeline, entries: &[BindGroupEntry<'_>]) -> Result<BindGroup> {
    gpu.checked("a material", || {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("material"),
            layout: &pipeline.material,
            entries,
        })
    })
}

/// A surface with its index in the scene.
#[derive(Clone, Copy)]
pub(crate) struct Numbered<'s> {
    /// The index, which is that of its instance.
    pub number: usize,
    /// The surface.
    pub surface: &'s Surface<'s>,
}

/// The vertices and triangles of surfaces, each uploaded when it is first drawn.
#[derive(Default)]
pub(crate) struct Meshes {
    /// Vertex attributes, by the surface's index and their name.
    vertices: HashMap<(usize, String), Buffer>,
    /// Triangles, by the surface's index.
    triangles: HashMap<usize, Buffer>,
}

impl Meshes {
    /// The vertex attribute of a surface that is an input of a shader.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`], or if memory runs out.
    pub(crate) fn vertices(
        &mut self,
        gpu: &Gpu,
        Numbered { number, surface }: Numbered<'_>,
        input: &VertexInput,
    ) -> Result<Buffer> {
        let key = (number, input.name.clone());
        if let Some(buffer) = self.vertices.get(&key) {
            return Ok(buffer.clone());
        }
        let what = format!("the {} of the vertices of instance {number}", input.name);
        let numbers = values(surface, &input.name, input.kind.numbers());
        let buffer = gpu.buffer(&what, bytemuck::cast_slice(&numbers), BufferUsages::VERTEX)?;
        self.vertices.insert(key, buffer.clone());
        Ok(buffer)
    }

    /// A surface's triangles.
    ///
    /// # Errors
    /// As [`Self::vertices`].
    pub(crate) fn triangles(
        &mut self,
        gpu: &Gpu,
        Numbered { number, surface }: Numbered<'_>,
    ) -> Result<Buffer> {
        if let Some(buffer) = self.triangles.get(&number) {
            return Ok(buffer.clone());
        }
        let bytes = bytemuck::cast_slice(surface.triangles);
        let buffer =
            gpu.buffer(&format!("the triangles of instance {number}"), bytes, BufferUsages::INDEX)?;
        self.triangles.insert(number, buffer.clone());
        Ok(buffer)
    }
}

/// The values of the attribute with this name, `numbers` per vertex; 0 if the mesh lacks it.
fn values(surface: &Surface<'_>, name: &str, numbers: usize) -> Vec<f32> {
    let count = surface.positions.len();
    let vectors = |vectors: &[Vec3]| vectors.iter().flat_map(|v| v.to_array()).collect();
    let uvs = |set: usize| {
        let uvs: Option<&Vec<Vec2>> = surface.uvs.get(set);
        uvs.map_or(Vec::new(), |uvs| uvs.iter().flat_map(|uv| [uv.x, uv.y]).collect())
    };
    let mut values: Vec<f32> = match name {
        "position" => vectors(surface.positions),
        "normal" => match surface.normal_source.method() {
            SurfaceMethod::BumpPrinted => vectors(surface.object_normals),
            _ => vectors(surface.normals),
        },
        "tangent" => surface.tangents.as_flattened().to_vec(),
        "color" => surface.colors.as_flattened().to_vec(),
        _ => name.strip_prefix("uv").and_then(|set| set.parse().ok()).map_or(Vec::new(), uvs),
    };
    values.resize(count * numbers, 0.0);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::{Prepared, SurfaceSettings};
    use taotie_engine::scene::{Material, Scene};

    #[test]
    fn every_vertex_has_all_its_numbers() {
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        let prepared = Prepared::new(scene, &SurfaceSettings::default()).unwrap();
        let surface = &prepared.surfaces()[0];
        let count = surface.positions.len();
        for (name, numbers) in [("position", 3), ("normal", 3), ("tangent", 4), ("uv0", 2), ("uv1", 2)] {
            assert_eq!(values(surface, name, numbers).len(), count * numbers, "{name}");
        }
        let p = surface.positions[1];
        assert_eq!(values(surface, "position", 3)[3..6], p.to_array());
        assert!(values(surface, "uv7", 2).iter().all(|v| *v == 0.0));
    }
}
