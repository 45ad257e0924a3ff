//! An environment on a graphics processor.

use crate::atlas::Atlas;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::textures::Texels2d;
use half::f16;
use std::sync::Arc;
use taotie::shade::environment::{Environment, EnvironmentMaps, HalfPicture};
use taotie_shader::MOST_LEVELS;
use wgpu::{Buffer, BufferUsages, TextureFormat, TextureView};

/// The pictures of an environment; black ones of one texel where there is none.
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
    /// [`crate::GpuError::TooLarge`]; where there is no memory for it.
    pub(crate) fn new(gpu: &Gpu, environment: Option<&Arc<Environment>>) -> Result<Self> {
        let maps = match environment {
            Some(environment) => environment.maps(),
            None => nothing(),
        };
        let levels = LevelAtlas::new(&maps);
        Ok(Self {
            shown: environment.cloned(),
            maps: levels.upload(gpu, &maps.levels)?,
            table: gpu.buffer(
                "the levels of the environment",
                bytemuck::cast_slice(&levels.table),
                BufferUsages::UNIFORM,
            )?,
            picture: upload_picture(gpu, &maps.picture)?,
            levels: maps.levels.len(),
            smoothest_alpha: maps.smoothest_alpha,
        })
    }

    /// Says whether this is what `environment` looks like.
    pub(crate) fn is_of(&self, environment: Option<&Arc<Environment>>) -> bool {
        match (&self.shown, environment) {
            (Some(shown), Some(wanted)) => Arc::ptr_eq(shown, wanted),
            (shown, wanted) => shown.is_none() == wanted.is_none(),
        }
    }

    /// All levels in one picture.
    pub(crate) fn maps(&self) -> &TextureView {
        &self.maps
    }

    /// The places and factors of the levels.
    pub(crate) fn level_table(&self) -> &Buffer {
        &self.table
    }

    /// The equirectangular picture.
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

/// The texels of no environment: one black one, with its border.
const BLACK: [[u16; 3]; 9] = [[0; 3]; 9];

fn nothing() -> EnvironmentMaps<'static> {
    let black =
        |side: usize| HalfPicture { width: side, height: side, texels: &BLACK[..side * side], factor: 1.0 };
    EnvironmentMaps { levels: vec![black(3)], smoothest_alpha: 1.0, picture: black(1) }
}

/// The levels of an environment side by side.
struct LevelAtlas {
    atlas: Atlas,
    /// Column and row of each level's first texel, its side without the border, and its factor; the last row has the
    /// factor of the picture itself.
    table: [[f32; 4]; MOST_LEVELS],
}

impl LevelAtlas {
    fn new(maps: &EnvironmentMaps<'_>) -> Self {
        let sides: Vec<u32> = maps.levels.iter().map(|level| level.width as u32).collect();
        let atlas = Atlas::new(&sides);
        let mut table = [[0.0; 4]; MOST_LEVELS];
        for ((row, [x, y]), level) in table.iter_mut().zip(&atlas.places).zip(&maps.levels) {
            *row = [*x as f32, *y as f32, (level.width - 2) as f32, level.factor];
        }
        table[MOST_LEVELS - 1][3] = maps.picture.factor;
        Self { atlas, table }
    }

    fn upload(&self, gpu: &Gpu, levels: &[HalfPicture<'_>]) -> Result<TextureView> {
        let [width, height] = self.atlas.size.map(|side| side as usize);
        let mut texels = vec![[0u16; 4]; width * height];
        for ([x, y], level) in self.atlas.places.iter().zip(levels) {
            let rows = texels.chunks_exact_mut(width).skip(*y as usize);
            for (row, from) in rows.zip(level.texels.chunks_exact(level.width)) {
                for (texel, color) in row[*x as usize..].iter_mut().zip(from) {
                    *texel = opaque(color);
                }
            }
        }
        upload_halves(gpu, "the levels of the environment", self.atlas.size, &texels)
    }
}

/// A texel with alpha 1.
fn opaque([r, g, b]: &[u16; 3]) -> [u16; 4] {
    [*r, *g, *b, f16::ONE.to_bits()]
}

fn upload_halves(gpu: &Gpu, what: &str, size: [u32; 2], texels: &[[u16; 4]]) -> Result<TextureView> {
    let shape = Texels2d { what, size, levels: 1, format: TextureFormat::Rgba16Float };
    shape.upload(gpu, |_| bytemuck::cast_slice(texels).to_vec())
}

fn upload_picture(gpu: &Gpu, picture: &HalfPicture<'_>) -> Result<TextureView> {
    let size = [picture.width as u32, picture.height as u32];
    let texels: Vec<[u16; 4]> = picture.texels.iter().map(opaque).collect();
    upload_halves(gpu, "the picture of the environment", size, &texels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::image::Image;

    #[test]
    fn every_level_has_a_place_and_a_factor() {
        let picture = Image::new(16, 8, [0.5, 0.25, 2.0, 1.0]).unwrap();
        let environment = Environment::new(picture).unwrap();
        let maps = environment.maps();
        assert!(maps.levels.len() < MOST_LEVELS, "{} levels", maps.levels.len());
        let LevelAtlas { table, .. } = LevelAtlas::new(&maps);
        assert_eq!(table[MOST_LEVELS - 1], [0.0, 0.0, 0.0, maps.picture.factor]);
        for (i, ([.., side, factor], level)) in table.iter().zip(&maps.levels).enumerate() {
            assert_eq!((*side as usize + 2, level.texels.len()), (level.width, level.width * level.height));
            let [_, green, blue] = level.texels[0].map(|half| f16::from_bits(half).to_f32() * factor);
            assert!((green - 0.25).abs() < 1e-3 && (blue - 2.0).abs() < 1e-2, "{i}: {green} {blue}");
        }
    }
}
