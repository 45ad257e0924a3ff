//! Models: from a file, or from the arrays of a mesh.

use crate::arrays;
use crate::error::{exception, no_json};
use crate::material::MaterialRequest;
use crate::options::Options;
use crate::parts::{self, Parts};
use crate::work::{self, Listed, Running};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use taotie::Limits;
use taotie::asset::{Scan, ScanFile, ScanOptions, into_metres, model_unit};
use taotie::inspection::{Audit, AuditSchema, Inspection, ProductInfo};
use taotie::studio::{self, MaterialOptions};
use taotie_engine::bake::low_poly_mesh;
use taotie_engine::length::Unit;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::Scene;
use taotie_engine::surface::with_normals;
use taotie_engine::{Error, Progress, Warnings};
use taotie_io::{GltfSizes, GltfSource, Loaded};

/// The parameters of a model.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ModelRequest<'py> {
    material: MaterialRequest<'py>,
    /// [`Request`].
    options: Options,
}

/// The options of a model.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Request {
    scan: ScanOptions,
    memory_limit: Option<String>,
    allow_outside: bool,
}

impl Request {
    fn limits(&self) -> taotie_engine::Result<Limits> {
        let memory = self.memory_limit.as_deref().map(str::parse).transpose()?;
        Ok(Limits { memory, allow_outside: self.allow_outside, ..Limits::default() }.or_free())
    }
}

/// A model, and its scan once one has been baked from it.
#[pyclass(frozen, module = "taotie._taotie")]
pub struct Model {
    pub loaded: Loaded,
    /// The file that it was read from; `None` if it is in memory.
    pub path: Option<PathBuf>,
    limits: Limits,
    scan_options: ScanOptions,
    scan: Mutex<Option<Scan>>,
}

/// The models of a scan.
#[derive(FromPyObject)]
pub enum ScanModels {
    One(Py<Model>),
    Several(Vec<Py<Model>>),
}

impl ScanModels {
    /// Returns the scan, read with the options that its models were loaded with.
    pub fn scan(&self, progress: Progress<'_>) -> taotie_engine::Result<Scan> {
        self.read_as(self.options()?, progress)
    }

    /// Returns the scan, read with the options of the asset's bake unless its models have their own.
    pub fn scan_of(&self, asset: &Path, progress: Progress<'_>) -> taotie_engine::Result<Scan> {
        let (options, limits) = (self.options()?, self.limits());
        self.read_as(options.or(ScanOptions::recorded(asset, &limits)?), progress)
    }

    fn read_as(&self, options: ScanOptions, progress: Progress<'_>) -> taotie_engine::Result<Scan> {
        match self {
            Self::One(model) if model.get().scan_options == options => model.get().scan(progress),
            Self::One(model) => model.get().read_as(options).scan(progress),
            Self::Several(models) => {
                let files = models.iter().map(|model| model.get().scan_file());
                ScanFile::joined(files.collect::<taotie_engine::Result<_>>()?, options)?.into_scan(progress)
            }
        }
    }

    fn all(&self) -> &[Py<Model>] {
        match self {
            Self::One(model) => std::slice::from_ref(model),
            Self::Several(models) => models,
        }
    }

    fn limits(&self) -> Limits {
        self.all().first().map_or_else(Limits::default, |model| model.get().limits)
    }

    /// Returns the options that all models were loaded with.
    fn options(&self) -> taotie_engine::Result<ScanOptions> {
        let mut options = self.all().iter().map(|model| model.get().scan_options);
        let first = options.next().unwrap_or_default();
        match options.all(|other| other == first) {
            true => Ok(first),
            false => Err(Error::invalid(
                "the scan",
                "its models were loaded with different options; give unit, crease_angle and scan_green for all to bake \
                 instead, or load all with the same",
            )),
        }
    }
}

