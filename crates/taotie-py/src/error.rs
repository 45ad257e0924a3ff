//! The library's errors as Python exceptions.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_path_to_error::Segment;
use std::io;
use taotie_engine::Error;

/// The parts of an error, as the attributes of `taotie.Error`.
#[derive(Default)]
struct Parts {
    kind: &'static str,
    path: Option<String>,
    place: Option<String>,
    remedy: Option<String>,
    /// The error number of the operating system.
    code: Option<i32>,
}

impl Parts {
    fn of(error: &Error) -> Self {
        match error {
            Error::Io { path, cause } => Self {
                kind: "io",
                path: Some(path.display().to_string()),
                place: None,
                remedy: Some(cause.to_string()),
                code: code(cause),
            },
            Error::Parse { path, at, what } => Self {
                kind: "parse",
                path: Some(path.display().to_string()),
                place: Some(at.clone()),
                remedy: Some(what.clone()),
                code: None,
            },
            Error::Invalid { what, why } => Self::of_value("invalid", what, why),
            Error::Unsupported { what, why } => Self::of_value("unsupported", what, why),
            Error::Limit { what, why } => Self::of_value("limit", what, why),
            Error::Unmet { what } => Self { kind: "unmet", remedy: Some(what.clone()), ..Self::default() },
            Error::Cancelled => Self { kind: "cancelled", ..Self::default() },
            _ => Self::default(),
        }
    }

    fn of_value(kind: &'static str, what: &str, why: &str) -> Self {
        Self { kind, place: Some(what.into()), remedy: Some(why.into()), ..Self::default() }
    }

    fn raised(self, py: Python<'_>, text: String) -> PyErr {
        let Self { kind, path, place, remedy, code } = self;
        let made = || -> PyResult<PyErr> {
            let module = py.import("taotie._error")?;
            let value = module.getattr("make")?.call1((text, kind, path, place, remedy, code))?;
            Ok(PyErr::from_value(value))
        };
        made().unwrap_or_else(|failed| failed)
    }
}

/// Returns POSIX's number of an error: those that have a Python class are the same on every system.
fn code(cause: &io::Error) -> Option<i32> {
    match cause.kind() {
        io::ErrorKind::NotFound => Some(2),
        io::ErrorKind::PermissionDenied => Some(13),
        _ => cause.raw_os_error(),
    }
}

/// Returns the exception for an error: a subclass of `taotie.Error`, see `make` in `taotie._error`.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    Parts::of(error).raised(py, error.to_string())
}

/// Returns the exception for options that do not fit the library's structs; it names the option.
pub fn unreadable(error: &serde_path_to_error::Error<serde_json::Error>) -> PyErr {
    let keys = error.path().iter().rev().find_map(|segment| match segment {
        Segment::Map { key } => Some(key.as_str()),
        _ => None,
    });
    let name = keys.unwrap_or("options");
    let message = error.inner().to_string();
    let kind = if message.starts_with("invalid type") { "type" } else { "invalid" };
    let why = in_words(&message);
    Python::attach(|py| refused(py, kind, (name, &why)))
}

/// Returns the exception of a kind, `invalid` or `type`, for an option by name and the reason.
pub fn refused(py: Python<'_>, kind: &'static str, (name, why): (&str, &str)) -> PyErr {
    Parts::of_value(kind, name, why).raised(py, format!("{name}: {why}"))
}

/// Returns a message of serde with Rust's number types in words.
fn in_words(message: &str) -> String {
    let Some((before, expected)) = message.rsplit_once(", expected ") else { return message.into() };
    let words = match expected {
        "usize" | "u64" | "u32" | "u16" | "u8" => "an integer, 0 or more",
        "i64" | "i32" => "an integer",
        "f64" | "f32" => "a number",
        other => other,
    };
    format!("{before}, expected {words}")
}

/// Returns the exception for a report that is not valid JSON.
pub fn no_json(error: serde_json::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}
