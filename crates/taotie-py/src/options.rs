//! Options from Python: dictionaries converted to the JSON form of the library's structs, preserving numbers to the
//! bit.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use serde::de::DeserializeOwned;
use serde_json::{Map, Number, Value};

/// Options as given by Python.
pub struct Options(Value);

impl Options {
    /// Deserialises the options of a struct.
    ///
    /// # Errors
    /// `ValueError` that names the unsupported option or value.
    pub fn read<T: DeserializeOwned>(self) -> PyResult<T> {
        serde_json::from_value(self.0).map_err(|error| PyValueError::new_err(format!("options: {error}")))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Options {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        value(&object).map(Self)
    }
}

fn value(object: &Bound<'_, PyAny>) -> PyResult<Value> {
    if object.is_none() {
        return Ok(Value::Null);
    }
    if object.is_instance_of::<PyBool>() {
        return object.extract().map(Value::Bool);
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    if let Ok(items) = object.cast::<PyDict>() {
        let entry = |(key, item): (Bound<'_, PyAny>, Bound<'_, PyAny>)| Ok((key.extract()?, value(&item)?));
        return Ok(Value::Object(items.iter().map(entry).collect::<PyResult<Map<_, _>>>()?));
    }
    if object.is_instance_of::<PyInt>() {
        return Ok(Value::Number(object.extract::<i64>()?.into()));
    }
    if object.is_instance_of::<PyFloat>() {
        let number = object.extract::<f64>()?;
        let why = || PyValueError::new_err(format!("options: {number} is not a finite number"));
        return Number::from_f64(number).map(Value::Number).ok_or_else(why);
    }
    let why = |_| PyTypeError::new_err(format!("options: unsupported type: {object}"));
    let items = object.try_iter().map_err(why)?;
    Ok(Value::Array(items.map(|item| value(&item?)).collect::<PyResult<_>>()?))
}