/// Reads a model and applies the requested material options.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf, request: ModelRequest<'_>, running: Running) -> PyResult<Model> {
    let (request, material) = (request.options.read::<Request>()?, request.material.taken(py)?);
    work::run(py, &running, move |progress| {
        let limits = request.limits()?;
        let file = path.clone();
        let variant =
            MaterialOptions { variant: material.options.variant.clone(), ..MaterialOptions::default() };
        let read = move |_: Progress<'_>| {
            let mut loaded = studio::load(&file, &variant, &limits)?;
            material.apply(&mut loaded, &limits)?;
            Ok(loaded)
        };
        let loaded = progress.begin("read the model")?.apart(read)?;
        request.scan.check()?;
        Ok(Model { loaded, path: Some(path), limits, scan_options: request.scan, scan: Mutex::default() })
    })
}

/// Creates a model from meshes, materials and images, and applies the requested material options.
#[pyfunction]
pub fn model_of_parts(py: Python<'_>, parts: Parts<'_>, material: MaterialRequest<'_>) -> PyResult<Model> {
    let (parts, material) = (parts.taken(py)?, material.taken(py)?);
    work::detached(py, move || {
        let mut model = Model::in_memory(Loaded::new(parts.scene()?, Warnings::default(), "arrays"));
        material.apply(&mut model.loaded, &model.limits)?;
        Ok(model)
    })
}

impl Model {
    /// Returns a model that is not in a file.
    pub fn in_memory(loaded: Loaded) -> Self {
        let (limits, scan_options) = (Limits::default().or_free(), ScanOptions::default());
        Self { loaded, path: None, limits, scan_options, scan: Mutex::default() }
    }

    /// Returns the scan, which is created only once.
    fn scan(&self, progress: Progress<'_>) -> taotie_engine::Result<Scan> {
        let mut kept = self.scan.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scan) = &*kept {
            return Ok(scan.clone());
        }
        Ok(kept.insert(self.scan_file()?.with_options(self.scan_options).into_scan(progress)?).clone())
    }

    /// Returns it as a file of a scan.
    fn scan_file(&self) -> taotie_engine::Result<ScanFile> {
        match &self.path {
            Some(path) => ScanFile::from_loaded(self.loaded.clone(), path, &self.limits),
            None => ScanFile::from_scene(self.loaded.scene.clone()),
        }
    }

    /// Returns scene and scan in the space of a model that was baked from this one, which is in metres if it records
    /// the unit.
    pub fn scan_beside(&self, model: &Self, progress: Progress<'_>) -> taotie_engine::Result<(Scene, Scan)> {
        let recorded =
            model.path.as_deref().map(|path| ScanOptions::recorded(path, &model.limits)).transpose()?;
        let mut scene = self.loaded.scene.clone();
        match recorded.and_then(|recorded| recorded.unit).filter(|unit| *unit != Unit::Metre) {
            None => Ok((scene, self.scan(progress)?)),
            unit => {
                into_metres(&mut scene, unit)?;
                let file = ScanFile::from_scene(scene.clone())?.with_options(self.scan_options);
                Ok((scene, file.into_scan(progress)?))
            }
        }
    }

    /// Returns the options for reading it as a scan, with the unit that its file states.
    pub fn reading_options(&self) -> ScanOptions {
        let unit = self.path.as_ref().and_then(|_| model_unit(&self.loaded));
        self.scan_options.or(ScanOptions { unit, ..ScanOptions::default() })
    }

    /// Returns the same model with other options for reading it as a scan.
    pub fn read_as(&self, scan_options: ScanOptions) -> Self {
        let (loaded, path) = (self.loaded.clone(), self.path.clone());
        Self { loaded, path, limits: self.limits, scan_options, scan: Mutex::default() }
    }

    /// Returns all triangles as one mesh in world space.
    pub fn mesh(&self) -> taotie_engine::Result<Mesh> {
        low_poly_mesh(self.loaded.scene.clone())
    }
}

/// Returns a scene whose meshes all have normals: meshes without them are faceted in glTF, and smooth in other
/// formats.
pub fn smooth(scene: &Scene) -> taotie_engine::Result<Scene> {
    let mut data = scene.clone().into_data();
    for mesh in &mut data.meshes {
        *mesh = with_normals(mesh)?.into_owned();
    }
    Scene::new(data)
}

#[pymethods]
impl Model {
    /// Problems of the file, and omissions, with their counts.
    fn warnings(&self) -> Listed {
        work::listed(&self.loaded.warnings)
    }

    /// The number of triangles over all instances.
    fn triangles(&self) -> usize {
        self.loaded.scene.triangle_count()
    }

