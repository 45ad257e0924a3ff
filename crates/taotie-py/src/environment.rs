//! Environment light: the built-in studio, a file, or an array.

use crate::arrays::Picture;
use crate::error::exception;
use crate::options::Options;
use pyo3::prelude::*;
use std::sync::Arc;
use taotie::studio::EnvironmentOptions;
use taotie_engine::image::{Image, Texels};
use taotie_engine::render::EnvironmentLight;
use taotie_engine::shade::environment::Environment;
use taotie_engine::{Error, Result, Warnings};

/// The options of an environment, and its image if that is an array.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EnvironmentRequest<'py> {
    options: Options,
    image: Option<Picture<'py>>,
}

/// A requested environment, usable without the interpreter's lock.
pub struct RequestedEnvironment {
    options: EnvironmentOptions,
    image: Option<Image>,
}

impl EnvironmentRequest<'_> {
    /// Reads the options and copies the array.
    pub fn taken(self, py: Python<'_>) -> PyResult<RequestedEnvironment> {
        let image = self.image.map(|picture| {
            picture
                .taken(py)?
                .bitmap()
                .and_then(|bitmap| {
                    let (width, height) = (bitmap.width(), bitmap.height());
                    match bitmap.into_texels() {
                        Texels::F32(pixels) => Image::from_pixels(width, height, pixels),
                        _ => Err(Error::invalid("env", "its numbers are not floats, which radiance needs")),
                    }
                })
                .map_err(|error| exception(py, &error))
        });
        Ok(RequestedEnvironment { options: self.options.read()?, image: image.transpose()? })
    }
}

impl RequestedEnvironment {
    /// Returns the light, filtered. Invalid texels are replaced and counted.
    ///
    /// # Errors
    /// As [`EnvironmentOptions::load`].
    pub fn load(self, warnings: &mut Warnings) -> Result<Option<EnvironmentLight>> {
        let light = self.options.load_within(&Default::default(), warnings)?;
        let Some(image) = self.image else { return Ok(light) };
        let environment = Environment::new(image)?;
        warnings
            .note("env: replaced invalid texels (negative, infinite or NaN)", environment.repaired_texels());
        let EnvironmentOptions { rotation, intensity, visible, .. } = self.options;
        let (environment, intensity) = (Arc::new(environment), intensity as f32);
        Ok(Some(EnvironmentLight { environment, rotation, intensity, visible }))
    }
}
