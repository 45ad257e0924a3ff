//! Pipelines: shaders with their bindings and drawing state. Each is created once.

use crate::gpu::{Gpu, Result};
use crate::target::DEPTH;
use std::collections::HashMap;
use std::sync::Arc;
use taotie_engine::render::{RenderSettings, Surface};
use taotie_shader::{
    Interface, Language, PixelShader, ValueKind, Variant, VariantOptions, VertexInput, pixel_shader,
};
use wgpu::{BindGroupLayout, BindGroupLayoutEntry, BindingType, BlendComponent, BlendFactor, BlendState};
use wgpu::{RenderPipeline, SamplerBindingType, ShaderStages, TextureFormat, TextureSampleType};

/// The group of the surface's resources.
const MATERIAL_GROUP: u32 = 1;

/// A shader ready to draw, with its bindings.
pub(crate) struct SurfacePipeline {
    pub pipeline: RenderPipeline,
    pub interface: Interface,
    /// The layout of group 1.
    pub material: BindGroupLayout,
}

/// All pipelines requested so far.
pub(crate) struct Pipelines {
    /// The format of the image.
    color: TextureFormat,
    /// The text needed by shaders that trace shadow rays.
    visibility: String,
    made: HashMap<PipelineKey, Arc<SurfacePipeline>>,
}

impl Pipelines {
    /// Creates an empty set, for images of the format `color`; `visibility` is the text for shaders that trace shadow
    /// rays.
    pub(crate) fn new(color: TextureFormat, visibility: String) -> Self {
        Self { color, visibility, made: HashMap::new() }
    }

    /// The pipeline for these facts; `frame` is the layout of group 0.
    ///
    /// # Errors
    /// If the driver rejects the shader.
    pub(crate) fn get(
        &mut self,
        gpu: &Gpu,
        key: &PipelineKey,
        frame: &BindGroupLayout,
    ) -> Result<Arc<SurfacePipeline>> {
        if let Some(made) = self.made.get(key) {
            return Ok(made.clone());
        }
        let mut shader = pixel_shader(&key.variant, Language::Wgsl);
        if key.shadows {
            shader.text += &self.visibility;
        }
        let layouts = Layouts { color: self.color, frame };
        let made = gpu.checked("a shader", || Arc::new(layouts.pipeline(gpu, key, shader)))?;
        self.made.insert(key.clone(), made.clone());
        Ok(made)
    }
}

/// The layouts and formats that all pipelines share.
struct Layouts<'l> {
    color: TextureFormat,
    frame: &'l BindGroupLayout,
}

impl Layouts<'_> {
    fn pipeline(&self, gpu: &Gpu, key: &PipelineKey, shader: PixelShader) -> SurfacePipeline {
        let PixelShader { text, interface, .. } = shader;
        let device = &gpu.device;
        let material = material_layout(gpu, &interface);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("surface"),
            bind_group_layouts: &[Some(self.frame), Some(&material)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("surface"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let attributes: Vec<_> = interface.vertex.iter().map(attribute).collect();
        let buffers: Vec<_> = interface.vertex.iter().zip(&attributes).map(buffer_layout).collect();
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("surface"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: primitive(key),
            depth_stencil: Some(depth(key)),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment_main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(self.target(key))],
            }),
            multiview_mask: None,
            cache: None,
        });
        SurfacePipeline { pipeline, interface, material }
    }

    fn target(&self, key: &PipelineKey) -> wgpu::ColorTargetState {
        wgpu::ColorTargetState {
            format: self.color,
            blend: key.blended.then_some(OVER),
            write_mask: wgpu::ColorWrites::ALL,
        }
    }
}

/// Blends colour that is not premultiplied over premultiplied colour.
const OVER: BlendState = BlendState {
    color: BlendComponent { src_factor: BlendFactor::SrcAlpha, ..BlendComponent::OVER },
    alpha: BlendComponent::OVER,
};

/// Front faces are those of the mesh, whatever the transform; back faces are drawn for double-sided surfaces.
fn primitive(key: &PipelineKey) -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        front_face: if key.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
        cull_mode: (!key.double_sided).then_some(wgpu::Face::Back),
        ..wgpu::PrimitiveState::default()
    }
}

/// Depth is reversed. At equal depth, the first surface drawn wins; blended surfaces do not write depth.
fn depth(key: &PipelineKey) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(!key.blended),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// The layout of group 1: factors, and textures with their samplers.
fn material_layout(gpu: &Gpu, interface: &Interface) -> BindGroupLayout {
    let factors = entry(0, uniform());
    let slots = interface.textures.iter().filter(|slot| slot.group == MATERIAL_GROUP);
    let textures = slots.flat_map(|slot| {
        let sampler =
            slot.sampler.map(|binding| entry(binding, BindingType::Sampler(SamplerBindingType::Filtering)));
        [Some(entry(slot.binding, texture(slot.sampler.is_some()))), sampler].into_iter().flatten()
    });
    let entries: Vec<_> = std::iter::once(factors).chain(textures).collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("material"),
        entries: &entries,
    })
}

/// An entry of a layout. Vertex shaders read only uniforms.
pub(crate) fn entry(binding: u32, ty: BindingType) -> BindGroupLayoutEntry {
    let visibility = if ty == uniform() { ShaderStages::VERTEX_FRAGMENT } else { ShaderStages::FRAGMENT };
    BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

/// A uniform buffer.
pub(crate) fn uniform() -> BindingType {
    BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// A read-only buffer of any length.
pub(crate) fn storage() -> BindingType {
    BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// A two-dimensional texture, filtered or read texel by texel.
pub(crate) fn texture(filterable: bool) -> BindingType {
    BindingType::Texture {
        sample_type: TextureSampleType::Float { filterable },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    }
}

fn attribute(input: &VertexInput) -> [wgpu::VertexAttribute; 1] {
    let format = match input.kind {
        ValueKind::Number => wgpu::VertexFormat::Float32,
        ValueKind::Vec2 => wgpu::VertexFormat::Float32x2,
        ValueKind::Vec3 => wgpu::VertexFormat::Float32x3,
        ValueKind::Vec4 | ValueKind::Mat4 => wgpu::VertexFormat::Float32x4,
    };
    [wgpu::VertexAttribute { format, offset: 0, shader_location: input.location }]
}

/// Each vertex attribute has a separate buffer.
fn buffer_layout<'a>(
    (input, attributes): (&VertexInput, &'a [wgpu::VertexAttribute; 1]),
) -> Option<wgpu::VertexBufferLayout<'a>> {
    let array_stride = 4 * input.kind.numbers() as u64;
    Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
}

/// The facts that a surface's pipeline depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    /// The variant of its shader.
    pub variant: Variant,
    /// `true` if front faces are clockwise.
    pub mirrored: bool,
    /// `true` if back faces are drawn.
    pub double_sided: bool,
    /// `true` if it is blended.
    pub blended: bool,
    /// `true` if its lights cast shadows.
    pub shadows: bool,
}

impl PipelineKey {
    /// The facts of a surface under some settings; `environment` is true if there is one.
    pub(crate) fn new(surface: &Surface<'_>, settings: &RenderSettings, environment: bool) -> Self {
        let shadows = settings.shadows && !surface.material.unlit;
        let options =
            VariantOptions { shadows, ..VariantOptions::of_surface(surface, settings, environment) };
        Self {
            variant: Variant::new(surface.material, &options),
            mirrored: surface.mirrored,
            double_sided: surface.material.double_sided,
            blended: surface.material.is_blended(),
            shadows,
        }
    }
}
