//! An unmodified glTF file: its JSON, including the parts that are not read here, and the bytes of its buffers.

use super::buffers::load_buffer;
use super::container::split;
use super::parsed_size::parsed_size;
use super::source::GltfSource;
use super::uri::{self, ByteSource};
use crate::error::{Error, Result};
use crate::io::json::broken;
use crate::io::limits::Limits;
use crate::io::reading::Reading;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// An unmodified glTF file.
pub(in crate::io) struct RawGltf {
    /// Its JSON, an object; its contents are not checked.
    pub json: Value,
    /// The bytes of each buffer; `None` for one without data, as the target of compressed views.
    pub buffers: Vec<Option<Vec<u8>>>,
    reading: Arc<Reading>,
}

impl RawGltf {
    /// Reads a file and its buffers.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Parse`] if it cannot be read, [`Error::Limit`] if a limit is exceeded.
    pub fn read(source: GltfSource<'_>, limits: &Limits) -> Result<Self> {
        let path = source.path();
        let reading = Arc::new(Reading::new(path, limits));
        let (text, mut blob) = split(path, source.bytes(&reading)?.into_owned())?;
        if !reading.take(parsed_size(&text, blob.is_some())) {
            reading.check()?;
        }
        let json = parse(path, text)?;
        let declared = json.get("buffers").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let mut buffers = Vec::with_capacity(declared.len());
        for (i, buffer) in declared.iter().enumerate() {
            buffers.push(match buffer.get("uri").and_then(Value::as_str) {
                Some(name) => Some(load_buffer(&reading, name, i)?),
                None if i == 0 => blob.take(),
                None => None,
            });
        }
        Ok(Self { json, buffers, reading })
    }

    /// Returns the limits on memory and file access, and the memory used so far.
    pub fn reading(&self) -> &Arc<Reading> {
        &self.reading
    }

    /// Returns an error at a place in the file.
    pub fn error(&self, at: impl Into<String>, what: impl Into<String>) -> Error {
        Error::parse(self.reading.path(), at, what)
    }

    /// Returns the bytes of the external file that `name`, a URI, refers to; `None` if the URI holds the bytes
    /// itself, or the file does not exist or may not be read.
    ///
    /// # Errors
    /// [`Error::Io`] if the file exists but cannot be read, [`Error::Limit`] if it does not fit in memory.
    pub fn file(&self, name: &str) -> Result<Option<Vec<u8>>> {
        match uri::locate(name, &self.reading) {
            Ok(ByteSource::File(path)) if path.is_file() => self.reading.read(&path).map(Some),
            _ => Ok(None),
        }
    }
}

/// Parses the JSON of a document and drops its text.
fn parse(path: &Path, text: Vec<u8>) -> Result<Value> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
    let json: Value = serde_json::from_slice(text).map_err(|e| broken(path, &e))?;
    match json.is_object() {
        true => Ok(json),
        false => Err(Error::parse(path, "JSON", "expected an object; is this glTF 2.0?")),
    }
}
