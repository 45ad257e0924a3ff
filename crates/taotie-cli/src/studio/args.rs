//! The options of light, camera and film, shared by the subcommands that render a model.

use crate::limits::LimitArgs;
use crate::running::RunArgs;
use crate::{console, options};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use serde_json::json;
use std::path::{Path, PathBuf};
use taotie::asset::Limits;
use taotie::studio::{CameraOptions, EnvironmentOptions, EnvironmentSource, LightOptions, LightSpec};
use taotie_engine::Warnings;
use taotie_engine::film::{Development, ToneCurve};
use taotie_engine::math::{SimdLevel, Vec3};
use taotie_engine::render::EnvironmentLight;
use taotie_engine::scene::Scene;

/// The light.
#[derive(Args)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// A light: `point at=X,Y,Z`, `spot at=X,Y,Z toward=X,Y,Z angle=DEG`, or `directional from=AZIMUTH,ELEVATION`
    /// (degrees, relative to the view), each with strength=, color=, falloff=none|inverse-square; may be repeated
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
    #[arg(long, value_name = "FILE|studio|none")]
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

    /// Returns the environment as JSON for reports; null if there is none.
    pub fn environment_json(&self) -> serde_json::Value {
        match self.environment_name() {
            None => serde_json::Value::Null,
            Some(name) => json!({
                "name": console::name_of(Path::new(name)),
                "rotate_deg": self.rotation_deg(),
                "intensity": self.intensity(),
                "seen": self.show_env,
            }),
        }
    }

    /// Returns the requested lights.
    ///
    /// # Errors
    /// If a light cannot be parsed.
    pub fn options(&self) -> Result<LightOptions> {
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

/// The camera.
#[derive(Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArgs {
    /// A camera of the file by name
    #[arg(long, value_name = "NAME", conflicts_with = "orbit")]
    pub camera: Option<String>,
    /// Look from AZIMUTH,ELEVATION in degrees at DIST in model units; without DIST the object fills the picture
    #[arg(long, value_name = "AZ,EL[,DIST]", value_parser = options::numbers, allow_hyphen_values = true)]
    pub orbit: Option<std::vec::Vec<f64>>,
    /// Point to look at [default: the object's centre]
    #[arg(long, value_name = "X,Y,Z", value_parser = options::vector, allow_hyphen_values = true, conflicts_with = "camera")]
    pub target: Option<Vec3<f64>>,
    /// Vertical field of view, degrees
    #[arg(long, value_name = "DEG", value_parser = options::number, default_value = "30", conflicts_with = "camera")]
    pub fov_deg: f64,
}

impl CameraArgs {
    /// Returns the requested camera.
    ///
    /// # Errors
    /// If the orbit has too few or too many numbers.
    pub fn options(&self) -> Result<CameraOptions> {
        let framed = CameraOptions {
            name: self.camera.clone(),
            target: self.target,
            fov_y: self.fov_deg.to_radians(),
            ..CameraOptions::default()
        };
        let (degrees, distance) = match self.orbit.as_deref() {
            None => return Ok(framed),
            Some([azimuth, elevation]) => ([*azimuth, *elevation], None),
            Some([azimuth, elevation, distance]) if *distance > 0.0 => {
                ([*azimuth, *elevation], Some(*distance))
            }
            Some(_) => bail!(
                "--orbit: expected AZIMUTH,ELEVATION or AZIMUTH,ELEVATION,DISTANCE with a distance above 0"
            ),
        };
        let [azimuth, elevation] = degrees.map(f64::to_radians);
        Ok(CameraOptions { azimuth, elevation, distance, ..framed })
    }

    /// Rejects invalid values, before any work is done.
    pub fn check(&self) -> Result<()> {
        if !(self.fov_deg > 0.0 && self.fov_deg < 180.0) {
            bail!("--fov-deg {}: the angle must be between 0 and 180 degrees", self.fov_deg);
        }
        Ok(())
    }
}

/// The default background.
const BACKGROUND: &str = "#2a2b2e";

/// The development of a picture from light.
#[derive(Args)]
#[command(next_help_heading = "Picture")]
pub struct FilmArgs {
    /// Samples per pixel: 1, 4 or 16 [default: 4]
    #[arg(long, value_name = "N")]
    pub samples: Option<u32>,
    /// Tone curve: neutral, linear, reinhard, aces, agx [default: neutral]
    #[arg(long, value_parser = options::named::<ToneCurve>)]
    pub tone: Option<ToneCurve>,
    /// Exposure in stops [default: 0]
    #[arg(long, value_name = "STOPS", value_parser = options::number, allow_negative_numbers = true)]
    pub exposure: Option<f64>,
    /// Background: a colour or `transparent` [default: #2a2b2e]
    #[arg(long, value_name = "COLOR|transparent")]
    pub background: Option<String>,
}

impl FilmArgs {
    /// Rejects invalid values, before any work is done, and a background if the environment `is_shown`.
    pub fn check(&self, is_shown: bool) -> Result<()> {
        taotie_engine::raster::SamplePattern::new(self.samples())?;
        self.background()?;
        if is_shown && self.background.is_some() {
            bail!("--background: --show-env shows the environment there; leave one of them out");
        }
        Ok(())
    }

    /// Returns the samples per pixel.
    pub fn samples(&self) -> u32 {
        self.samples.unwrap_or(4)
    }

    /// Returns the settings of the development.
    pub fn development(&self, simd: SimdLevel) -> Result<Development> {
        let exposure_stops = self.exposure.unwrap_or(0.0) as f32;
        Ok(Development { exposure_stops, tone: self.tone(), background: self.background()?, simd })
    }

    /// Returns the tone curve.
    pub fn tone(&self) -> ToneCurve {
        self.tone.unwrap_or_default()
    }

    /// Rejects options that only a developed picture has, unless their values leave light unchanged.
    pub fn check_linear(&self) -> Result<()> {
        let given = [
            ("--tone", self.tone.is_some_and(|tone| tone != ToneCurve::Linear)),
            ("--exposure", self.exposure.is_some_and(|stops| stops != 0.0)),
            ("--background", self.background.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => {
                bail!("{option}: an .exr stores undeveloped linear light; leave it out, or write a .png")
            }
            None => Ok(()),
        }
    }

    fn background(&self) -> Result<Option<Vec3>> {
        match self.background.as_deref().unwrap_or(BACKGROUND) {
            "transparent" => Ok(None),
            color => options::color(color).map(Some).map_err(|why| anyhow!("--background: {why}")),
        }
    }
}

/// Threads, SIMD level and output.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct RunningArgs {
    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub run: RunArgs,
    /// SIMD level: auto, scalar, sse2, avx2, avx512, neon. Pixels do not depend on it
    #[arg(long, value_parser = options::named::<SimdLevel>, default_value = "auto")]
    pub simd: SimdLevel,
}

impl RunningArgs {
    /// Rejects invalid values, before any work is done.
    pub fn check(&self) -> Result<()> {
        self.simd.check()?;
        Ok(())
    }
}
