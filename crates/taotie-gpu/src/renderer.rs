//! Renders images of one scene, one after the other.

use crate::blending::BlendOrder;
use crate::frame_inputs::FrameInputs;
use crate::gpu::{Gpu, GpuError, Result};
use crate::pipelines::{PipelineKey, Pipelines, SurfacePipeline};
use crate::shadows::{ShadowInputs, visibility_text};
use crate::surfaces::{MaterialTextures, Meshes, Numbered, SurfaceDraw};
use crate::target::{SampleNumber, Target};
use crate::textures::{Samplers, Textures};
use std::collections::HashMap;
use std::sync::Arc;
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop8_into};
use taotie_engine::render::{CheckedShot, Frame, Prepared, Shot, Surface, fill_backdrop, fill_ground};
use taotie_shader::SurfaceFactors;
use wgpu::{
    BindGroup, Buffer, BufferUsages, CommandEncoder, Features, IndexFormat, RenderPass, TextureFormat,
};

/// Renders images of one scene on a GPU and keeps there everything that is reused between them: vertices, textures,
/// environments and shaders. Each further frame of a turntable costs only the drawing.
pub struct GpuRenderer<'p> {
    gpu: Gpu,
    prepared: &'p Prepared,
    surfaces: Vec<Surface<'p>>,
    uploaded: Uploaded,
    frame: FrameInputs,
    /// The bindings of surfaces, by their index and how they are drawn.
    materials: HashMap<(usize, PipelineKey), BindGroup>,
    target: Option<Target>,
    /// `true` once the shadow casters are uploaded.
    casts: bool,
    color: TextureFormat,
}

/// The step named in errors from drawing.
const DRAWING: &str = "drawing";

/// The resources that remain on the GPU.
struct Uploaded {
    meshes: Meshes,
    textures: MaterialTextures,
    pipelines: Pipelines,
}

/// The triangles of blended surfaces, in drawing order.
struct Blended {
    order: BlendOrder,
    indices: Buffer,
}

impl<'p> GpuRenderer<'p> {
    /// Uploads the textures of a scene.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] for a texture beyond the GPU's limits, or if memory runs out.
    pub fn new(gpu: &Gpu, prepared: &'p Prepared) -> Result<Self> {
        let surfaces = prepared.surfaces();
        let materials = surfaces.iter().map(|surface| surface.material);
        let color = color_format(gpu.features, surfaces.iter().any(|surface| surface.material.is_blended()));
        let uploaded = Uploaded {
            meshes: Meshes::default(),
            textures: MaterialTextures {
                textures: Textures::new(gpu, prepared.scene(), materials)?,
                samplers: Samplers::default(),
            },
            pipelines: Pipelines::new(color, visibility_text(prepared.ray_offset())),
        };
        Ok(Self {
            frame: FrameInputs::new(gpu)?,
            gpu: gpu.clone(),
            prepared,
            surfaces,
            uploaded,
            materials: HashMap::new(),
            target: None,
            casts: false,
            color,
        })
    }

    /// The GPU.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Renders an image in linear light. Every sample is shaded, as on the CPU. `progress` reports shaders that are
    /// ready and samples that the GPU has finished.
    ///
    /// # Errors
    /// [`GpuError::Scene`] as for [`taotie_engine::render::Pass::new`], or if cancelled; [`GpuError::Unsupported`]
    /// for output variables; [`GpuError::TooLarge`] for an image or mesh beyond the GPU's limits, or if memory runs
    /// out.
    pub fn render(&mut self, shot: &Shot<'_>, progress: Progress<'_>) -> Result<Frame> {
        let checked = CheckedShot::new(shot)?;
        if checked.settings.aovs {
            return Err(GpuError::Unsupported { what: "output variables (AOVs)".into() });
        }
        self.cast(&checked)?;
        self.frame.light(&self.gpu, shot.lighting)?;
        let samples = checked.pattern.offsets().len();
        // One step for the shaders, one for each sample, and one for reading the image.
        let steps = (samples + 2) as f64;
        let shaders = progress.part(0.0, 1.0 / steps);
        let draws = self.draws(&checked, shot.lighting.environment.is_some(), shaders)?;
        let blended = self.blended(&checked)?;
        let mut target = self.take_target([checked.settings.width, checked.settings.height])?;
        let mut submitted = None;
        for sample in 0..samples {
            self.frame.see(&self.gpu, &checked, sample);
            let next = self.gpu.checked(DRAWING, || {
                let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
                self.draw(&mut encoder, &target, &draws, &blended);
                target.add(&self.gpu, &mut encoder, SampleNumber { number: sample, count: samples });
                self.gpu.queue.submit([encoder.finish()])
            })?;
            // Waiting only for the sample before keeps the GPU busy.
            if let Some(before) = submitted.replace(next) {
                self.gpu.wait(DRAWING, before)?;
                progress.at((sample + 1) as f64 / steps)?;
            }
        }
        let mut color = target.read(&self.gpu)?;
        self.target = Some(target);
        fill_ground(&mut color, self.prepared, shot);
        fill_backdrop(&mut color, shot);
        progress.at(1.0)?;
        Ok(Frame { color, aovs: None })
    }

