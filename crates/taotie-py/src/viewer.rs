//! The page that shows a model in a browser.

use crate::environment::EnvironmentRequest;
use crate::model::Model;
use crate::options::Options;
use crate::renderer::{Request, Setup};
use crate::work::{self, Listed, Running};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::Path;
use taotie::asset::model_unit;
use taotie::studio::{Framing, Viewpoint};
use taotie_engine::render::{EnvironmentLight, Prepared, SurfaceSettings};
use taotie_engine::scene::Scene;
use taotie_engine::{Progress, Result, Warnings};
use taotie_report::viewer::{self, ScanSubject, Subject};

/// The parameters of a page.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ViewRequest<'py> {
    title: String,
    /// Settings shared by all images.
    setup: Options,
    environment: EnvironmentRequest<'py>,
    /// The first image to show; its size is ignored.
    image: Options,
    /// The scan that the model was baked from.
    scan: Option<Py<Model>>,
    /// `true` if the page also shows the scan itself.
    publish_scan: bool,
}

/// A page and its accompanying files.
#[pyclass(frozen, module = "taotie._taotie")]
pub struct Viewer {
    viewer: viewer::Viewer,
    warnings: Warnings,
}

/// The script that defines the element `<taotie-viewer>`.
#[pyfunction]
pub fn viewer_script() -> &'static str {
    viewer::SCRIPT
}

#[pymethods]
impl Viewer {
    /// Makes the page of a model.
    #[new]
    fn new(py: Python<'_>, model: &Model, request: ViewRequest<'_>, running: Running) -> PyResult<Self> {
        let (setup, image) = (request.setup.read::<Setup>()?, request.image.read::<Request>()?);
        let environment = request.environment.taken(py)?;
        let scan = request.scan.as_ref().map(Py::get);
        let look = Look { title: &request.title, setup: &setup, image: &image };
        let scan = scan.map(|scan| (scan, request.publish_scan));
        work::run(py, &running, |progress| {
            let mut warnings = Warnings::default();
            let environment = environment.load(&mut warnings)?;
            let mut made = look.viewer((model, environment.as_ref()), scan, progress.begin("view")?)?;
            made.warnings.absorb(warnings);
            Ok(made)
        })
    }

    /// Omissions and changes in the page, with their counts.
    fn warnings(&self) -> Listed {
        work::listed(&self.warnings)
    }

    /// The page as one self-contained HTML document, which fetches nothing.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        work::detached(py, || Ok(self.viewer.html()))
    }

    /// The page and the files that it fetches from the same folder, by name.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for file in work::detached(py, || Ok(self.viewer.files(None)))? {
            files.set_item(file.name, PyBytes::new(py, &file.bytes))?;
        }
        Ok(files)
    }
}

/// The appearance of a model.
struct Look<'a> {
    title: &'a str,
    setup: &'a Setup,
    image: &'a Request,
}

impl Look<'_> {
    fn viewer(
        &self,
        (model, environment): (&Model, Option<&EnvironmentLight>),
        scan: Option<(&Model, bool)>,
        progress: Progress<'_>,
    ) -> Result<Viewer> {
        let mut warnings = Warnings::default();
        // Surface attributes are prepared for the best method; the page shows the requested one.
        let best = SurfaceSettings { method: None, ..self.setup.surface };
        let prepared = Prepared::new(model.loaded.scene.clone(), &best)?;
        warnings.absorb(prepared.warnings().clone());
        let scan = match scan {
            None => None,
            Some((high, is_published)) => {
                let (mut shown, scene) = ShownScan::of(high, model, progress)?;
                if is_published {
                    shown.publish(&scene, &mut warnings)?;
                }
                Some(shown)
            }
        };
        let framing = Framing { size: [1024; 2], all_around: false };
        let camera = self.image.camera.options(prepared.scene(), framing);
        let viewpoint = Viewpoint::choose(&camera, framing, prepared.scene())?;
        let view = viewpoint.at(0.0);
        let viewer = viewer::Viewer::new(&Subject {
            title: self.title,
            facts: &viewer::facts(&model.loaded, &self.file_name(model)),
            unit: model_unit(&model.loaded),
            bookmarks: &[],
            prepared: &prepared,
            settings: &self.image.settings,
            camera: &view.camera(),
            lighting: &self.image.lights()?.lighting(environment, prepared.scene(), view),
            development: &self.image.development()?,
            scan: scan.as_ref().map(ShownScan::subject),
            errors: None,
            rays: None,
        })?;
        warnings.absorb(viewer.warnings.clone());
        Ok(Viewer { viewer, warnings })
    }

    /// Returns the name of the model's file; the title if there is none.
    fn file_name(&self, model: &Model) -> String {
        let name = model.path.as_deref().and_then(Path::file_name);
        name.map_or_else(|| self.title.to_owned(), |name| name.to_string_lossy().into_owned())
    }
}

/// The scan of a model.
struct ShownScan {
    scan: taotie::asset::Scan,
    published: Option<Prepared>,
}

impl ShownScan {
    /// Reads a model as a scan, in the space of the model that was baked from it; also returns its scene.
    fn of(high: &Model, model: &Model, progress: Progress<'_>) -> Result<(Self, Scene)> {
        let (scene, scan) = high.scan_beside(model, progress)?;
        Ok((Self { scan, published: None }, scene))
    }

    /// Adds the scan itself to the page.
    fn publish(&mut self, scene: &Scene, warnings: &mut Warnings) -> Result<()> {
        let scene = viewer::scene_to_show(scene, self.scan.sorted(), warnings)?;
        self.published = Some(Prepared::new(scene, &SurfaceSettings::default())?);
        Ok(())
    }

    fn subject(&self) -> ScanSubject<'_> {
        ScanSubject { measured: &self.scan, published: self.published.as_ref() }
    }
}
