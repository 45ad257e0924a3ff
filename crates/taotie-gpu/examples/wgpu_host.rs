//! A custom wgpu host for a generated shader: a convex mesh under one light, with an untextured material. `cargo run
//! -p taotie-gpu --example wgpu_host` draws a bronze sphere to `sphere.png`.
//!
//! `taotie_gpu` itself draws whole scenes. This example is for programs that draw on their own and only need the
//! shader.

use std::sync::mpsc;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{Falloff, LightSource, Place, Turn};
use taotie_engine::{film, image, mesh::Mesh, scene::Material, shade::dfg};
use taotie_io as io;
use taotie_shader::{FrameFactors, Interface, SurfaceFactors, light_numbers};
use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};
use wgpu::{BufferUsages, TextureDescriptor, TextureFormat::Rgba32Float, TextureUsages};

/// A result with any error.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// A mesh and its light, seen in parallel projection along −z: from −1 to 1 in x and y.
pub struct View<'v> {
    /// Convex, since it is drawn without depth.
    pub mesh: &'v Mesh,
    /// Its material.
    pub material: &'v Material,
    /// The only light.
    pub light: LightSource<f32>,
    /// Width and height in pixels, a multiple of 16.
    pub size: u32,
}

impl View<'_> {
    /// The bytes of a buffer listed in the interface.
    fn bytes(&self, name: &str, interface: &Interface) -> (Vec<u8>, BufferUsages) {
        let normal_matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::from_array);
        let factors = SurfaceFactors { material: self.material, normal_matrix, bump: 0.0, height_levels: 1 };
        let frame = FrameFactors {
            clip_from_world: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0, 0.0, 0.5, 1.0]],
            eye: [0.0, 0.0, 1.0, 0.0],
            ambient: Vec3::splat(0.0),
            spacing: 1.0,
            turn: Turn { sin: 0.0, cos: 1.0 },
            intensity: 0.0,
            levels: 1,
            smoothest_alpha: 1.0,
            lights: 1,
        };
        match name {
            "frame" => (frame.bytes(), BufferUsages::UNIFORM),
            "lights" => (bytemuck::cast_slice(&light_numbers(&self.light)).to_vec(), BufferUsages::STORAGE),
            _ => (interface.material_bytes(&factors), BufferUsages::UNIFORM),
        }
    }

    /// Linear RGB radiance and alpha, row by row from the top; zeros where the mesh is not visible.
    pub fn draw(&self) -> Result<Vec<[f32; 4]>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
        };
        let options = taotie_shader::VariantOptions { tangents: false, uv_sets: 0, ..Default::default() };
        let variant = taotie_shader::Variant::new(self.material, &options);
        let shader = taotie_shader::pixel_shader(&variant, taotie_shader::Language::Wgsl);
        let (pipeline, interface) = (pipeline(&device, &shader), &shader.interface);
        let tables = dfg::tables();
        let size = [dfg::COLUMNS as u32, (tables.len() / dfg::COLUMNS) as u32];
        let (order, contents) = (TextureDataOrder::LayerMajor, bytemuck::cast_slice(&tables));
        let albedos = described(size, TextureUsages::TEXTURE_BINDING);
        let albedos = device
            .create_texture_with_data(&queue, &albedos, order, contents)
            .create_view(&Default::default());
        let groups = [0, 1].map(|group| {
            let slots = interface.buffers.iter().filter(|slot| slot.group == group);
            let buffers = slots.map(|slot| (slot.binding, self.bytes(slot.name, interface)));
            let buffers = buffers.map(|(binding, (bytes, usage))| (binding, buffer(&bytes, usage)));
            let buffers: Vec<_> = buffers.collect();
            let buffers = buffers.iter().map(|(binding, buffer)| (*binding, buffer.as_entire_binding()));
            // The tables of directional albedos are the only texture here.
            let textures = interface.textures.iter().filter(|slot| slot.group == group);
            let textures = textures.map(|slot| (slot.binding, wgpu::BindingResource::TextureView(&albedos)));
            let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
            let entries: Vec<_> = buffers.chain(textures).map(entry).collect();
            let layout = &pipeline.get_bind_group_layout(group);
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        });
        let vertices = interface.vertex.iter().map(|input| {
            let normal = input.name == "normal";
            let vectors = if normal { self.mesh.normals() } else { self.mesh.positions() };
            let numbers: Vec<f32> = vectors.iter().flat_map(|vector| vector.to_array()).collect();
            buffer(bytemuck::cast_slice(&numbers), BufferUsages::VERTEX)
        });
        let vertices: Vec<_> = vertices.collect();
        let triangles = self.mesh.triangles().as_flattened();
        let indices = buffer(bytemuck::cast_slice(triangles), BufferUsages::INDEX);
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let target = device.create_texture(&described([self.size; 2], usage));
        let view = target.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let ops = wgpu::Operations::default();
        let color =
            wgpu::RenderPassColorAttachment { view: &view, depth_slice: None, resolve_target: None, ops };
        let color_attachments = &[Some(color)];
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor { color_attachments, ..Default::default() });
        pass.set_pipeline(&pipeline);
        groups.iter().zip(0..).for_each(|(group, number)| pass.set_bind_group(number, group, &[]));
        vertices.iter().zip(0..).for_each(|(values, slot)| pass.set_vertex_buffer(slot, values.slice(..)));
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..triangles.len() as u32, 0, 0..1);
        drop(pass);
        let bytes = vec![0; 16 * (self.size * self.size) as usize];
        let read = buffer(&bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let bytes_per_row = Some(16 * self.size);
        let layout = wgpu::TexelCopyBufferLayout { bytes_per_row, ..Default::default() };
        let to = wgpu::TexelCopyBufferInfo { buffer: &read, layout };
        encoder.copy_texture_to_buffer(target.as_image_copy(), to, target.size());
        queue.submit([encoder.finish()]);
        let (sender, receiver) = mpsc::channel();
        read.map_async(wgpu::MapMode::Read, .., move |result| sender.send(result).unwrap_or_default());
        device.poll(wgpu::PollType::wait_indefinitely())?;
        receiver.recv()??;
        Ok(bytemuck::pod_collect_to_vec(&read.get_mapped_range(..)?))
    }
}

