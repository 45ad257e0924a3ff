//! A surface ready to draw.

use crate::error::Result;
use crate::gpu::Gpu;
use crate::pipelines::SurfacePipeline;
use crate::samplers::Samplers;
use crate::textures::Textures;
use std::sync::Arc;
use taotie_engine::scene::TextureRole;
use taotie_shader::{SurfaceFactors, TextureSlot};
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
