//! The options of `taotie shader`, and the languages that shaders are written in.

use super::files::NamedFile;
use crate::running::LimitArgs;
use crate::studio::{ReflectionArgs, SurfaceArgs};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use taotie::studio::{EnvironmentOptions, EnvironmentSource, MaterialOptions};
use taotie_engine::render::RenderSettings;
use taotie_shader::{Language, PixelShader, Variant, pixel_shader};

const EXAMPLES: &str = "\
Examples:
  taotie shader --shading cook-torrance --surface tangent-normal --target wgsl -o shaders
  taotie shader model.glb --target glsl-es -o model-shaders
  taotie shader model.glb --material 0 --env studio --target spirv -o model-spirv

Writes the shader of each material with a .json of its bindings and values, the albedo tables that it \
reads, and index.html, which explains how to bind them.";

/// Writes the shaders of a model's materials, or of a plain one, as `taotie render` computes them.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct ShaderArgs {
    /// The model: .gltf, .glb, .obj, .ply, .stl or .fbx [default: a plain material]
    pub model: Option<PathBuf>,
    /// Folder to write to; created if missing
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Language of the shaders
    #[arg(long, value_enum)]
    pub target: Target,
    /// The material of the model, by name or by number from 0 [default: every one that is used]
    #[arg(long, value_name = "NAME|N", requires = "model")]
    pub material: Option<String>,
    /// Material variant of the file (KHR_materials_variants)
    #[arg(long, value_name = "NAME", requires = "model")]
    pub variant: Option<String>,

    #[command(flatten)]
    pub surface: SurfaceArgs,
    #[command(flatten)]
    pub reflection: ReflectionArgs,
    /// Environment light, whose maps are also written: `studio` (built in), an equirectangular .hdr or .exr, or
    /// `none`
    #[arg(long, value_name = "FILE|studio|none", help_heading = "Light")]
    pub env: Option<String>,

    #[command(flatten)]
    pub limits: LimitArgs,
    /// Print a report as JSON
    #[arg(long, help_heading = "Running")]
    pub json: bool,
}

impl ShaderArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        self.reflection.check(&[self.surface.shading])?;
        if self.model.is_none() && self.surface.bump_scale.is_some() {
            bail!("--bump-scale: there are no heights without a model; name one");
        }
        self.surface.check(None)
    }

    /// Returns the input files.
    pub fn sources(&self) -> impl Iterator<Item = PathBuf> {
        let environment = match self.environment().source {
            Some(EnvironmentSource::File(path)) => Some(path),
            Some(EnvironmentSource::Studio) | None => None,
        };
        self.model.clone().into_iter().chain(environment)
    }

    /// Returns the requested environment.
    pub fn environment(&self) -> EnvironmentOptions {
        let source = self.env.as_deref().and_then(EnvironmentSource::named);
        EnvironmentOptions { source, ..EnvironmentOptions::default() }
    }

    /// Returns the requested materials.
    pub fn materials(&self) -> MaterialOptions {
        MaterialOptions { variant: self.variant.clone(), ..MaterialOptions::default() }
    }

    /// Returns the settings that `taotie render` has with the same options.
    pub fn settings(&self) -> RenderSettings {
        self.reflection.apply(self.surface.settings())
    }
}

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
            || translation(self, &shader).with_context(|| format!("the shader `{name}` in {}", self.name()));
        let files = match self {
            Self::Wgsl => vec![file("wgsl", text())],
            Self::GlslEs => {
                let vertex = shader.vertex_text.clone().unwrap_or_default();
                vec![file("frag", text()), file("vert", vertex.into_bytes())]
            }
            Self::Hlsl => vec![file("hlsl", translated()?)],
            Self::Msl => vec![file("metal", translated()?)],
            Self::Spirv => vec![file("spv", translated()?)],
        };
        Ok(Written { shader, files })
    }
}

/// Returns a WGSL shader in a language that it can be translated to.
#[cfg(not(target_family = "wasm"))]
fn translation(target: Target, shader: &PixelShader) -> Result<Vec<u8>> {
    use taotie_shader::{Translation, translate};
    let to = match target {
        Target::Hlsl => Translation::Hlsl,
        Target::Msl => Translation::Msl,
        Target::Spirv => Translation::SpirV,
        Target::Wgsl | Target::GlslEs => bail!("it is not translated"),
    };
    Ok(translate(shader, to)?)
}

/// The compiler of shaders is an eighth of what browsers would have to load.
#[cfg(target_family = "wasm")]
fn translation(_: Target, _: &PixelShader) -> Result<Vec<u8>> {
    bail!("not in the WebAssembly module; use wgsl or glsl-es, or the native program")
}
