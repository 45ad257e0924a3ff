//! The options of the camera and its film: the viewpoint of a picture, whose errors name the option behind it, and
//! the development of the picture.

use crate::options;
use anyhow::{Error, Result, anyhow, bail};
use clap::Args;
use taotie::studio::{self, CameraOptions, Framing, Motion, View};
use taotie_engine::film::{Development, ToneCurve};
use taotie_engine::math::{SimdLevel, Vec3};
use taotie_engine::scene::{Camera, Scene};

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
    fn options(&self) -> Result<CameraOptions> {
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

/// A camera that can be turned about the vertical through its target.
pub struct Viewpoint(studio::Viewpoint);

impl Viewpoint {
    /// Chooses the requested camera: one of the file by name, an orbit, otherwise one that frames the object.
    pub fn choose(args: &CameraArgs, framing: Framing, scene: &Scene) -> Result<Self> {
        check(args, scene)?;
        let chosen = studio::Viewpoint::choose(&args.options()?, framing, scene);
        chosen.map(Self).map_err(|error| of_option(args, error))
    }

    /// Like [`Viewpoint::choose`], but frames the whole extent of the object's motion.
    pub fn choose_moving(
        args: &CameraArgs,
        framing: Framing,
        scene: &mut Scene,
        motion: &Motion,
    ) -> Result<Self> {
        check(args, scene)?;
        let chosen = studio::Viewpoint::choose_moving(&args.options()?, framing, scene, motion);
        chosen.map(Self).map_err(|error| of_option(args, error))
    }

    /// Follows a moving camera of the file, if one was requested.
    pub fn follow(&mut self, args: &CameraArgs, scene: &Scene) -> Result<()> {
        self.0.follow(&args.options()?, scene).map_err(|error| of_option(args, error))
    }

    /// Returns the view after the object has turned by `turn` radians, as on a turntable.
    pub fn at(&self, turn: f64) -> View<'_> {
        self.0.at(turn)
    }

    /// Returns the camera after the object has turned by `turn` radians.
    pub fn camera(&self, turn: f64) -> Camera {
        self.at(turn).camera()
    }
}

fn check(args: &CameraArgs, scene: &Scene) -> Result<()> {
    if scene.triangle_count() == 0 {
        bail!("the model has no triangles to look at");
    }
    match &args.camera {
        Some(name) if scene.cameras().is_empty() => {
            bail!("--camera {name}: the file has no camera; use --orbit")
        }
        _ => Ok(()),
    }
}

fn of_option(args: &CameraArgs, error: taotie_engine::Error) -> Error {
    match &args.camera {
        Some(name) => options::under(format_args!("--camera {name}"), error),
        None => error.into(),
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
