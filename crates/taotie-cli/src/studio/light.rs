//! The options of light.

use crate::{console, options};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueHint};
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie::Limits;
use taotie::studio::{EnvironmentOptions, EnvironmentSource, LightOptions, LightSpec, View};
use taotie_engine::Warnings;
use taotie_engine::math::Vec3;
use taotie_engine::render::{EnvironmentLight, Lighting};
use taotie_engine::scene::Scene;

/// The light.
#[derive(Args)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// A light: `point at=X,Y,Z`, `spot at=X,Y,Z toward=X,Y,Z angle=DEG` (from its axis), or `directional
    /// from=AZIMUTH,ELEVATION` (degrees, relative to the view), each with strength=, color=, falloff=none|inverse-square; may be repeated
    /// [default: the file's lights, otherwise key, fill and rim]
    #[arg(long = "light", value_name = "SPEC")]
    pub lights: Vec<String>,
    /// Ambient light: radiance from all around, a colour or a linear grey value
    #[arg(long, value_name = "COLOR", value_parser = options::color)]
    pub ambient: Option<Vec3>,
    /// Let lights cast shadows
    #[arg(long)]
    pub shadows: bool,
    /// Environment light: `studio` (built in), an equirectangular .hdr or .exr, or `none`. With one, only the lights
    /// of --light and of the file are added
    #[arg(long, value_name = "FILE|studio|none", value_hint = ValueHint::FilePath)]
    pub env: Option<String>,
    /// Turn the environment counterclockwise as seen from above, degrees
    #[arg(long, value_name = "DEG", value_parser = options::number, allow_negative_numbers = true)]
    pub env_rotate_deg: Option<f64>,
    /// Factor of the environment's light [default: 1]
    #[arg(long, value_name = "X", value_parser = options::number)]
    pub env_intensity: Option<f64>,
    /// Show the environment behind the model
    #[arg(long)]
    pub show_env: bool,
}

impl LightArgs {
    /// Rejects invalid values, before any work is done.
    pub fn check(&self) -> Result<()> {
        let of_environment = [
            ("--show-env", self.show_env),
            ("--env-rotate-deg", self.env_rotate_deg.is_some()),
            ("--env-intensity", self.env_intensity.is_some()),
        ];
        let given = of_environment.iter().find(|(_, given)| *given);
        if let (Some((option, _)), None) = (given, self.environment_name()) {
            bail!("{option}: there is no environment; add --env studio or --env FILE.hdr");
        }
        match self.env_intensity {
            Some(factor) if factor < 0.0 => bail!("--env-intensity {factor}: it must be 0 or more"),
            _ => Ok(()),
        }
    }

    /// Adds a warning for shadows that no light casts.
    pub fn note_unread(&self, scene: &Scene, warnings: &mut Warnings) {
        let only_environment = self.environment_name().is_some() && self.lights.is_empty();
        if self.shadows && only_environment && scene.lights().is_empty() {
            warnings.note("--shadows has no effect: the environment is the only light", 1);
        }
    }

    fn rotation_deg(&self) -> f64 {
        self.env_rotate_deg.unwrap_or(0.0)
    }

    fn intensity(&self) -> f64 {
        self.env_intensity.unwrap_or(1.0)
    }

    /// Returns the studio or a file; `None` without an environment.
    fn environment_name(&self) -> Option<&str> {
        self.env.as_deref().filter(|name| EnvironmentSource::named(name).is_some())
    }

    /// Returns the file of the environment; `None` for the studio or without an environment.
    pub fn environment_file(&self) -> Option<PathBuf> {
        match self.env.as_deref().and_then(EnvironmentSource::named) {
            Some(EnvironmentSource::File(path)) => Some(path),
            _ => None,
        }
    }

    /// Reads the requested environment and filters it, or takes it from the cache.
    ///
    /// # Errors
    /// Those of the file.
    pub fn environment(&self, limits: &Limits, warnings: &mut Warnings) -> Result<Option<EnvironmentLight>> {
        let options = EnvironmentOptions {
            source: self.env.as_deref().and_then(EnvironmentSource::named),
            rotation: self.rotation_deg().to_radians(),
            intensity: self.intensity(),
            visible: self.show_env,
        };
        options.load_within(limits, warnings).context("--env")
    }

    /// Returns the environment for reports; `None` if there is none.
    pub fn environment_report(&self) -> Option<EnvironmentReport> {
        self.environment_name().map(|name| EnvironmentReport {
            name: console::name_of(Path::new(name)),
            rotate_deg: self.rotation_deg(),
            intensity: self.intensity(),
            seen: self.show_env,
        })
    }

    /// Returns the requested lights.
    ///
    /// # Errors
    /// If a light cannot be parsed.
    fn options(&self) -> Result<LightOptions> {
        let light = |line: &String| {
            line.parse::<LightSpec>()
                .map_err(|error| options::under(format_args!("--light \"{line}\""), error))
        };
        let lights = self.lights.iter().map(light).collect::<Result<_>>()?;
        let options = LightOptions { lights, ambient: self.ambient };
        options.check()?;
        Ok(options)
    }
}

/// The environment of a picture, for reports.
#[derive(Serialize)]
pub struct EnvironmentReport {
    /// `studio`, or the name of its file, without folders.
    name: String,
    /// Its rotation about the vertical axis, degrees.
    rotate_deg: f64,
    /// The factor of its light.
    intensity: f64,
    /// `true` if it is visible behind the model.
    seen: bool,
}

/// Returns the light on a scene in this view.
pub fn lighting(
    args: &LightArgs,
    environment: Option<&EnvironmentLight>,
    scene: &Scene,
    view: View<'_>,
) -> Result<Lighting> {
    Ok(args.options()?.lighting(environment, scene, view))
}
