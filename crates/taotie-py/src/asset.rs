//! From a model to an asset and its proof.

use crate::arrays;
use crate::device::Device;
use crate::error::{exception, no_json};
use crate::model::{Model, ScanModels};
use crate::options::Options;
use crate::work::{self, Listed, Running};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;
use taotie::Limits;
use taotie::asset::{
    BakeOptions, Baker, Certificate, Figures, MeshSource, Packing, Proof, RayDistance, Report, Requirement,
    RequirementOutcome, Signature, VerifyOptions,
};
use taotie_engine::length::Unit;
use taotie_engine::names::Named;
use taotie_engine::{Progress, Result};

/// The parameters of a bake.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct BakeRequest {
    /// [`BakeOptions`].
    options: Options,
    /// An in-memory low-poly mesh.
    low: Option<Py<Model>>,
    /// An in-memory cage.
    cage: Option<Py<Model>>,
    /// `true` if the goal is only a default: it is dropped if no search can meet it.
    may_drop_goal: bool,
    memory_limit: Option<String>,
    /// The [`Device`] that casts rays.
    device: Options,
}

impl BakeRequest {
    /// Returns the options, the memory limit and the device.
    fn read(self) -> PyResult<(BakeOptions, Option<String>, Device)> {
        let mut options = self.options.read::<BakeOptions>()?;
        if let Some(low) = self.low.as_ref() {
            options.low = Some(in_memory(low)?);
        }
        if let Some(cage) = self.cage.as_ref() {
            options.ray_distance = RayDistance::Cage(in_memory(cage)?);
        }
        if self.may_drop_goal && !options.may_search() {
            options.goal = None;
        }
        Ok((options, self.memory_limit, self.device.read()?))
    }
}

fn in_memory(model: &Py<Model>) -> PyResult<MeshSource> {
    let mesh = model.get().mesh();
    mesh.map(|mesh| MeshSource::Mesh(Arc::new(mesh))).map_err(|e| Python::attach(|py| exception(py, &e)))
}

/// A low-poly mesh with its maps.
#[pyclass(frozen, module = "taotie._taotie")]
pub struct Asset {
    asset: taotie::asset::Asset,
}

/// Bakes the models of a scan.
#[pyfunction]
pub fn bake(py: Python<'_>, models: ScanModels, request: BakeRequest, running: Running) -> PyResult<Asset> {
    let (options, memory_limit, device) = request.read()?;
    work::run(py, &running, |progress| {
        let memory = memory_limit.as_deref().map(str::parse).transpose()?;
        let limits = Limits { memory, ..Limits::default() }.or_free();
        options.check()?;
        let machine = device.open()?;
        let scan = machine.casting(models.scan(progress)?);
        let asset = Baker::new(options).with_limits(limits).bake(&scan, progress)?;
        Ok(Asset { asset })
    })
}

/// A file to write, and how to pack it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct WriteRequest {
    path: PathBuf,
    packing: Options,
}

#[pymethods]
impl Asset {
    /// Problems of scan, mesh and maps, and omissions, with their counts.
    fn warnings(&self) -> Listed {
        work::listed(self.asset.warnings())
    }

    /// The triangles of each level, texels, samples, and the origin of the mesh, as JSON.
    fn facts(&self) -> String {
        let (asset, counts) = (&self.asset, self.asset.counts());
        let triangles: Vec<usize> = asset.levels().map(|mesh| mesh.triangles().len()).collect();
        json!({
            "triangles": triangles,
            "size": asset.size(),
            "origin": asset.origin(),
            "counts": {
                "samples": counts.samples,
                "missed": counts.missed,
                "lost": counts.lost,
                "shared": counts.shared,
                "texels": counts.texels,
                "missed_texels": counts.missed_texels,
            },
        })
        .to_string()
    }

    /// The arrays of each level of detail, finest first.
    fn levels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let levels =
            self.asset.levels().map(|mesh| arrays::of_mesh(py, mesh)).collect::<PyResult<Vec<_>>>()?;
        PyList::new(py, levels)
    }

    /// The maps as stored, by material and by name.
    fn maps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sets = PyDict::new(py);
        for (label, textures) in self.asset.texture_sets() {
            let maps = PyDict::new(py);
            let named = [
                ("normal", &textures.normal),
                ("albedo", &textures.color),
                ("orm", &textures.orm),
                ("emission", &textures.emission),
            ];
            for (name, bitmap) in named.into_iter().filter_map(|(name, map)| Some((name, map.as_ref()?))) {
                maps.set_item(name, arrays::of_bitmap(py, bitmap)?)?;
            }
            for extra in &textures.separate {
                maps.set_item(extra.map.name(), arrays::of_bitmap(py, &extra.bitmap)?)?;
            }
            sets.set_item(label, maps)?;
        }
        Ok(sets)
    }

    /// Writes the asset.
    fn write(&self, py: Python<'_>, request: WriteRequest, running: Running) -> PyResult<Written> {
        let (path, packing) = (request.path, request.packing.read::<Packing>()?);
        let written = work::run(py, &running, |progress| {
            packing.check()?;
            self.asset.write(&path, &packing, progress)
        })?;
        Ok(Written { written })
    }
}

