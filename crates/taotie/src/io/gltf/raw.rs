//! A glTF file as it stands: its JSON with all that nobody here reads, and the bytes of its buffers.

use super::buffers::load_buffer;
use super::container::split;
use super::source::GltfSource;
use super::uri::{self, ByteSource};
use crate::error::{Error, Result};
use crate::io::file;
use crate::io::json::broken;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A glTF file as it stands.
pub(in crate::io) struct RawGltf {
    /// Its JSON, an object; nothing in it is checked.
    pub json: Value,
    /// The bytes of each buffer; `None` for one that has none, which compressed views unpack to.
    pub buffers: Vec<Option<Vec<u8>>>,
    path: PathBuf,
}

impl RawGltf {
    /// Reads a file and its buffers.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Parse`] where it cannot be read.
    pub fn read(source: GltfSource<'_>) -> Result<Self> {
        let path = source.path();
        let (text, mut blob) = split(path, source.bytes()?.into_owned())?;
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
        let json: Value = serde_json::from_slice(text).map_err(|e| broken(path, &e))?;
        if !json.is_object() {
            return Err(Error::parse(path, "JSON", "it is no object; is this glTF 2.0?"));
        }
        let declared = json.get("buffers").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let mut buffers = Vec::with_capacity(declared.len());
        for (i, buffer) in declared.iter().enumerate() {
            buffers.push(match buffer.get("uri").and_then(Value::as_str) {
                Some(name) => Some(load_buffer(path, name, i)?),
                None if i == 0 => blob.take(),
                None => None,
            });
        }
        Ok(Self { json, buffers, path: path.to_path_buf() })
    }

    /// Returns an error at a place of the file.
    pub fn error(&self, at: impl Into<String>, what: impl Into<String>) -> Error {
        Error::parse(&self.path, at, what)
    }

    /// Returns the bytes of the file beside the document that `name`, a URI, leads to; `None` where it holds its bytes
    /// itself, or is not there.
    ///
    /// # Errors
    /// [`Error::Io`] where the file is there and cannot be read.
    pub fn file(&self, name: &str) -> Result<Option<Vec<u8>>> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        match uri::locate(name, folder) {
            Ok(ByteSource::File(path)) if path.is_file() => file::read(&path).map(Some),
            _ => Ok(None),
        }
    }
}
