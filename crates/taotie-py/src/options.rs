//! Options from Python: dictionaries converted to the JSON form of the library's structs, preserving numbers to the
//! bit.

use crate::error::{refused, unreadable};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde::de::DeserializeOwned;
use serde_json::{Map, Number, Value};

/// Options as given by Python.
pub struct Options(Value);

impl Options {
    /// Deserialises the options of a struct.
    ///
    /// # Errors
    /// `InvalidValue` or `InvalidType`, which names the option and the accepted values.
    pub fn read<T: DeserializeOwned>(self) -> PyResult<T> {
        serde_path_to_error::deserialize(self.0).map_err(|error| unreadable(&error))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Options {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        value("options", &object).map(Self)
    }
}

/// Converts an option; NumPy's numbers are numbers too.
fn value(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Value> {
    if object.is_none() {
        return Ok(Value::Null);
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    if let Ok(items) = object.cast::<PyDict>() {
        let entry = |(key, item): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let key = key.extract::<String>()?;
            let item = value(&key, &item)?;
            Ok((key, item))
        };
        return Ok(Value::Object(items.iter().map(entry).collect::<PyResult<Map<_, _>>>()?));
    }
    if object.hasattr("__len__")? && object.len().is_ok() {
        let items = object.try_iter()?;
        return Ok(Value::Array(items.map(|item| value(name, &item?)).collect::<PyResult<_>>()?));
    }
    scalar(name, object)
}

fn scalar(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(truth) = object.extract::<bool>() {
        return Ok(Value::Bool(truth));
    }
    if object.hasattr("__index__")? {
        let why = |_| refused(object.py(), "invalid", (name, &format!("{object} has more than 64 bits")));
        return object.extract::<i64>().map(|integer| Value::Number(integer.into())).map_err(why);
    }
    let Ok(number) = object.extract::<f64>() else {
        let why = format!("{object} has an unsupported type");
        return Err(refused(object.py(), "type", (name, &why)));
    };
    let why = || refused(object.py(), "invalid", (name, &format!("{number} is not a finite number")));
    Number::from_f64(number).map(Value::Number).ok_or_else(why)
}