    /// The minimum and maximum corner in world space; `None` without triangles.
    fn bounds(&self, py: Python<'_>) -> PyResult<Option<[[f64; 3]; 2]>> {
        let bounds = work::detached(py, || Ok(self.loaded.scene.bounds()))?;
        Ok(bounds.map(|bounds| [bounds.min.to_array(), bounds.max.to_array()]))
    }

    /// The source format: `glTF`, `GLB`, `OBJ`, `PLY`, `STL`, `FBX`, or `arrays`.
    fn format(&self) -> &'static str {
        self.loaded.format
    }

    /// All triangles as one mesh in world space, as arrays.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        arrays::of_mesh(py, &work::detached(py, || self.mesh())?)
    }

    /// The model as one mesh for each material, see [`parts::of_scene`], and counted omissions.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyList>, Listed)> {
        let (parts, warnings) = parts::of_scene(py, &self.loaded.scene)?;
        Ok((parts, work::listed(&warnings)))
    }

    /// The same model with the requested materials.
    fn dressed(&self, py: Python<'_>, material: MaterialRequest<'_>) -> PyResult<Self> {
        let material = material.taken(py)?;
        let (mut loaded, path) = (self.loaded.clone(), self.path.clone());
        work::detached(py, || {
            if let Some(variant) = &material.options.variant {
                loaded.variants.apply(variant, &mut loaded.scene)?;
            }
            material.apply(&mut loaded, &self.limits)
        })?;
        Ok(Self {
            loaded,
            path,
            limits: self.limits,
            scan_options: self.scan_options,
            scan: Mutex::default(),
        })
    }

    /// The same model with other options for reading it as a scan; omitted options keep their values.
    fn as_scan(&self, py: Python<'_>, request: Options) -> PyResult<Self> {
        let (given, own) = (request.read::<ScanOptions>()?, self.scan_options);
        let scan_options = given.or(own);
        scan_options.check().map_err(|error| exception(py, &error))?;
        Ok(self.read_as(scan_options))
    }

    /// The options for reading it as a scan, as JSON, with the unit that its file states.
    fn reading(&self) -> PyResult<String> {
        serde_json::to_string(&self.reading_options()).map_err(no_json)
    }

    /// The same model without a reference to its file, which may then be removed.
    fn without_file(&self) -> Self {
        let (loaded, scan_options) = (self.loaded.clone(), self.scan_options);
        Self { loaded, path: None, limits: self.limits, scan_options, scan: Mutex::default() }
    }

    /// The content of the model and its problems, as JSON.
    fn inspection(&self, py: Python<'_>) -> PyResult<String> {
        let inspection = || {
            let mut inspection = Inspection::of(&self.loaded);
            let file = self.path.as_deref().filter(|_| self.loaded.structure.is_some());
            inspection.sizes =
                file.map(|path| GltfSizes::read(GltfSource::File(path), &self.limits)).transpose()?;
            Ok::<_, Error>(inspection)
        };
        let inspection = work::detached(py, inspection)?;
        serde_json::to_string(&inspection).map_err(no_json)
    }

    /// The result of checking the model against an auditor's schema file, as JSON.
    fn audit(&self, py: Python<'_>, schema: PathBuf, product_info: Option<PathBuf>) -> PyResult<String> {
        let audit = work::detached(py, || {
            let schema = AuditSchema::parse(&taotie_io::read_bytes(&schema)?, schema.display())?;
            let product =
                product_info.map(|path| ProductInfo::parse(&taotie_io::read_bytes(&path)?, path.display()));
            Audit::of(&self.loaded, &schema, product.transpose()?.as_ref())
        })?;
        serde_json::to_string(&audit).map_err(no_json)
    }

    /// The scene as a GLB, and warnings about everything that glTF cannot express.
    fn glb<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyBytes>, Listed)> {
        let mut warnings = Warnings::default();
        let Loaded { scene, mesh_names, .. } = &self.loaded;
        let bytes =
            work::detached(py, || taotie_io::encode_scene(&smooth(scene)?, mesh_names, &mut warnings))?;
        Ok((PyBytes::new(py, &bytes), work::listed(&warnings)))
    }
}