fn described([width, height]: [u32; 2], usage: TextureUsages) -> TextureDescriptor<'static> {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let (dimension, format) = (wgpu::TextureDimension::D2, Rgba32Float);
    let (mip_level_count, sample_count) = (1, 1);
    TextureDescriptor {
        label: None,
        size,
        mip_level_count,
        sample_count,
        dimension,
        format,
        usage,
        view_formats: &[],
    }
}

/// The pipeline of a shader. Its layout is derived from the text; each vertex attribute has a separate buffer.
fn pipeline(device: &wgpu::Device, shader: &taotie_shader::PixelShader) -> wgpu::RenderPipeline {
    let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
    });
    let compilation_options = wgpu::PipelineCompilationOptions::default();
    let (format, step_mode) = (wgpu::VertexFormat::Float32x3, wgpu::VertexStepMode::Vertex);
    let attribute = |shader_location| [wgpu::VertexAttribute { format, offset: 0, shader_location }];
    let attributes: Vec<_> = shader.interface.vertex.iter().map(|input| attribute(input.location)).collect();
    let layout = |attributes| Some(wgpu::VertexBufferLayout { array_stride: 12, step_mode, attributes });
    let buffers: Vec<_> = attributes.iter().map(|attribute| layout(&attribute[..])).collect();
    let targets = &[Some(Rgba32Float.into())];
    let (entry_point, options) = (Some("vertex_main"), compilation_options.clone());
    let vertex = wgpu::VertexState { module, entry_point, compilation_options: options, buffers: &buffers };
    let entry_point = Some("fragment_main");
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex,
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState { module, entry_point, compilation_options, targets }),
        multiview_mask: None,
        cache: None,
    })
}

fn main() -> Result<()> {
    let (mesh, size) = (Mesh::sphere(0.9, 96, 48), 512);
    let material = taotie_engine::scene::preset("bronze").unwrap_or_default();
    let (color, place) = (Vec3::splat(3.0), Place::Towards(Vec3::new(-0.48, 0.64, 0.6)));
    let light = LightSource { color, place, falloff: Falloff::None, cone: None };
    let radiance = View { mesh: &mesh, material: &material, light, size }.draw()?;
    let mut image = image::Image::new(size, size, [0.0; 4])?;
    image.pixels_mut().copy_from_slice(&radiance);
    let codes = film::develop8(&image, &film::Development::default())?;
    let bitmap = image::Bitmap::new(size, size, 4, image::Texels::U8(codes))?;
    Ok(io::write_png_bitmap("sphere.png".as_ref(), &bitmap, image::Encoding::Srgb)?)
}
