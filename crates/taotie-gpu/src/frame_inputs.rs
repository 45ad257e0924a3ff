//! The inputs shared by all surfaces of an image: the camera, the lights, the environment, and the tables of albedos.

use crate::gpu::{Gpu, Result};
use crate::pipelines::{entry, storage, texture, uniform};
use crate::shadows::ShadowInputs;
use crate::textures::Texels2d;
use std::sync::Arc;
use taotie_engine::math::Mat4;
use taotie_engine::pixel::{LightSource, Turn};
use taotie_engine::render::{CheckedShot, EnvironmentLight, Eye, Lighting};
use taotie_engine::shade::dfg;
use taotie_engine::shade::environment::{Environment, EnvironmentMaps, HalfPicture};
use taotie_shader::{EnvironmentAtlas, FrameFactors, light_numbers, opaque};
use wgpu::{BindGroup, BindGroupLayout, BindingResource, Buffer, BufferUsages, TextureFormat, TextureView};

/// The inputs shared by all surfaces of an image: group 0.
pub(crate) struct FrameInputs {
    layout: BindGroupLayout,
    factors: Buffer,
    tables: TextureView,
    environment: EnvironmentInputs,
    shadows: ShadowInputs,
    light: FrameLight,
    group: BindGroup,
}

/// The lighting of an image as numbers.
struct FrameLight {
    ambient: taotie_engine::math::Vec3,
    turn: Turn<f32>,
    intensity: f32,
    lights: usize,
}

impl FrameInputs {
    /// Uploads the tables of albedos, without any lighting.
    ///
    /// # Errors
    /// If memory runs out.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        let layout = layout(gpu);
        let light = FrameLight::new(&Lighting::default());
        let empty = vec![0; light.factors().bytes().len()];
        let factors = gpu.buffer("the values of the image", &empty, BufferUsages::UNIFORM)?;
        let tables = tables(gpu)?;
        let environment = EnvironmentInputs::new(gpu, None)?;
        let lights = lights(gpu, &Lighting::default())?;
        let shadows = ShadowInputs::none(gpu)?;
        let parts = Parts {
            factors: &factors,
            lights: &lights,
            tables: &tables,
            environment: &environment,
            shadows: &shadows,
        };
        let group = parts.bind(gpu, &layout)?;
        Ok(Self { layout, factors, tables, environment, shadows, light, group })
    }

    /// The layout of group 0.
    pub(crate) fn layout(&self) -> &BindGroupLayout {
        &self.layout
    }

    /// The bindings of group 0.
    pub(crate) fn group(&self) -> &BindGroup {
        &self.group
    }

    /// Sets the shadow casters for the images whose [light](Self::light) comes next.
    pub(crate) fn cast(&mut self, shadows: ShadowInputs) {
        self.shadows = shadows;
    }

    /// Sets the lighting of an image. An environment is uploaded when it changes.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`] for an environment beyond the GPU's limits, or if memory runs out.
    pub(crate) fn light(&mut self, gpu: &Gpu, lighting: &Lighting) -> Result<()> {
        let environment = lighting.environment.as_ref().map(|light| &light.environment);
        if !self.environment.is_of(environment) {
            self.environment = EnvironmentInputs::new(gpu, environment)?;
        }
        self.light = FrameLight::new(lighting);
        let lights = lights(gpu, lighting)?;
        let parts = Parts {
            factors: &self.factors,
            lights: &lights,
            tables: &self.tables,
            environment: &self.environment,
            shadows: &self.shadows,
        };
        self.group = parts.bind(gpu, &self.layout)?;
        Ok(())
    }

    /// Sets the camera to one sample position of each pixel.
    pub(crate) fn see(&self, gpu: &Gpu, checked: &CheckedShot, sample: usize) {
        let size = [checked.settings.width, checked.settings.height];
        let offset = checked.pattern.offsets()[sample];
        let factors = FrameFactors {
            clip_from_world: shifted(&checked.clip_from_world, size, offset),
            eye: eye(&checked.eye),
            spacing: checked.pattern.spacing(),
            levels: self.environment.levels(),
            smoothest_alpha: self.environment.smoothest_alpha(),
            ..self.light.factors()
        };
        gpu.queue.write_buffer(&self.factors, 0, &factors.bytes());
    }
}

