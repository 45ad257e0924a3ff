//! One model rendered by several surface methods, measured against another.

use crate::arrays;
use crate::camera::CameraRequest;
use crate::environment::EnvironmentRequest;
use crate::error::no_json;
use crate::model::Model;
use crate::options::Options;
use crate::renderer::Color;
use crate::work::{self, Running};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;
use taotie::comparison::{Comparison, ComparisonOptions, NamedScene, RenderedSurface, Subject};
use taotie::studio::{Framing, LightOptions, Viewpoint};
use taotie_engine::names::Named;
use taotie_engine::render::EnvironmentLight;
use taotie_engine::{Result, Warnings};

/// The models to compare.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Models {
    low: Py<Model>,
    high: Option<Py<Model>>,
    names: [String; 2],
}

/// The parameters of a comparison.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct CompareRequest<'py> {
    /// [`Request`].
    options: Options,
    environment: EnvironmentRequest<'py>,
}

/// The options of a comparison.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Request {
    options: ComparisonOptions,
    background: Option<Color>,
    camera: CameraRequest,
    lights: Vec<String>,
    ambient: Option<Color>,
}

/// Renders and measures; returns the report as JSON, and arrays for each method.
#[pyfunction]
pub fn compare<'py>(
    py: Python<'py>,
    models: Models,
    request: CompareRequest<'py>,
    running: Running,
) -> PyResult<Bound<'py, PyDict>> {
    let (request, environment) = (request.options.read::<Request>()?, request.environment.taken(py)?);
    let comparison = work::run(py, &running, |progress| {
        let low = &models.low.get().loaded.scene;
        let mut high = models.high.as_ref().map(|model| model.get().loaded.scene.clone());
        if let Some(high) = &mut high {
            Subject::dress_reference(high, low)?;
        }
        let mut subject = Subject::new(&models.names[0], low);
        subject.reference = high.as_ref().map(|scene| NamedScene { name: &models.names[1], scene });
        let mut warnings = Warnings::default();
        let options = request.seen(&subject, environment.load(&mut warnings)?.as_ref())?;
        let mut comparison = Comparison::of(&subject, &options, progress)?;
        comparison.warnings.absorb(warnings);
        Ok(comparison)
    })?;
    let result = PyDict::new(py);
    result.set_item("report", serde_json::to_string(&comparison.report()).map_err(no_json)?)?;
    result.set_item("warnings", work::listed(&comparison.warnings))?;
    let views = PyDict::new(py);
    for surface in &comparison.surfaces {
        views.set_item(surface.id(), of_surface(py, surface)?)?;
    }
    result.set_item("views", views)?;
    Ok(result)
}

impl Request {
    /// Returns the options including camera, lights and background.
    fn seen(
        &self,
        subject: &Subject<'_>,
        environment: Option<&EnvironmentLight>,
    ) -> Result<ComparisonOptions> {
        let (scene, mut options) = (subject.model.scene, self.options.clone());
        let size = [options.settings.width, options.settings.height];
        let framing = Framing { size, all_around: false };
        let viewpoint = Viewpoint::choose(&self.camera.options(scene, framing), framing, scene)?;
        let lights = self.lights.iter().map(|line| line.parse()).collect::<Result<_>>()?;
        let light = LightOptions { lights, ambient: self.ambient.as_ref().map(Color::rgb).transpose()? };
        light.check()?;
        options.lighting = Some(light.lighting(environment, scene, viewpoint.at(0.0)));
        options.camera = Some(viewpoint.at(0.0).camera());
        if let Some(background) = &self.background {
            options.development.background = Some(background.rgb()?);
        }
        Ok(options)
    }
}

/// Returns the normals of a method, their angles to the truth, and its images.
fn of_surface<'py>(py: Python<'py>, surface: &RenderedSurface) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("normals", arrays::of_image(py, &surface.normals, 3)?)?;
    if let Some(difference) = &surface.difference {
        result.set_item("angles", arrays::of_field(py, &difference.angles)?)?;
        result.set_item("inner_angles", arrays::of_field(py, &difference.inner_angles)?)?;
    }
    let images = PyDict::new(py);
    for (shading, image) in &surface.pictures {
        let codes = image.pixels().as_flattened().to_vec();
        let shape = [image.height() as usize, image.width() as usize, 3];
        images.set_item(shading.name(), arrays::array(py, codes, &shape)?)?;
    }
    result.set_item("images", images)?;
    Ok(result)
}
