//! Images of a model.

use crate::arrays;
use crate::camera::CameraRequest;
use crate::device::{Device, Machine};
use crate::environment::{EnvironmentRequest, RequestedEnvironment};
use crate::error::no_json;
use crate::model::Model;
use crate::options::Options;
use crate::work::{self, Listed, Running};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;
use std::sync::{Arc, Mutex, PoisonError};
use taotie::studio::{Framing, LightOptions, LightSpec, Motion, Viewpoint};
use taotie_engine::film::{self, Development, ToneCurve};
use taotie_engine::math::Vec3;
use taotie_engine::render::{
    EnvironmentLight, Frame, ReferenceSettings, RenderSettings, Shot, SurfaceSettings, reference,
};
use taotie_engine::scene::{Camera, Scene};
use taotie_engine::{Error, Progress, Result, Warnings};
use taotie_io::parse;

/// The settings shared by all images of a renderer.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
pub struct Setup {
    pub surface: SurfaceSettings,
    device: Device,
    /// The time in the animation, in seconds.
    time: Option<f64>,
    /// The animation, by name or number; `None` means the first.
    animation: Option<String>,
}

/// The parameters of a renderer.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RendererRequest<'py> {
    /// [`Setup`].
    setup: Options,
    environment: EnvironmentRequest<'py>,
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
    pub camera: CameraRequest,
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
    machine: Machine,
    warnings: Warnings,
}

struct State {
    renderer: taotie_engine::render::Renderer,
    /// The last viewpoint, and the options it was chosen for: the images of a turn share it.
    viewpoint: Option<((CameraRequest, Framing), Viewpoint)>,
}

/// A rendered image, and its camera.
struct Taken {
    image: Image,
    camera: Camera,
}

/// The pixels of an image.
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
    fn new(py: Python<'_>, model: &Model, request: RendererRequest<'_>, running: Running) -> PyResult<Self> {
        let (setup, environment) = (request.setup.read::<Setup>()?, request.environment.taken(py)?);
        work::run(py, &running, |progress| {
            progress.begin("prepare")?;
            Self::prepared(model, &setup, environment)
        })
    }

    /// The device that renders: `cpu`, or the name of the GPU.
    fn device(&self) -> String {
        self.machine.name()
    }

    /// Warnings, with their counts.
    fn warnings(&self) -> Listed {
        work::listed(&self.warnings)
    }

    /// Renders an image: codes `(height, width, 4)`, or linear light and the output variables; and the camera as JSON.
    fn shoot<'py>(
        &self,
        py: Python<'py>,
        request: Options,
        running: Running,
    ) -> PyResult<Bound<'py, PyDict>> {
        let request = request.read::<Request>()?;
        let Taken { image, camera } = work::run(py, &running, |progress| self.taken(&request, progress))?;
        let result = PyDict::new(py);
        result.set_item("camera", serde_json::to_string(&camera).map_err(no_json)?)?;
        match image {
            Image::Codes(codes) => {
                let RenderSettings { width, height, .. } = request.settings;
                let shape = [height as usize, width as usize, 4];
                result.set_item("codes", arrays::array(py, codes.into_flattened(), &shape)?)?;
            }
            Image::Linear(frame) => {
                result.set_item("color", arrays::of_image(py, &frame.color, 4)?)?;
                for (name, image) in frame.aovs.iter().flat_map(|aovs| aovs.named()) {
                    let array = match name {
                        "triangle" => triangles(py, image)?,
                        _ => arrays::of_image(py, image, channels(name))?,
                    };
                    result.set_item(name, array)?;
                }
            }
        }
        Ok(result)
    }
}

/// Returns the triangle of each pixel, `(height, width)`; the largest number if it is empty.
fn triangles<'py>(py: Python<'py>, image: &taotie_engine::image::Image) -> PyResult<Bound<'py, PyAny>> {
    let index = |[_, quotient, remainder, seen]: &[f32; 4]| match *seen {
        0.0 => u32::MAX,
        _ => ((*quotient as u32) << 16) | *remainder as u32,
    };
    let indices = image.pixels().iter().map(index).collect();
    arrays::array(py, indices, &[image.height() as usize, image.width() as usize])
}

/// Returns the number of channels of an output variable.
fn channels(name: &str) -> usize {
    match name {
        "depth" => 1,
        "uv" => 2,
        _ => 3,
    }
}

impl Renderer {
    fn prepared(model: &Model, setup: &Setup, environment: RequestedEnvironment) -> Result<Self> {
        let mut warnings = Warnings::default();
        let (machine, environment) = (setup.device.open()?, environment.load(&mut warnings)?);
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
        Ok(Self { state, scene, environment, motion, machine, warnings })
    }

    fn taken(&self, request: &Request, progress: Progress<'_>) -> Result<Taken> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let viewpoint = self.viewpoint(&mut state, request)?;
        let view = viewpoint.at(request.turn);
        let lighting = request.lights()?.lighting(self.environment.as_ref(), &self.scene, view);
        let camera = view.camera();
        let shot = Shot { camera: &camera, lighting: &lighting, settings: &request.settings };
        let image = self.shot(&mut state, (request, &shot), progress.begin("render")?)?;
        Ok(Taken { image, camera })
    }

    fn shot(
        &self,
        state: &mut State,
        (request, shot): (&Request, &Shot<'_>),
        progress: Progress<'_>,
    ) -> Result<Image> {
        let (development, renderer) = (request.development()?, &mut state.renderer);
        let is_linear = request.linear || request.settings.aovs;
        let gpu = self.machine.gpu(request.settings.aovs || request.reference.is_some());
        Ok(match (&request.reference, gpu) {
            (Some(_), Some(_)) => {
                let why = "the path tracer runs on the CPU; use device='cpu', or integrator='raster'";
                return Err(Error::unsupported("device gpu", why));
            }
            (Some(paths), None) => {
                let frame = reference(renderer.prepared(), shot, paths, progress)?;
                match is_linear {
                    true => Image::Linear(frame),
                    false => Image::Codes(film::develop8(&frame.color, &development)?),
                }
            }
            (None, None) if is_linear => Image::Linear(renderer.render(shot, progress)?),
            (None, None) => {
                let mut codes = Vec::new();
                renderer.develop(shot, &development, &mut codes, progress)?;
                Image::Codes(codes)
            }
            (None, Some(gpu)) if is_linear => {
                Image::Linear(gpu.render(renderer.prepared(), shot, progress)?)
            }
            (None, Some(gpu)) => {
                Image::Codes(gpu.develop(renderer.prepared(), (shot, &development), progress)?)
            }
        })
    }

    /// Returns the requested viewpoint; reuses that of the previous image if its options are the same.
    fn viewpoint(&self, state: &mut State, request: &Request) -> Result<Viewpoint> {
        let size = [request.settings.width, request.settings.height];
        let key = (request.camera.clone(), Framing { size, all_around: request.all_around });
        if let Some((_, kept)) = state.viewpoint.as_ref().filter(|(chosen_by, _)| *chosen_by == key) {
            return Ok(kept.clone());
        }
        let framing = key.1;
        let camera = &key.0.options(&self.scene, framing);
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