impl FrameLight {
    fn new(lighting: &Lighting) -> Self {
        let environment = lighting.environment.as_ref();
        let straight = Turn { sin: 0.0, cos: 1.0 };
        Self {
            ambient: lighting.ambient,
            turn: environment.map_or(straight, EnvironmentLight::turn),
            intensity: environment.map_or(0.0, |light| light.intensity),
            lights: lighting.lights.len(),
        }
    }

    /// The values of a frame before any camera is set.
    fn factors(&self) -> FrameFactors {
        FrameFactors {
            clip_from_world: [[0.0; 4]; 4],
            eye: [0.0; 4],
            ambient: self.ambient,
            spacing: 1.0,
            turn: self.turn,
            intensity: self.intensity,
            levels: 1,
            smoothest_alpha: 1.0,
            lights: self.lights,
        }
    }
}

/// The resources of group 0.
struct Parts<'a> {
    factors: &'a Buffer,
    lights: &'a Buffer,
    tables: &'a TextureView,
    environment: &'a EnvironmentInputs,
    shadows: &'a ShadowInputs,
}

impl Parts<'_> {
    fn bind(&self, gpu: &Gpu, layout: &BindGroupLayout) -> Result<BindGroup> {
        let resources = [
            self.factors.as_entire_binding(),
            self.lights.as_entire_binding(),
            BindingResource::TextureView(self.tables),
            BindingResource::TextureView(self.environment.maps()),
            self.environment.level_table().as_entire_binding(),
            BindingResource::TextureView(self.environment.picture()),
        ];
        let shadows = self.shadows.buffers().map(Buffer::as_entire_binding);
        let bind = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = (0..).zip(resources.into_iter().chain(shadows)).map(bind).collect();
        gpu.checked("the light of the image", || {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("frame"),
                layout,
                entries: &entries,
            })
        })
    }
}

/// The layout of group 0. It contains everything that some shader reads.
fn layout(gpu: &Gpu) -> BindGroupLayout {
    let light = [uniform(), storage(), texture(false), texture(false), uniform(), texture(false)];
    let types = light.into_iter().chain([storage(); ShadowInputs::COUNT]);
    let entries: Vec<_> = (0..).zip(types).map(|(binding, ty)| entry(binding, ty)).collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("frame"),
        entries: &entries,
    })
}

/// All lights; without any, a dummy that is never read.
fn lights(gpu: &Gpu, lighting: &Lighting) -> Result<Buffer> {
    let mut numbers: Vec<[f32; 16]> =
        lighting.lights.iter().map(|light| light_numbers(&LightSource::new(light))).collect();
    numbers.resize(numbers.len().max(1), [0.0; 16]);
    gpu.storage("the lights", bytemuck::cast_slice(&numbers))
}

/// The tables of directional albedos.
fn tables(gpu: &Gpu) -> Result<TextureView> {
    let texels = dfg::tables();
    let size = [dfg::COLUMNS as u32, (texels.len() / dfg::COLUMNS) as u32];
    let shape =
        Texels2d { what: "the tables of albedos", size, levels: 1, format: TextureFormat::Rgba32Float };
    shape.upload(gpu, |_| bytemuck::cast_slice(&texels).to_vec())
}

fn eye(eye: &Eye) -> [f32; 4] {
    match eye {
        Eye::Point(point) => [point.x, point.y, point.z, 1.0],
        Eye::Direction(direction) => [direction.x, direction.y, direction.z, 0.0],
    }
}

/// The columns of a clip-space matrix that moves the sample at `offset`, in 1/256 pixel from the top left corner of a
/// pixel, to the centre of the pixel. `size` in pixels.
fn shifted(clip_from_world: &Mat4, size: [u32; 2], offset: [i32; 2]) -> [[f32; 4]; 4] {
    let pixels = |axis: usize| (128.0 - f64::from(offset[axis])) / 256.0;
    let [right, down] = [0, 1].map(|axis| 2.0 * pixels(axis) / f64::from(size[axis]));
    clip_from_world
        .columns
        .map(|[x, y, z, w]| [x + w * right, y - w * down, z, w].map(|number| number as f32))
}