/// An asset written to files.
#[pyclass(frozen, module = "taotie._taotie")]
pub struct Written {
    written: taotie::asset::WrittenAsset,
}

#[pymethods]
impl Written {
    /// The files; the model or the first map comes first.
    fn files(&self) -> Vec<PathBuf> {
        self.written.files().to_vec()
    }

    /// Deviations from the request, with their counts.
    fn warnings(&self) -> Listed {
        work::listed(self.written.warnings())
    }

    /// Reads the asset back and measures how far it is from the scan: figures, error maps, warnings.
    fn verify(&self, models: ScanModels, request: Options, running: Running) -> PyResult<Py<PyDict>> {
        measured(request, &running, |options, progress| {
            self.written.verify(models.scan(progress)?, options, progress)
        })
    }

    /// Returns the report that the command writes, as JSON, with a proof's figures and requirements if present.
    fn report(&self, py: Python<'_>, proved: Option<Proved>, required: Vec<String>) -> PyResult<String> {
        let wrong = |error| exception(py, &error);
        let mut report = Report::of(&self.written).map_err(wrong)?;
        if let Some(Proved { figures, maps, options }) = proved {
            let (figures, options) = (figures.read::<Figures>()?, options.read::<VerifyOptions>()?);
            let options = VerifyOptions {
                requirements: requirements(&required, figures.unit).map_err(wrong)?,
                ..options
            };
            let certificate =
                Certificate::of_written(&self.written, &figures, &options, &Signature::default());
            report.certificate = Some(certificate.map_err(wrong)?);
            report.prove(figures, maps.read()?);
        }
        serde_json::to_string(&report).map_err(no_json)
    }
}

/// The figures of a proof, its maps and its options.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Proved {
    figures: Options,
    maps: Options,
    options: Options,
}

/// Reads an asset's file and measures how far it is from the scan: figures, error maps, warnings.
#[pyfunction]
pub fn verify(
    asset: PathBuf,
    models: ScanModels,
    request: Options,
    running: Running,
) -> PyResult<Py<PyDict>> {
    measured(request, &running, |options, progress| {
        taotie::asset::verify(&asset, models.scan_of(&asset, progress)?, options, progress)
    })
}

/// Runs a proof, and returns its results.
fn measured(
    request: Options,
    running: &Running,
    verify: impl FnOnce(&VerifyOptions, Progress<'_>) -> Result<Proof> + Send,
) -> PyResult<Py<PyDict>> {
    let options = request.read::<VerifyOptions>()?;
    Python::attach(|py| {
        let proof = work::run(py, running, |progress| verify(&options, progress))?;
        Ok(results(py, &proof)?.unbind())
    })
}

/// Returns the results of a proof.
fn results<'py>(py: Python<'py>, proof: &Proof) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("figures", serde_json::to_string(&proof.figures).map_err(no_json)?)?;
    found.set_item("maps", serde_json::to_string(&proof.maps).map_err(no_json)?)?;
    let errors = proof.error_map.as_ref().map(|map| arrays::of_field(py, map)).transpose()?;
    found.set_item("error_map", errors)?;
    let colors = proof.color_map.as_ref().map(|map| arrays::of_field(py, map)).transpose()?;
    found.set_item("color_map", colors)?;
    let detail = proof.detail_map.as_ref().map(|map| arrays::of_field(py, map)).transpose()?;
    found.set_item("detail_map", detail)?;
    found.set_item("warnings", work::listed(&proof.warnings))?;
    Ok(found)
}

/// Parses requirements on a scan with the given unit, as the command does.
fn requirements(required: &[String], unit: Option<Unit>) -> Result<Vec<Requirement>> {
    let read = required.iter().map(|text| Requirement::read(text)).collect::<Result<Vec<_>>>()?.concat();
    Requirement::check_unit(&read, unit)?;
    Ok(read)
}

/// Checks figures against requirements, written as for the command; returns each requirement as JSON, with its text.
#[pyfunction]
pub fn require(py: Python<'_>, figures: Options, required: Vec<String>) -> PyResult<Vec<(String, String)>> {
    let figures = figures.read::<Figures>()?;
    let met =
        figures.evaluate(&requirements(&required, figures.unit).map_err(|error| exception(py, &error))?);
    let pair = |met: &RequirementOutcome| {
        Ok((serde_json::to_string(met)?, format!("{} {}", met.name(), met.text())))
    };
    met.iter().map(pair).collect::<serde_json::Result<_>>().map_err(no_json)
}
