//! Normals from photographs, with their uncertainty.

use crate::arrays::{self, Picture, Taken};
use crate::error::exception;
use crate::options::Options;
use crate::work::{self, Listed, Running};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use taotie_cli::PhotometricFiles;
use taotie_engine::{Error, Progress, Result, Warnings};
use taotie_io::{FileSet, Limits};
use taotie_photometric::{
    Estimate, Estimator, Light, PhotographSet, PhotometricOptions, Relief, Samples, check_output,
    note_behind, note_lengths,
};

/// Photographs: a path, or images with a row for each light.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Photographs<'py> {
    path: Option<PathBuf>,
    images: Vec<Picture<'py>>,
    lights: Option<PyReadonlyArray2<'py, f64>>,
    mask: Option<Picture<'py>>,
}

/// Normals of photographs, and everything that is known about them.
#[pyclass(frozen, module = "taotie._taotie")]
pub struct Normals {
    estimate: Estimate,
    relief: Relief,
    options: PhotometricOptions,
    /// The files of the photographs, which are never overwritten; none of arrays.
    inputs: Vec<PathBuf>,
    warnings: Warnings,
}

/// The photographs, from files or arrays.
enum Source {
    Path(PathBuf, Option<PathBuf>),
    Images { images: Vec<Taken>, lights: Vec<[f64; 3]>, mask: Option<Taken> },
}

/// Estimates normals.
#[pyfunction]
pub fn photometric(
    py: Python<'_>,
    photographs: Photographs<'_>,
    request: Options,
    running: Running,
) -> PyResult<Normals> {
    let request = request.read::<PhotometricOptions>()?;
    let source = photographs.taken(py)?;
    work::run(py, &running, move |progress| estimated(source, request, progress))
}

impl Photographs<'_> {
    fn taken(&self, py: Python<'_>) -> PyResult<Source> {
        let mask = self.mask.as_ref().map(|mask| mask.taken(py)).transpose()?;
        if let Some(path) = &self.path {
            return match mask {
                None => Ok(Source::Path(path.clone(), None)),
                Some(Taken::File(mask)) => Ok(Source::Path(path.clone(), Some(mask))),
                Some(Taken::Texels(_)) => {
                    let error = Error::invalid(
                        "mask",
                        "an array; pass the path of an image with photographs by path",
                    );
                    Err(exception(py, &error))
                }
            };
        }
        let images = self.images.iter().map(|image| image.taken(py)).collect::<PyResult<_>>()?;
        let lights = match &self.lights {
            Some(lights) if lights.shape()[1] == 3 => lights.as_slice()?.as_chunks::<3>().0.to_vec(),
            _ => Vec::new(),
        };
        Ok(Source::Images { images, lights, mask })
    }
}

fn estimated(source: Source, mut options: PhotometricOptions, progress: Progress<'_>) -> Result<Normals> {
    let (mut warnings, mut inputs) = (Warnings::default(), Vec::new());
    let samples = match source {
        Source::Path(path, mask) => {
            let limits = Limits::default().or_free();
            let set = PhotographSet::open_with(&path, &options.setup(limits), &mut warnings, progress)?;
            (inputs, options.mask) = (set.inputs(), mask);
            Samples::read(&set, &options.reading(limits), progress.begin("read")?)?
        }
        Source::Images { images, lights, mask } => {
            let light = |(i, vector): (usize, [f64; 3])| {
                let wrong = || Error::invalid(format!("lights row {i}"), "a vector without a direction");
                Light::towards(vector).ok_or_else(wrong)
            };
            let lengths = lights.iter().map(|v| v.iter().map(|v| v * v).sum::<f64>().sqrt());
            note_lengths(lengths.collect::<Vec<_>>().into_iter(), "", &mut warnings);
            let lights = lights.into_iter().enumerate().map(light).collect::<Result<Vec<_>>>()?;
            note_behind(&lights, &mut warnings);
            let images = images.into_iter().map(Taken::bitmap).collect::<Result<Vec<_>>>()?;
            let mask = mask.map(Taken::bitmap).transpose()?;
            Samples::of(images, &lights, mask.as_ref(), options.encoding)?
        }
    };
    let estimate = Estimate::noted(&samples, &mut warnings, progress)?;
    let relief = estimate.relief(progress.begin("depth")?)?;
    Ok(Normals { estimate, relief, options, inputs, warnings })
}

#[pymethods]
impl Normals {
    /// Warnings of reading and estimating.
    fn warnings(&self) -> Listed {
        work::listed(&self.warnings)
    }

    /// All arrays by name: NaN without a normal.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let result = PyDict::new(py);
        result.set_item("normals", arrays::of_image(py, &self.estimate.normals(Estimator::Best), 3)?)?;
        result.set_item("color", arrays::of_image(py, &self.estimate.albedos(), 3)?)?;
        let sigma = self.estimate.image(|_, best| [best.sigma_deg; 3]);
        let albedo = self.estimate.image(|_, best| [best.albedo; 3]);
        let residuals = self.estimate.image(|_, best| [best.residual; 3]);
        let depth = self.relief.image(self.options.pixel_size.unwrap_or(1.0));
        for (name, image) in
            [("sigma", sigma), ("albedo", albedo), ("residuals", residuals), ("depth", depth)]
        {
            result.set_item(name, arrays::of_image(py, &image, 1)?)?;
        }
        Ok(result)
    }

    /// The mean residual of lit samples under each light, relative to the albedo.
    fn lights(&self) -> Vec<f64> {
        self.estimate.lights.iter().map(|light| light.relative).collect()
    }

    /// Writes the files of the command, except for its reports.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Listed> {
        let warnings = work::detached(py, || {
            let files = FileSet::new();
            files.protect(self.inputs.iter().chain(&self.options.mask))?;
            check_output(&self.inputs, &folder)?;
            files.claim_folder(&folder)?;
            let output = PhotometricFiles {
                folder: &folder,
                options: &self.options,
                files: &files,
                estimate: &self.estimate,
                relief: &self.relief,
            };
            let warnings = output.write()?;
            files.commit().map(|()| warnings)
        })?;
        Ok(work::listed(&warnings))
    }
}
