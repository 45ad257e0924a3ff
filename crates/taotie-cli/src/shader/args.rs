//! The options of `taotie shader`.

use super::target::Target;
use crate::limits::LimitArgs;
use crate::options;
use crate::studio::ReflectionArgs;
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie::names::Named;
use taotie::render::{RenderSettings, SurfaceSettings};
use taotie::shade::Shading;
use taotie::studio::{EnvironmentOptions, EnvironmentSource, MaterialOptions};
use taotie::surface::SurfaceMethod;

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

    /// Reflectance model: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or
    /// cook-torrance-printed, blinn-phong-printed, ggx-printed
    #[arg(long, value_parser = options::named::<Shading>, default_value = "ggx", help_heading = "Surface")]
    pub shading: Shading,
    /// Source of the shading normals: facet, smooth, bump, bump-printed, object-normal, tangent-normal; if not given the
    /// best that the material provides, and smooth without a model
    #[arg(long, value_parser = options::named::<SurfaceMethod>, help_heading = "Surface")]
    pub surface: Option<SurfaceMethod>,
    /// Height of white for `bump`, model units; for `bump-printed` the factor s of Guo and Wang 2025, which has no unit
    #[arg(long, value_name = "X", value_parser = options::number, allow_negative_numbers = true, requires = "model", help_heading = "Surface")]
    pub bump_scale: Option<f64>,
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
        self.reflection.check(&[self.shading])?;
        let bumps = matches!(self.surface, None | Some(SurfaceMethod::Bump | SurfaceMethod::BumpPrinted));
        match self.surface {
            Some(surface) if self.bump_scale.is_some() && !bumps => {
                bail!("--bump-scale: --surface {} does not read it; leave one of them out", surface.name())
            }
            _ => Ok(()),
        }
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
        self.reflection.apply(RenderSettings {
            shading: self.shading,
            surface: SurfaceSettings {
                method: self.surface,
                bump_scale: self.bump_scale.map(|scale| scale as f32),
                ..SurfaceSettings::default()
            },
            ..RenderSettings::default()
        })
    }
}
