//! The options of `taotie shader`.

use super::target::Target;
use crate::limits::LimitArgs;
use crate::studio::{ReflectionArgs, SurfaceArgs};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie::render::RenderSettings;
use taotie::studio::{EnvironmentOptions, EnvironmentSource, MaterialOptions};

const EXAMPLES: &str = "\
Examples:
  taotie shader --shading cook-torrance --surface tangent-normal --target wgsl -o shaders
  taotie shader model.glb --target glsl-es -o model-shaders
  taotie shader model.glb --material 0 --env studio --target spirv -o model-spirv

Writes the shader of each material with a .json of its bindings and values, the tables of albedos that it \
reads, and index.html, which says how to bind all that.";

/// Writes the shaders of a model's materials, or of a plain one, as `taotie render` computes them.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct ShaderArgs {
    /// The model: .gltf, .glb, .obj, .ply or .stl; a plain material if not given
    pub model: Option<PathBuf>,
    /// The folder to write to; made where it is not there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Language of the shaders
    #[arg(long, value_enum)]
    pub target: Target,
    /// The material of the model, by name or by number from 0; every one that is used if not given
    #[arg(long, value_name = "NAME|N", requires = "model")]
    pub material: Option<String>,
    /// Material variant of the file (KHR_materials_variants)
    #[arg(long, value_name = "NAME", requires = "model")]
    pub variant: Option<String>,

    #[command(flatten)]
    pub surface: SurfaceArgs,
    #[command(flatten)]
    pub reflection: ReflectionArgs,
    /// Environment light, whose maps are written too: `studio`, which is built in, an equirectangular .hdr or .exr, or
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
    /// Refuses options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        self.reflection.check(&[self.surface.shading])?;
        if self.model.is_none() && self.surface.bump_scale.is_some() {
            bail!("--bump-scale: without a model there are no heights; name one");
        }
        self.surface.check(None)
    }

    /// Returns the files that are named to be read.
    pub fn sources(&self) -> impl Iterator<Item = PathBuf> {
        let environment = match self.environment().source {
            Some(EnvironmentSource::File(path)) => Some(path),
            Some(EnvironmentSource::Studio) | None => None,
        };
        self.model.clone().into_iter().chain(environment)
    }

    /// Returns the environment asked for.
    pub fn environment(&self) -> EnvironmentOptions {
        let source = self.env.as_deref().and_then(EnvironmentSource::named);
        EnvironmentOptions { source, ..EnvironmentOptions::default() }
    }

    /// Returns the materials asked for.
    pub fn materials(&self) -> MaterialOptions {
        MaterialOptions { variant: self.variant.clone(), ..MaterialOptions::default() }
    }

    /// Returns the settings that `taotie render` has with the same options.
    pub fn settings(&self) -> RenderSettings {
        self.reflection.apply(self.surface.settings())
    }
}