/// The images of an environment; black ones of one texel if there is none.
struct EnvironmentInputs {
    /// The environment that they show.
    shown: Option<Arc<Environment>>,
    maps: TextureView,
    table: Buffer,
    picture: TextureView,
    levels: usize,
    smoothest_alpha: f32,
}

impl EnvironmentInputs {
    /// Uploads an environment.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`], or if memory runs out.
    fn new(gpu: &Gpu, environment: Option<&Arc<Environment>>) -> Result<Self> {
        let maps = match environment {
            Some(environment) => environment.maps(),
            None => nothing(),
        };
        let atlas = EnvironmentAtlas::new(&maps);
        let size = atlas.size.map(|texels| texels as u32);
        Ok(Self {
            shown: environment.cloned(),
            maps: upload_halves(gpu, "the levels of the environment", size, &atlas.texels)?,
            table: gpu.buffer(
                "the levels of the environment",
                bytemuck::cast_slice(&atlas.table),
                BufferUsages::UNIFORM,
            )?,
            picture: upload_picture(gpu, &maps.picture)?,
            levels: maps.levels.len(),
            smoothest_alpha: maps.smoothest_alpha,
        })
    }

    /// Returns true if these are the images of `environment`.
    fn is_of(&self, environment: Option<&Arc<Environment>>) -> bool {
        match (&self.shown, environment) {
            (Some(shown), Some(wanted)) => Arc::ptr_eq(shown, wanted),
            (shown, wanted) => shown.is_none() == wanted.is_none(),
        }
    }

    /// All levels in one image.
    fn maps(&self) -> &TextureView {
        &self.maps
    }

    /// The positions and factors of the levels.
    fn level_table(&self) -> &Buffer {
        &self.table
    }

    /// The equirectangular image.
    fn picture(&self) -> &TextureView {
        &self.picture
    }

    /// The number of levels.
    fn levels(&self) -> usize {
        self.levels
    }

    /// Roughness² of the smoothest level.
    fn smoothest_alpha(&self) -> f32 {
        self.smoothest_alpha
    }
}

/// The texels without an environment: a single black one, with its border.
const BLACK: [[u16; 3]; 9] = [[0; 3]; 9];

fn nothing() -> EnvironmentMaps<'static> {
    let black =
        |side: usize| HalfPicture { width: side, height: side, texels: &BLACK[..side * side], factor: 1.0 };
    EnvironmentMaps { levels: vec![black(3)], smoothest_alpha: 1.0, picture: black(1) }
}

fn upload_halves(gpu: &Gpu, what: &str, size: [u32; 2], texels: &[[u16; 4]]) -> Result<TextureView> {
    let shape = Texels2d { what, size, levels: 1, format: TextureFormat::Rgba16Float };
    shape.upload(gpu, |_| bytemuck::cast_slice(texels).to_vec())
}

fn upload_picture(gpu: &Gpu, picture: &HalfPicture<'_>) -> Result<TextureView> {
    let size = [picture.width as u32, picture.height as u32];
    let texels: Vec<[u16; 4]> = picture.texels.iter().map(opaque).collect();
    upload_halves(gpu, "the image of the environment", size, &texels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::Vec3;

    #[test]
    fn samples_come_to_the_middle_of_their_pixel() {
        let mut m = Mat4::IDENTITY;
        // w = 2 + z
        m.columns[2][3] = 1.0;
        m.columns[3][3] = 2.0;
        let at = |columns: [[f32; 4]; 4], p: Vec3<f64>| {
            let m = Mat4 { columns: columns.map(|column| column.map(f64::from)) };
            let [x, y, _, w] = m.transform_homogeneous(p);
            [(x / w * 0.5 + 0.5) * 200.0, (0.5 - y / w * 0.5) * 100.0]
        };
        let p = Vec3::new(0.3, -0.4, 0.7);
        let middle = at(shifted(&m, [200, 100], [128, 128]), p);
        let moved = at(shifted(&m, [200, 100], [96, 224]), p);
        assert!((moved[0] - middle[0] - 32.0 / 256.0).abs() < 1e-4, "{middle:?} {moved:?}");
        assert!((moved[1] - middle[1] + 96.0 / 256.0).abs() < 1e-4, "{middle:?} {moved:?}");
    }
}
