//! Evaluates points with WGSL on a Vulkan driver, through wgpu.

use super::cases::Case;
use super::harness;
use super::inputs::{Draw, Inputs, Picture, numbers, picture_of};
use anyhow::{Context, Result, anyhow};
use std::collections::BTreeMap;
use std::sync::mpsc;
use taotie_shader::{Interface, PixelShader};
use wgpu::{BindGroupLayout, BindGroupLayoutEntry, BindingResource, BindingType, Buffer, BufferUsages};
use wgpu::{Extent3d, Features, RenderPipeline, ShaderStages, TextureFormat, TextureUsages, TextureView};

/// The format of points and of radiance.
const FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// A GPU, or an emulated one, with the points uploaded.
pub struct Vulkan<'i> {
    /// The name of the driver.
    pub name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    inputs: &'i Inputs,
    shared: BTreeMap<&'static str, TextureView>,
    draws: Vec<Uploaded>,
    sampler: wgpu::Sampler,
}

/// The pictures of a draw.
struct Uploaded {
    points: TextureView,
    textures: BTreeMap<&'static str, TextureView>,
}

/// A shader ready to draw.
struct Pipeline {
    pipeline: RenderPipeline,
    interface: Interface,
    layouts: [BindGroupLayout; 3],
}

/// Returns an emulated GPU if there is one, otherwise the first driver.
fn adapter() -> Result<wgpu::Adapter> {
    let backends = wgpu::Backends::VULKAN;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
    adapters.sort_by_key(|adapter| adapter.get_info().device_type != wgpu::DeviceType::Cpu);
    let none = || anyhow!("no Vulkan driver; `make tools` installs one if possible");
    adapters.into_iter().next().ok_or_else(none)
}

