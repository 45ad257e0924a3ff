//! Models: from a file, or from the arrays of a mesh.

use crate::arrays::{self, MeshArrays};
use crate::error::{exception, no_json};
use crate::options::Options;
use crate::work::{self, Listed, Running};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use taotie::Limits;
use taotie::asset::{Scan, ScanFile, ScanOptions, into_metres};
use taotie::inspection::{Audit, AuditSchema, Inspection, ProductInfo};
use taotie::studio::{self, MaterialOptions};
use taotie_engine::bake::low_poly_mesh;
use taotie_engine::length::Unit;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::surface::with_normals;
use taotie_engine::{Error, Progress, Warnings};
use taotie_io::{GltfSizes, GltfSource, Loaded};

/// The options of a model.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Request {
    material: MaterialOptions,
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

/// Reads a model and applies the requested material options.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf, request: Options, running: Running) -> PyResult<Model> {
    let request = request.read::<Request>()?;
    work::run(py, &running, move |progress| {
        let limits = request.limits()?;
        let file = path.clone();
        let read = move |_: Progress<'_>| studio::load(&file, &request.material, &limits);
        let loaded = progress.begin("read the model")?.apart(read)?;
        request.scan.check()?;
        Ok(Model { loaded, path: Some(path), limits, scan_options: request.scan, scan: Mutex::default() })
    })
}

/// Creates a model from one mesh, and applies the requested material options.
#[pyfunction]
pub fn model_of_arrays(py: Python<'_>, arrays: MeshArrays<'_>, request: Options) -> PyResult<Model> {
    let request = request.read::<Request>()?;
    let data = arrays.data()?;
    let made = py.detach(move || {
        let mut scene = Scene::of_mesh(Mesh::new(data)?, Material::default())?;
        request.material.apply(&mut scene)?;
        let loaded = Loaded::new(scene, Warnings::default(), "arrays");
        let (limits, scan_options) = (request.limits()?, request.scan);
        Ok::<_, Error>(Model { loaded, path: None, limits, scan_options, scan: Mutex::default() })
    });
    made.map_err(|error| exception(py, &error))
}

impl Model {
    /// Returns the scan, which is created only once.
    pub fn scan(&self, progress: Progress<'_>) -> taotie_engine::Result<Scan> {
        let mut kept = self.scan.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scan) = &*kept {
            return Ok(scan.clone());
        }
        let file = match &self.path {
            Some(path) => ScanFile::from_loaded(self.loaded.clone(), path, &self.limits)?,
            None => ScanFile::from_scene(self.loaded.scene.clone())?,
        };
        Ok(kept.insert(file.with_options(self.scan_options).into_scan(progress)?).clone())
    }

    /// Returns the scan, read with the options of the asset's bake unless the model has its own options.
    pub fn scan_of(&self, asset: &Path, progress: Progress<'_>) -> taotie_engine::Result<Scan> {
        let options = self.scan_options.or(ScanOptions::recorded(asset, &self.limits)?);
        if options == self.scan_options { self.scan(progress) } else { self.read_as(options).scan(progress) }
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

    /// Returns the same model with other options for reading it as a scan.
    fn read_as(&self, scan_options: ScanOptions) -> Self {
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
fn smooth(scene: &Scene) -> taotie_engine::Result<Scene> {
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
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.loaded.scene.bounds().map(|bounds| [bounds.min.to_array(), bounds.max.to_array()])
    }

    /// The source format: `glTF`, `GLB`, `OBJ`, `PLY`, `STL`, or `arrays`.
    fn format(&self) -> &'static str {
        self.loaded.format
    }

    /// All triangles as one mesh in world space, as arrays.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mesh = py.detach(|| self.mesh()).map_err(|error| exception(py, &error))?;
        arrays::of_mesh(py, &mesh)
    }

    /// The same model with the requested materials.
    fn dressed(&self, py: Python<'_>, request: Options) -> PyResult<Self> {
        let material = request.read::<MaterialOptions>()?;
        let (mut loaded, path) = (self.loaded.clone(), self.path.clone());
        let dressed = py.detach(|| {
            if let Some(variant) = &material.variant {
                loaded.variants.apply(variant, &mut loaded.scene)?;
            }
            material.apply(&mut loaded.scene)
        });
        dressed.map_err(|error| exception(py, &error))?;
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
        let inspection = py.detach(inspection).map_err(|error| exception(py, &error))?;
        serde_json::to_string(&inspection).map_err(no_json)
    }

    /// The result of checking the model against an auditor's schema file, as JSON.
    fn audit(&self, py: Python<'_>, schema: PathBuf, product_info: Option<PathBuf>) -> PyResult<String> {
        let audit = py.detach(|| {
            let schema = AuditSchema::parse(&taotie_io::read_bytes(&schema)?, schema.display())?;
            let product =
                product_info.map(|path| ProductInfo::parse(&taotie_io::read_bytes(&path)?, path.display()));
            Audit::of(&self.loaded, &schema, product.transpose()?.as_ref())
        });
        let audit = audit.map_err(|error| exception(py, &error))?;
        serde_json::to_string(&audit).map_err(no_json)
    }

    /// The scene as a GLB, and warnings about everything that glTF cannot express.
    fn glb<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyBytes>, Listed)> {
        let mut warnings = Warnings::default();
        let Loaded { scene, mesh_names, .. } = &self.loaded;
        let bytes = py.detach(|| taotie_io::encode_scene(&smooth(scene)?, mesh_names, &mut warnings));
        let bytes = bytes.map_err(|error| exception(py, &error))?;
        Ok((PyBytes::new(py, &bytes), work::listed(&warnings)))
    }
}
