//! The image that is drawn to, the mean of its samples in linear light, and its readback.

use crate::gpu::{Gpu, Result};
use crate::textures::{Texels2d, extent};
use taotie_engine::image::Image;
use wgpu::{BindGroup, BindingResource, Buffer, BufferUsages, CommandEncoder, RenderPass};
use wgpu::{RenderPipeline, Texture, TextureFormat, TextureUsages, TextureView};

/// The format of depth: reversed, 1 near and 0 far.
pub(crate) const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// The maximum number of bytes read back at a time.
const BAND_BYTES: u64 = 1 << 26;

/// The alignment of rows in a copied texture, in bytes.
const ROW_ALIGNMENT: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// A sample's image, its depth, and the mean of all samples.
pub(crate) struct Target {
    size: [u32; 2],
    color: TextureView,
    depth: TextureView,
    average: Average,
}

impl Target {
    /// Creates a target of the size in pixels, with samples of the format `color`.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`], or if memory runs out.
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2], color: TextureFormat) -> Result<Self> {
        let texture = |what, format, usage| {
            let texels = Texels2d { what, size, levels: 1, format };
            let texture = texels.create(gpu, TextureUsages::RENDER_ATTACHMENT | usage);
            texture.map(|texture| texture.create_view(&wgpu::TextureViewDescriptor::default()))
        };
        let color = texture("the image", color, TextureUsages::TEXTURE_BINDING)?;
        let depth = texture("the depth of the image", DEPTH, TextureUsages::empty())?;
        let average = Average::new(gpu, size, &color)?;
        Ok(Self { size, color, depth, average })
    }

    /// The size in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Begins to draw a sample to the empty image.
    pub(crate) fn pass<'e>(&self, encoder: &'e mut CommandEncoder) -> RenderPass<'e> {
        let color = wgpu::RenderPassColorAttachment {
            view: &self.color,
            depth_slice: None,
            resolve_target: None,
            ops: cleared(wgpu::Color::TRANSPARENT),
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(cleared(0.0)),
            stencil_ops: None,
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surfaces"),
            color_attachments: &[Some(color)],
            depth_stencil_attachment: Some(depth),
            ..wgpu::RenderPassDescriptor::default()
        })
    }

    /// Adds the drawn sample to the mean.
    pub(crate) fn add(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder, sample: SampleNumber) {
        self.average.add(gpu, encoder, sample);
    }

    /// Reads the mean of the samples back.
    ///
    /// # Errors
    /// If memory runs out or the driver fails.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<Image> {
        let [width, height] = self.size;
        let mut image = Image::new(width, height, [0.0; 4])?;
        let stride = (width * 16).next_multiple_of(ROW_ALIGNMENT);
        let rows = (BAND_BYTES / u64::from(stride)).clamp(1, u64::from(height)) as u32;
        let bands = image.pixels_mut().chunks_mut((rows * width) as usize);
        for (band, pixels) in bands.enumerate() {
            let first = band as u32 * rows;
            let bytes = self.band(gpu, [first, rows.min(height - first)], stride)?;
            for (row, bytes) in pixels.chunks_mut(width as usize).zip(bytes.chunks(stride as usize)) {
                let row: &mut [u8] = bytemuck::cast_slice_mut(row);
                row.copy_from_slice(&bytes[..row.len()]);
            }
        }
        Ok(image)
    }

    /// The bytes of `count` rows starting at `first`.
    fn band(&self, gpu: &Gpu, [first, count]: [u32; 2], stride: u32) -> Result<Vec<u8>> {
        let descriptor = wgpu::BufferDescriptor {
            label: Some("rows of the image"),
            size: u64::from(stride) * u64::from(count),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        };
        const READING: &str = "reading the image back";
        let submitted = gpu.checked(READING, || {
            let buffer = gpu.device.create_buffer(&descriptor);
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut source = self.average.mean().as_image_copy();
            source.origin.y = first;
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
            let destination = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            encoder.copy_texture_to_buffer(source, destination, extent([self.size[0], count]));
            (buffer, gpu.queue.submit([encoder.finish()]))
        })?;
        gpu.read(READING, submitted)
    }
}

/// One sample of every pixel of an image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampleNumber {
    /// Its index, from 0.
    pub number: usize,
    /// The number of samples per pixel.
    pub count: usize,
}

/// The format of sums.
const SUM: TextureFormat = TextureFormat::Rgba32Float;

/// Two images between which the sum of samples alternates.
struct Average {
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
    /// As [`Target::new`].
    fn new(gpu: &Gpu, size: [u32; 2], seen: &TextureView) -> Result<Self> {
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
    fn add(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder, sample: SampleNumber) {
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
    fn mean(&self) -> &Texture {
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
fn cleared<V>(value: V) -> wgpu::Operations<V> {
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
