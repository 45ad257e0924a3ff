//! An environment on a GPU.

use crate::error::Result;
use crate::gpu::Gpu;
use crate::textures::Texels2d;
use std::sync::Arc;
use taotie_engine::shade::environment::{Environment, EnvironmentMaps, HalfPicture};
use taotie_shader::{EnvironmentAtlas, opaque};
use wgpu::{Buffer, BufferUsages, TextureFormat, TextureView};

/// The images of an environment; black ones of one texel if there is none.
pub(crate) struct EnvironmentInputs {
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
    pub(crate) fn new(gpu: &Gpu, environment: Option<&Arc<Environment>>) -> Result<Self> {
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
    pub(crate) fn is_of(&self, environment: Option<&Arc<Environment>>) -> bool {
        match (&self.shown, environment) {
            (Some(shown), Some(wanted)) => Arc::ptr_eq(shown, wanted),
            (shown, wanted) => shown.is_none() == wanted.is_none(),
        }
    }

    /// All levels in one image.
    pub(crate) fn maps(&self) -> &TextureView {
        &self.maps
    }

    /// The positions and factors of the levels.
    pub(crate) fn level_table(&self) -> &Buffer {
        &self.table
    }

    /// The equirectangular image.
    pub(crate) fn picture(&self) -> &TextureView {
        &self.picture
    }

    /// The number of levels.
    pub(crate) fn levels(&self) -> usize {
        self.levels
    }

    /// Roughness² of the smoothest level.
    pub(crate) fn smoothest_alpha(&self) -> f32 {
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
