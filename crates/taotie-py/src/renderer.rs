//! Images of a model.

use crate::arrays;
use crate::model::Model;
use crate::options::Options;
use crate::work::{self, Listed, Running};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;
use std::sync::{Arc, Mutex, PoisonError};
use taotie::studio::{
    CameraOptions, EnvironmentOptions, Framing, LightOptions, LightSpec, Motion, Viewpoint,
};
use taotie_engine::film::{self, Development, ToneCurve};
use taotie_engine::math::Vec3;
use taotie_engine::render::{
    EnvironmentLight, Frame, ReferenceSettings, RenderSettings, Shot, SurfaceSettings, reference,
};
use taotie_engine::scene::Scene;
use taotie_engine::{Progress, Result, Warnings};
use taotie_io::parse;

/// The settings shared by all images of a renderer.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
pub struct Setup {
    pub surface: SurfaceSettings,
    pub environment: EnvironmentOptions,
    /// The time in the animation, in seconds.
    time: Option<f64>,
    /// The animation, by name or number; `None` means the first.
    animation: Option<String>,
}

/// A colour as text, or linear RGB.
#[derive(Deserialize)]
#[serde(untagged)]
pub enum Color {
    /// In CSS syntax, or one number for grey.
    Text(String),
    /// Linear RGB.
    Linear([f64; 3]),
}

impl Color {
    /// Returns linear RGB.
    pub fn rgb(&self) -> Result<Vec3> {
        match self {
            Self::Text(text) => parse::color(text),
            Self::Linear(rgb) => Ok(Vec3::from_array(rgb.map(|channel| channel as f32))),
        }
    }
}

/// How an image is developed.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Film {
    exposure: f64,
    tone: ToneCurve,
    /// `None` for a transparent background.
    background: Option<Color>,
}

/// One image.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
pub struct Request {
    pub settings: RenderSettings,
    pub camera: CameraOptions,
    /// Frames the object for all directions, as on a turntable.
    all_around: bool,
    /// The rotation of the object, in radians.
    turn: f64,
    lights: Vec<String>,
    ambient: Option<Color>,
    film: Film,
    /// Settings of the path tracer; `None` for the rasteriser.
    reference: Option<ReferenceSettings>,
    /// Linear light instead of a developed image.
    linear: bool,
}

impl Request {
    /// Returns the lights.
    ///
    /// # Errors
    /// If a light specification is invalid.
    pub fn lights(&self) -> Result<LightOptions> {
        let lights = self.lights.iter().map(|line| line.parse::<LightSpec>()).collect::<Result<_>>()?;
        let options = LightOptions { lights, ambient: self.ambient.as_ref().map(Color::rgb).transpose()? };
        options.check()?;
        Ok(options)
    }

    /// Returns how to develop the image.
    ///
    /// # Errors
    /// If the background is not a valid colour.
    pub fn development(&self) -> Result<Development> {
        let Film { exposure, tone, background } = &self.film;
        Ok(Development {
            exposure_stops: *exposure as f32,
            tone: *tone,
            background: background.as_ref().map(Color::rgb).transpose()?,
            simd: self.settings.surface.simd,
        })
    }
}

/// A model, ready for rendering.
#[pyclass(frozen, module = "taotie._taotie")]
pub struct Renderer {
    state: Mutex<State>,
    scene: Arc<Scene>,
    environment: Option<EnvironmentLight>,
    motion: Option<Motion>,
    warnings: Warnings,
}

struct State {
    renderer: taotie_engine::render::Renderer,
    /// The last viewpoint, and the options it was chosen for: the images of a turn share it.
    viewpoint: Option<((CameraOptions, Framing), Viewpoint)>,
}

/// A rendered image.
enum Image {
    /// 8-bit sRGB codes with straight alpha.
    Codes(Vec<[u8; 4]>),
    /// Linear light.
    Linear(Frame),
}

#[pymethods]
impl Renderer {
    /// Prepares a model.
    #[new]
    fn new(py: Python<'_>, model: &Model, request: Options, running: Running) -> PyResult<Self> {
        let setup = request.read::<Setup>()?;
        work::run(py, &running, |progress| {
            progress.begin("prepare")?;
            Self::prepared(model, &setup)
        })
    }

    /// Warnings, with their counts.
    fn warnings(&self) -> Listed {
        work::listed(&self.warnings)
    }

