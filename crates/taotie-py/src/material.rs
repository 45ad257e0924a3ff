//! Materials: options, and maps given as arrays.

use crate::arrays::Picture;
use crate::error::exception;
use crate::options::Options;
use pyo3::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use taotie::Limits;
use taotie::studio::MaterialOptions;
use taotie_engine::Result;
use taotie_engine::image::Bitmap;
use taotie_io::Loaded;

/// The options of a material. Maps given as arrays have a name there, in place of a path.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct MaterialRequest<'py> {
    options: Options,
    /// The arrays by their names.
    arrays: HashMap<String, Picture<'py>>,
}

/// A requested material, usable without the interpreter's lock.
pub struct RequestedMaterial {
    pub options: MaterialOptions,
    arrays: HashMap<PathBuf, Bitmap>,
}

impl MaterialRequest<'_> {
    /// Reads the options and copies the arrays.
    pub fn taken(self, py: Python<'_>) -> PyResult<RequestedMaterial> {
        let mut arrays = HashMap::new();
        for (name, picture) in &self.arrays {
            let bitmap = picture.taken(py)?.bitmap().map_err(|error| exception(py, &error))?;
            arrays.insert(PathBuf::from(name), bitmap);
        }
        Ok(RequestedMaterial { options: self.options.read()?, arrays })
    }
}

impl RequestedMaterial {
    /// Applies the material to every material of `loaded`, and reads the maps that are files within limits.
    ///
    /// # Errors
    /// As [`MaterialOptions::apply`].
    pub fn apply(&self, loaded: &mut Loaded, limits: &Limits) -> Result<()> {
        loaded.is_edited |= self.options != MaterialOptions::default();
        self.options.apply_with(&mut loaded.scene, &mut |path: &Path| match self.arrays.get(path) {
            Some(bitmap) => Ok(bitmap.clone()),
            None => taotie_io::read_bitmap_within(path, limits),
        })
    }
}
