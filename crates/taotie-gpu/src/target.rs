//! The image that is drawn to, and its readback.

use crate::average::{Average, SampleNumber, cleared};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::textures::{Texels2d, extent};
use std::sync::mpsc;
use taotie_engine::image::Image;
use wgpu::{BufferUsages, CommandEncoder, MapMode, RenderPass, TextureFormat, TextureUsages, TextureView};

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
        let buffer = gpu.checked("reading the image back", || {
            let buffer = gpu.device.create_buffer(&descriptor);
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut source = self.average.mean().as_image_copy();
            source.origin.y = first;
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
            let destination = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            encoder.copy_texture_to_buffer(source, destination, extent([self.size[0], count]));
            gpu.queue.submit([encoder.finish()]);
            buffer
        })?;
        mapped(gpu, &buffer)
    }
}

/// The bytes of a buffer, once all work is done.
fn mapped(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
    const DOING: &str = "reading the image back";
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(MapMode::Read, .., move |result| {
        // If waiting has failed, the receiver no longer exists.
        let _ = sender.send(result);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| gpu.refused(DOING, &error))?;
    match receiver.recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(gpu.refused(DOING, &error)),
        Err(error) => return Err(gpu.refused(DOING, &error)),
    }
    let bytes = buffer.get_mapped_range(..).map_err(|error| gpu.refused(DOING, &error))?.to_vec();
    buffer.unmap();
    Ok(bytes)
}
