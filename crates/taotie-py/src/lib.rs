//! The native module of the Python package `taotie`: arrays, JSON and handles in and out.
//!
//! Names and types for Python users are defined in `python/taotie`, not here. Options arrive as the JSON form of the
//! library's own structs (`serde`), whose defaults apply to omitted ones, reports leave as JSON, and all work runs
//! without the interpreter's lock, in [`work::run`].

mod arrays;
mod asset;
mod camera;
mod comparison;
mod convert;
mod device;
mod environment;
mod error;
mod material;
mod model;
mod options;
mod parts;
mod photometric;
mod picture;
mod renderer;
mod scene;
mod shade;
mod viewer;
mod work;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command `taotie` with its arguments, starting with the program's name; returns its exit code.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| taotie_cli::exit_code(arguments))
}

/// The native part of `taotie`.
#[pymodule(gil_used = false)]
mod _taotie {
    #[pymodule_export]
    use super::asset::{Asset, Written, bake, require, verify};
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::comparison::compare;
    #[pymodule_export]
    use super::convert::{color, convert, diff, normals_of_heights, write_png};
    #[pymodule_export]
    use super::model::{Model, load, model_of_parts};
    #[pymodule_export]
    use super::photometric::{Normals, photometric};
    #[pymodule_export]
    use super::picture::{write_heat, write_photo};
    #[pymodule_export]
    use super::renderer::Renderer;
    #[pymodule_export]
    use super::scene::{join, save_model};
    #[pymodule_export]
    use super::shade::shade;
    #[pymodule_export]
    use super::viewer::{Viewer, viewer_script};

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