impl<'i> Vulkan<'i> {
    /// Finds a driver and uploads the points.
    ///
    /// # Errors
    /// If there is no driver, or it fails.
    pub fn new(inputs: &'i Inputs) -> Result<Self> {
        let adapter = adapter()?;
        let info = adapter.get_info();
        let request = wgpu::DeviceDescriptor {
            label: Some("points"),
            required_features: Features::empty(),
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&request))?;
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            ..wgpu::SamplerDescriptor::default()
        });
        let name = format!("{}, {}", info.name, info.driver_info);
        let (shared, draws) = (BTreeMap::new(), Vec::new());
        let mut vulkan = Self { name, device, queue, inputs, shared, draws, sampler };
        vulkan.upload();
        Ok(vulkan)
    }

    fn upload(&mut self) {
        for name in ["albedo_tables", "environment_maps", "environment_picture"] {
            if let Some(Picture { size, texels }) = self.inputs.shared(name) {
                self.shared.insert(name, self.picture(*size, texels));
            }
        }
        for draw in &self.inputs.draws {
            let size = draw.size();
            let textures = draw.points.textures.iter();
            let textures = textures.map(|(name, texels)| (*name, self.picture(size, texels))).collect();
            let points = self.picture([size[0], draw.points.inputs.len() / size[0]], &draw.points.inputs);
            self.draws.push(Uploaded { points, textures });
        }
    }

    fn texture(&self, [width, height]: [usize; 2], usage: TextureUsages) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent([width, height]),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage,
            view_formats: &[],
        })
    }

    fn picture(&self, size: [usize; 2], texels: &[[f32; 4]]) -> TextureView {
        let texture = self.texture(size, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
        let row = Some(16 * size[0] as u32);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: row, rows_per_image: None };
        let bytes = super::inputs::bytes(texels.as_flattened());
        self.queue.write_texture(texture.as_image_copy(), &bytes, layout, extent(size));
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    fn buffer(&self, bytes: &[u8], usage: BufferUsages) -> Buffer {
        let size = bytes.len().max(16) as u64;
        let descriptor = wgpu::BufferDescriptor {
            label: None,
            size,
            usage: usage | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        let buffer = self.device.create_buffer(&descriptor);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// Returns the radiance of all points of a surface, draw by draw.
    ///
    /// # Errors
    /// If the driver rejects the shader or fails.
    pub fn radiance(&self, case: &Case) -> Result<Vec<[f32; 4]>> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let pipeline = self.pipeline(harness::wgsl(case));
        let read = self.draw(case, &pipeline);
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(anyhow!("{error}")).with_context(|| format!("{case:?}"));
        }
        self.read(&read)
    }

    fn pipeline(&self, shader: PixelShader) -> Pipeline {
        let PixelShader { text, interface, .. } = shader;
        let layouts = [0, 1, 2].map(|group| self.layout(&interface, group));
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layouts[0]), Some(&layouts[1]), Some(&layouts[2])],
            immediate_size: 0,
        });
        let target =
            wgpu::ColorTargetState { format: FORMAT, blend: None, write_mask: wgpu::ColorWrites::ALL };
        let pipeline = self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("points_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("points_fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        });
        Pipeline { pipeline, interface, layouts }
    }

    /// Returns the layout of a group: the bindings of the interface, or the points.
    fn layout(&self, interface: &Interface, group: u32) -> BindGroupLayout {
        let buffers = interface.buffers.iter().filter(|slot| slot.group == group);
        let mut entries: Vec<_> = buffers.map(|slot| entry(slot.binding, buffer(slot.storage))).collect();
        for slot in interface.textures.iter().filter(|slot| slot.group == group) {
            entries.push(entry(slot.binding, TEXTURE));
            let sampler = BindingType::Sampler(wgpu::SamplerBindingType::NonFiltering);
            entries.extend(slot.sampler.map(|binding| entry(binding, sampler)));
        }
        if group == 2 {
            entries.push(entry(0, TEXTURE));
        }
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
        self.device.create_bind_group_layout(&descriptor)
    }

    /// Draws all points and copies the result to a buffer.
    fn draw(&self, case: &Case, pipeline: &Pipeline) -> Buffer {
        let size = self.inputs.points() as u64 * 16;
        let read = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let materials = self.inputs.materials(case);
        let mut offset = 0;
        for ((draw, uploaded), material) in self.inputs.draws.iter().zip(&self.draws).zip(&materials) {
            let factors = pipeline.interface.material_bytes(&case.factors(material));
            let groups = Groups { case, pipeline, draw, uploaded, factors };
            self.draw_one(&groups, &read, offset);
            offset += draw.points.len() as u64 * 16;
        }
        read
    }

    fn draw_one(&self, groups: &Groups<'_>, read: &Buffer, offset: u64) {
        let size = groups.draw.size();
        let target = self.texture(size, TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let bound = [0, 1, 2].map(|group| self.bound(groups, group));
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let color = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(color)],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&groups.pipeline.pipeline);
        for (number, group) in bound.iter().enumerate() {
            pass.set_bind_group(number as u32, group, &[]);
        }
        pass.draw(0..3, 0..1);
        drop(pass);
        let row = Some(16 * size[0] as u32);
        let layout = wgpu::TexelCopyBufferLayout { offset, bytes_per_row: row, rows_per_image: None };
        let destination = wgpu::TexelCopyBufferInfo { buffer: read, layout };
        encoder.copy_texture_to_buffer(target.as_image_copy(), destination, extent(size));
        self.queue.submit([encoder.finish()]);
    }

    fn bound(&self, groups: &Groups<'_>, group: u32) -> wgpu::BindGroup {
        let interface = &groups.pipeline.interface;
        let buffers: Vec<(u32, Buffer)> = interface
            .buffers
            .iter()
            .filter(|slot| slot.group == group)
            .map(|slot| {
                let usage = if slot.storage { BufferUsages::STORAGE } else { BufferUsages::UNIFORM };
                (slot.binding, self.buffer(&groups.bytes(slot.name, self.inputs), usage))
            })
            .collect();
        let mut entries: Vec<wgpu::BindGroupEntry<'_>> = Vec::new();
        for (binding, buffer) in &buffers {
            let resource = buffer.as_entire_binding();
            entries.push(wgpu::BindGroupEntry { binding: *binding, resource });
        }
        for slot in interface.textures.iter().filter(|slot| slot.group == group) {
            let own = || groups.uploaded.textures.get(picture_of(groups.case, slot.name));
            if let Some(view) = self.shared.get(slot.name).or_else(own) {
                let resource = BindingResource::TextureView(view);
                entries.push(wgpu::BindGroupEntry { binding: slot.binding, resource });
            }
            entries.extend(slot.sampler.map(|binding| wgpu::BindGroupEntry {
                binding,
                resource: BindingResource::Sampler(&self.sampler),
            }));
        }
        if group == 2 {
            let resource = BindingResource::TextureView(&groups.uploaded.points);
            entries.push(wgpu::BindGroupEntry { binding: 0, resource });
        }
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &groups.pipeline.layouts[group as usize],
            entries: &entries,
        })
    }

    fn read(&self, buffer: &Buffer) -> Result<Vec<[f32; 4]>> {
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone if waiting has failed.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        receiver.recv()??;
        let texels = numbers(&buffer.get_mapped_range(..)?);
        buffer.unmap();
        Ok(texels)
    }
}

/// The content of the groups of a draw.
struct Groups<'d> {
    case: &'d Case,
    pipeline: &'d Pipeline,
    draw: &'d Draw,
    uploaded: &'d Uploaded,
    /// The bytes of the surface's uniforms.
    factors: Vec<u8>,
}

impl Groups<'_> {
    fn bytes(&self, name: &str, inputs: &Inputs) -> Vec<u8> {
        if name == "material" { self.factors.clone() } else { self.draw.buffer(name, inputs) }
    }
}

const TEXTURE: BindingType = BindingType::Texture {
    sample_type: wgpu::TextureSampleType::Float { filterable: false },
    view_dimension: wgpu::TextureViewDimension::D2,
    multisampled: false,
};

fn buffer(storage: bool) -> BindingType {
    let ty = match storage {
        true => wgpu::BufferBindingType::Storage { read_only: true },
        false => wgpu::BufferBindingType::Uniform,
    };
    BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

fn entry(binding: u32, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry { binding, visibility: ShaderStages::FRAGMENT, ty, count: None }
}

fn extent([width, height]: [usize; 2]) -> Extent3d {
    Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 }
}
