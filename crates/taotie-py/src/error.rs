//! The library's errors as Python exceptions.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use taotie_engine::Error;

/// The parts of an error, as the attributes of `taotie.Error`.
#[derive(Default)]
struct Parts {
    kind: &'static str,
    path: Option<String>,
    place: Option<String>,
    remedy: Option<String>,
}

impl Parts {
    fn of(error: &Error) -> Self {
        match error {
            Error::Io { path, cause } => Self {
                kind: "io",
                path: Some(path.display().to_string()),
                place: None,
                remedy: Some(cause.to_string()),
            },
            Error::Parse { path, at, what } => Self {
                kind: "parse",
                path: Some(path.display().to_string()),
                place: Some(at.clone()),
                remedy: Some(what.clone()),
            },
            Error::Invalid { what, why } => Self::of_value("invalid", what, why),
            Error::Unsupported { what, why } => Self::of_value("unsupported", what, why),
            Error::Limit { what, why } => Self::of_value("limit", what, why),
            Error::Cancelled => Self { kind: "cancelled", ..Self::default() },
            _ => Self::default(),
        }
    }

    fn of_value(kind: &'static str, what: &str, why: &str) -> Self {
        Self { kind, path: None, place: Some(what.into()), remedy: Some(why.into()) }
    }
}

/// Returns the exception for an error: `taotie.Error`, or `taotie.Cancelled` if the caller stopped the work.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let Parts { kind, path, place, remedy } = Parts::of(error);
        let module = py.import("taotie._error")?;
        let value = module.getattr("make")?.call1((error.to_string(), kind, path, place, remedy))?;
        Ok(PyErr::from_value(value))
    };
    made().unwrap_or_else(|failed| failed)
}

/// Returns the exception for a report that is not valid JSON.
pub fn no_json(error: serde_json::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}