    /// Renders an image: codes `(height, width, 4)`, or linear light and the requested output variables.
    fn shoot<'py>(
        &self,
        py: Python<'py>,
        request: Options,
        running: Running,
    ) -> PyResult<Bound<'py, PyDict>> {
        let request = request.read::<Request>()?;
        let image = work::run(py, &running, |progress| self.taken(&request, progress))?;
        let result = PyDict::new(py);
        match image {
            Image::Codes(codes) => {
                let RenderSettings { width, height, .. } = request.settings;
                let shape = [height as usize, width as usize, 4];
                result.set_item("codes", arrays::array(py, codes.into_flattened(), &shape)?)?;
            }
            Image::Linear(frame) => {
                result.set_item("color", arrays::of_image(py, &frame.color, 4)?)?;
                for (name, image) in frame.aovs.iter().flat_map(|aovs| aovs.named()) {
                    result.set_item(name, arrays::of_image(py, image, channels(name))?)?;
                }
            }
        }
        Ok(result)
    }
}

/// Returns the number of channels of an output variable.
fn channels(name: &str) -> usize {
    match name {
        "depth" | "triangle" => 1,
        "uv" => 2,
        _ => 3,
    }
}

impl Renderer {
    fn prepared(model: &Model, setup: &Setup) -> Result<Self> {
        let mut warnings = Warnings::default();
        let environment = setup.environment.load_within(&Default::default(), &mut warnings)?;
        let (mut scene, mut surface) = (model.loaded.scene.clone(), setup.surface);
        let motion = match setup.time {
            None => None,
            Some(seconds) => {
                let motion = Motion::choose(model.loaded.rig.clone(), setup.animation.as_deref())?;
                let (motion, bound) = motion.bind_tangents(&mut scene, &surface, &mut warnings)?;
                surface = bound;
                motion.pose(&mut scene, seconds)?;
                Some(motion)
            }
        };
        let scene = Arc::new(scene);
        let renderer = taotie_engine::render::Renderer::new(Arc::clone(&scene), &surface)?;
        warnings.absorb(renderer.prepared().warnings().clone());
        let state = Mutex::new(State { renderer, viewpoint: None });
        Ok(Self { state, scene, environment, motion, warnings })
    }

    fn taken(&self, request: &Request, progress: Progress<'_>) -> Result<Image> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let viewpoint = self.viewpoint(&mut state, request)?;
        let view = viewpoint.at(request.turn);
        let lighting = request.lights()?.lighting(self.environment.as_ref(), &self.scene, view);
        let shot = Shot { camera: &view.camera(), lighting: &lighting, settings: &request.settings };
        let (development, progress) = (request.development()?, progress.begin("render")?);
        let frame = match &request.reference {
            Some(paths) => reference(state.renderer.prepared(), &shot, paths, progress)?,
            None if request.linear || request.settings.aovs => state.renderer.render(&shot, progress)?,
            None => {
                let mut codes = Vec::new();
                state.renderer.develop(&shot, &development, &mut codes, progress)?;
                return Ok(Image::Codes(codes));
            }
        };
        Ok(match request.linear || request.settings.aovs {
            true => Image::Linear(frame),
            false => Image::Codes(film::develop8(&frame.color, &development)?),
        })
    }

    /// Returns the requested viewpoint; reuses that of the previous image if its options are the same.
    fn viewpoint(&self, state: &mut State, request: &Request) -> Result<Viewpoint> {
        let size = [request.settings.width, request.settings.height];
        let key = (request.camera.clone(), Framing { size, all_around: request.all_around });
        if let Some((_, kept)) = state.viewpoint.as_ref().filter(|(chosen_by, _)| *chosen_by == key) {
            return Ok(kept.clone());
        }
        let (camera, framing) = (&key.0, key.1);
        let viewpoint = match &self.motion {
            None => Viewpoint::choose(camera, framing, &self.scene)?,
            Some(motion) => {
                let mut moving = (*self.scene).clone();
                let mut viewpoint = Viewpoint::choose_moving(camera, framing, &mut moving, motion)?;
                viewpoint.follow(camera, &self.scene)?;
                viewpoint
            }
        };
        Ok(state.viewpoint.insert((key, viewpoint)).1.clone())
    }
}
