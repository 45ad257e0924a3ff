//! The mean of samples, in linear light.

use crate::error::Result;
use crate::gpu::Gpu;
use crate::textures::Texels2d;
use wgpu::{BindGroup, BindingResource, Buffer, BufferUsages, CommandEncoder, RenderPipeline, Texture};
use wgpu::{TextureFormat, TextureUsages, TextureView};

/// The format of sums.
const SUM: TextureFormat = TextureFormat::Rgba32Float;

/// One sample of every pixel of an image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampleNumber {
    /// Its index, from 0.
    pub number: usize,
    /// The number of samples per pixel.
    pub count: usize,
}

/// Two images between which the sum of samples alternates.
pub(crate) struct Average {
    pipeline: RenderPipeline,
    sums: [Texture; 2],
    views: [TextureView; 2],
    /// The inputs for each sum, which read the other image.
    inputs: [BindGroup; 2],
    weight: Buffer,
    /// The index of the current sum.
    latest: usize,
}

impl Average {
    /// Creates sums of the samples in `seen`.
    ///
    /// # Errors
    /// As [`crate::target::Target::new`].
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2], seen: &TextureView) -> Result<Self> {
        let usage =
            TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        let texels = Texels2d { what: "the mean of the samples", size, levels: 1, format: SUM };
        let sums = [texels.create(gpu, usage)?, texels.create(gpu, usage)?];
        let views = sums.each_ref().map(|sum| sum.create_view(&wgpu::TextureViewDescriptor::default()));
        let weight = gpu.buffer("the weight of a sample", &[0; 16], BufferUsages::UNIFORM)?;
        gpu.checked("the mean of the samples", || {
            let pipeline = pipeline(gpu);
            let inputs = views.each_ref().map(|sum| inputs(gpu, &pipeline, [sum, seen], &weight));
            Self { pipeline, sums, views, inputs, weight, latest: 0 }
        })
    }

    /// Adds a sample; the first one resets the sum.
    pub(crate) fn add(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder, sample: SampleNumber) {
        if sample.number == 0 {
            let weight = [1.0 / sample.count as f32, 0.0, 0.0, 0.0];
            gpu.queue.write_buffer(&self.weight, 0, bytemuck::cast_slice(&weight));
            drop(pass(encoder, &self.views[self.latest]));
        }
        let next = 1 - self.latest;
        let mut pass = pass(encoder, &self.views[next]);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.inputs[self.latest], &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.latest = next;
    }

    /// The image of the sum.
    pub(crate) fn mean(&self) -> &Texture {
        &self.sums[self.latest]
    }
}

/// Begins a pass that draws to an empty image.
fn pass<'e>(encoder: &'e mut CommandEncoder, view: &TextureView) -> wgpu::RenderPass<'e> {
    let attachment = wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: cleared(wgpu::Color::TRANSPARENT),
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("mean of samples"),
        color_attachments: &[Some(attachment)],
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Begins with `value` everywhere and keeps the result.
pub(crate) fn cleared<V>(value: V) -> wgpu::Operations<V> {
    wgpu::Operations { load: wgpu::LoadOp::Clear(value), store: wgpu::StoreOp::Store }
}

fn pipeline(gpu: &Gpu) -> RenderPipeline {
    let module = gpu.device.create_shader_module(wgpu::include_wgsl!("average.wgsl"));
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("mean of samples"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex_main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment_main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(SUM.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn inputs(gpu: &Gpu, pipeline: &RenderPipeline, textures: [&TextureView; 2], weight: &Buffer) -> BindGroup {
    let [sum, seen] = textures.map(BindingResource::TextureView);
    let resources = [sum, seen, weight.as_entire_binding()];
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("samples"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}
