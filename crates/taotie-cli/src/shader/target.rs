//! The languages that shaders are written in.

use anyhow::Result;
use clap::ValueEnum;
use taotie_shader::{Language, PixelShader, Translation, Variant, pixel_shader, translate};

/// A language of shaders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// WebGPU
    Wgsl,
    /// GLSL ES 3.00, of WebGL 2; with a module that makes materials of three.js
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
    /// The shader that it was made of.
    pub shader: PixelShader,
    /// The end of each file's name, and its content.
    pub files: Vec<(&'static str, Vec<u8>)>,
}

impl Target {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::GlslEs => "glsl-es",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
            Self::Spirv => "spirv",
        }
    }

    /// Writes the shader of a variant.
    pub fn write(self, variant: &Variant) -> Result<Written> {
        let language = if self == Self::GlslEs { Language::GlslEs } else { Language::Wgsl };
        let shader = pixel_shader(variant, language);
        let text = || shader.text.clone().into_bytes();
        let files = match self {
            Self::Wgsl => vec![("wgsl", text())],
            Self::GlslEs => {
                let vertex = shader.vertex_text.clone().unwrap_or_default();
                vec![("frag", text()), ("vert", vertex.into_bytes())]
            }
            Self::Hlsl => vec![("hlsl", translate(&shader, Translation::Hlsl)?)],
            Self::Msl => vec![("metal", translate(&shader, Translation::Msl)?)],
            Self::Spirv => vec![("spv", translate(&shader, Translation::SpirV)?)],
        };
        Ok(Written { shader, files })
    }
}
