//! The languages that shaders are written in.

use super::file::NamedFile;
use anyhow::{Context, Result};
use clap::ValueEnum;
use taotie_shader::{Language, PixelShader, Translation, Variant, pixel_shader, translate};

/// A language of shaders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// WebGPU
    Wgsl,
    /// GLSL ES 3.00 for WebGL 2, with a module that makes three.js materials
    GlslEs,
    /// Direct3D: shader model 5.1
    Hlsl,
    /// Metal
    Msl,
    /// Vulkan: SPIR-V 1.0
    Spirv,
}

/// A shader in its language.
pub struct Written {
    /// The shader that it was made from.
    pub shader: PixelShader,
    /// Its files.
    pub files: Vec<NamedFile>,
}

impl Target {
    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::GlslEs => "glsl-es",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
            Self::Spirv => "spirv",
        }
    }

    /// Writes the shader of a variant to files that begin with `name`.
    pub fn write(self, variant: &Variant, name: &str) -> Result<Written> {
        let language = if self == Self::GlslEs { Language::GlslEs } else { Language::Wgsl };
        let shader = pixel_shader(variant, language);
        let file = |end: &str, bytes: Vec<u8>| NamedFile::new(format!("{name}.{end}"), bytes);
        let text = || shader.text.clone().into_bytes();
        let translated =
            |to| translate(&shader, to).with_context(|| format!("the shader `{name}` in {}", self.name()));
        let files = match self {
            Self::Wgsl => vec![file("wgsl", text())],
            Self::GlslEs => {
                let vertex = shader.vertex_text.clone().unwrap_or_default();
                vec![file("frag", text()), file("vert", vertex.into_bytes())]
            }
            Self::Hlsl => vec![file("hlsl", translated(Translation::Hlsl)?)],
            Self::Msl => vec![file("metal", translated(Translation::Msl)?)],
            Self::Spirv => vec![file("spv", translated(Translation::SpirV)?)],
        };
        Ok(Written { shader, files })
    }
}