    /// Renders an image and develops it to 8-bit sRGB with straight alpha, row by row from the top. `codes` is
    /// resized to the image; passing it in again avoids allocation.
    ///
    /// # Errors
    /// As [`Self::render`] and [`develop8_into`].
    pub fn develop(
        &mut self,
        shot: &Shot<'_>,
        development: &Development,
        codes: &mut Vec<[u8; 4]>,
        progress: Progress<'_>,
    ) -> Result<()> {
        let frame = self.render(shot, progress)?;
        codes.resize(frame.color.pixels().len(), [0; 4]);
        Ok(develop8_into(&frame.color, development, codes)?)
    }

    /// Uploads the shadow casters when an image first needs them.
    fn cast(&mut self, checked: &CheckedShot) -> Result<()> {
        if checked.settings.shadows && !self.casts {
            self.frame.cast(ShadowInputs::new(&self.gpu, self.prepared, &self.surfaces)?);
            self.casts = true;
        }
        Ok(())
    }

    /// All surfaces ready to draw, in order.
    fn draws(
        &mut self,
        checked: &CheckedShot,
        environment: bool,
        progress: Progress<'_>,
    ) -> Result<Vec<SurfaceDraw>> {
        let mut draws = Vec::with_capacity(self.surfaces.len());
        for number in 0..self.surfaces.len() {
            let key = PipelineKey::new(&self.surfaces[number], &checked.settings, environment);
            let pipeline = self.uploaded.pipelines.get(&self.gpu, &key, self.frame.layout())?;
            let material = self.material(number, key, &pipeline)?;
            let surface = Numbered { number, surface: &self.surfaces[number] };
            let meshes = &mut self.uploaded.meshes;
            let mut vertices = Vec::new();
            for input in &pipeline.interface.vertex {
                vertices.push(meshes.vertices(&self.gpu, surface, input)?);
            }
            let triangles = meshes.triangles(&self.gpu, surface)?;
            let count = 3 * surface.surface.triangles.len() as u32;
            let blended = surface.surface.material.is_blended();
            draws.push(SurfaceDraw { pipeline, material, vertices, triangles, count, blended });
            progress.at(draws.len() as f64 / self.surfaces.len() as f64)?;
        }
        Ok(draws)
    }

    /// The factors and textures of a surface.
    fn material(
        &mut self,
        number: usize,
        key: PipelineKey,
        pipeline: &Arc<SurfacePipeline>,
    ) -> Result<BindGroup> {
        if let Some(made) = self.materials.get(&(number, key.clone())) {
            return Ok(made.clone());
        }
        let factors = SurfaceFactors::of_surface(&self.surfaces[number], self.prepared.scene());
        let made = self.uploaded.textures.bind(&self.gpu, pipeline, &factors)?;
        self.materials.insert((number, key), made.clone());
        Ok(made)
    }

    fn blended(&self, checked: &CheckedShot) -> Result<Blended> {
        let blended: Vec<usize> =
            (0..self.surfaces.len()).filter(|i| self.surfaces[*i].material.is_blended()).collect();
        let order = BlendOrder::new(&self.surfaces, &blended, &checked.clip_from_world);
        let bytes = bytemuck::cast_slice(&order.indices);
        let indices = self.gpu.buffer("the triangles that blend", bytes, BufferUsages::INDEX)?;
        Ok(Blended { order, indices })
    }

    /// The target of the previous image if it fits, else a new one.
    fn take_target(&mut self, size: [u32; 2]) -> Result<Target> {
        match self.target.take().filter(|target| target.size() == size) {
            Some(target) => Ok(target),
            None => Target::new(&self.gpu, size, self.color),
        }
    }

    /// Draws a sample: first the opaque surfaces, then the blended ones.
    fn draw(&self, encoder: &mut CommandEncoder, target: &Target, draws: &[SurfaceDraw], blended: &Blended) {
        let mut pass = target.pass(encoder);
        pass.set_bind_group(0, self.frame.group(), &[]);
        for draw in draws.iter().filter(|draw| !draw.blended) {
            draw.bind(&mut pass);
            pass.set_index_buffer(draw.triangles.slice(..), IndexFormat::Uint32);
            pass.draw_indexed(0..draw.count, 0, 0..1);
        }
        draw_blended(&mut pass, draws, blended);
    }
}

fn draw_blended(pass: &mut RenderPass<'_>, draws: &[SurfaceDraw], blended: &Blended) {
    for run in &blended.order.runs {
        draws[run.surface].bind(pass);
        pass.set_index_buffer(blended.indices.slice(..), IndexFormat::Uint32);
        pass.draw_indexed(run.indices.clone(), 0, 0..1);
    }
}

/// The format of a sample's image: 32-bit floats, or 16-bit ones if blending is needed and not supported for 32.
fn color_format(features: Features, blends: bool) -> TextureFormat {
    match blends && !features.contains(Features::FLOAT32_BLENDABLE) {
        true => TextureFormat::Rgba16Float,
        false => TextureFormat::Rgba32Float,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_can_be_sent_anywhere() {
        fn assert_send<T: Send>() {}
        assert_send::<GpuRenderer<'static>>();
    }

    #[test]
    fn floats_have_32_bits_unless_they_must_blend_and_cannot() {
        assert_eq!(color_format(Features::empty(), false), TextureFormat::Rgba32Float);
        assert_eq!(color_format(Features::empty(), true), TextureFormat::Rgba16Float);
        assert_eq!(color_format(Features::FLOAT32_BLENDABLE, true), TextureFormat::Rgba32Float);
    }
}
