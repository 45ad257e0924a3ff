//! The bytes of buffers and of their views, decompressed where necessary.

use super::meshopt::{self, Packed};
use super::reason::{Reason, no_such};
use super::uri;
use crate::error::{Error, Result, Warnings};
use crate::io::reading::Reading;
use gltf::json::Root;
use gltf::json::buffer::View;
use std::collections::BTreeMap;

/// Maximum number of bytes that all compressed views unpack to, per byte of the buffers, plus a constant for small
/// files. Several views may share the same packed bytes, so a limit per view would not bound their sum.
const MAX_UNPACKED_PER_BYTE: usize = 64;
const MAX_UNPACKED_OF_SMALL: usize = 1 << 28;

/// The content of the file's buffers.
pub(super) struct Buffers {
    /// The bytes of each buffer; `None` for one that has no source.
    buffers: Vec<Option<Vec<u8>>>,
    /// The bytes of compressed views, or the reason why they are unavailable.
    unpacked: BTreeMap<usize, Reason<Vec<u8>>>,
}

impl Buffers {
    /// Reads every buffer of `root`; `blob` is the binary chunk of the container.
    ///
    /// # Errors
    /// Fails if a buffer cannot be read. [`Self::view`] reports a damaged compressed view.
    pub fn load(
        reading: &Reading,
        root: &Root,
        mut blob: Option<Vec<u8>>,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let bytes = match &buffer.uri {
                _ if meshopt::is_fallback(buffer) => None,
                Some(name) => Some(load_buffer(reading, name, i)?),
                None if i == 0 => blob.take(),
                None => None,
            };
            if let Some(bytes) = &bytes
                && (bytes.len() as u64) < buffer.byte_length.0
            {
                warnings.note(format!("buffer {i} has {} bytes, fewer than declared", bytes.len()), 1);
            }
            buffers.push(bytes);
        }
        let mut buffers = Self { buffers, unpacked: BTreeMap::new() };
        if root.buffer_views.iter().any(|view| meshopt::of_view(view).is_some()) {
            buffers.unpack(root, usize::try_from(reading.left()).unwrap_or(usize::MAX));
        }
        let unpacked = buffers.unpacked.values().flatten().map(Vec::len).sum::<usize>();
        if !reading.take(unpacked as u64) {
            reading.check()?;
        }
        Ok(buffers)
    }

    /// Returns the bytes of view `index`, which is `view`.
    pub fn view(&self, index: usize, view: &View) -> Reason<&[u8]> {
        let start = view.byte_offset.map_or(0, |o| o.0);
        let bytes = match self.unpacked.get(&index) {
            Some(unpacked) => unpacked.as_deref().map_err(Clone::clone),
            None => self.range(view.buffer.value(), start, view.byte_length.0),
        };
        bytes.map_err(|why| format!("buffer view {index}: {why}"))
    }

    /// Returns the number of bytes, counting compressed views as unpacked.
    pub fn total_bytes(&self) -> usize {
        let unpacked = self.unpacked.values().flatten();
        self.buffers.iter().flatten().chain(unpacked).map(Vec::len).sum()
    }

    fn range(&self, buffer: usize, start: u64, length: u64) -> Reason<&[u8]> {
        let bytes = self
            .buffers
            .get(buffer)
            .ok_or_else(|| no_such("buffer", buffer))?
            .as_ref()
            .ok_or_else(|| format!("buffer {buffer} has no data except from an extension"))?;
        let end = start.saturating_add(length);
        if end > bytes.len() as u64 {
            return Err(format!("ends at byte {end}, but buffer {buffer} has {} bytes", bytes.len()));
        }
        Ok(&bytes[start as usize..end as usize])
    }

    /// Unpacks compressed views to at most `most` bytes.
    fn unpack(&mut self, root: &Root, most: usize) {
        let mut budget = most.min(MAX_UNPACKED_OF_SMALL + MAX_UNPACKED_PER_BYTE * self.total_bytes());
        for (index, view) in root.buffer_views.iter().enumerate() {
            let Some(json) = meshopt::of_view(view) else { continue };
            let unpacked = Packed::read(json).and_then(|packed| {
                let bytes = self.range(packed.buffer, packed.offset, packed.length)?;
                let rest = budget.checked_sub(packed.size());
                budget = rest.ok_or("the compressed views of the file unpack to too many bytes")?;
                packed.unpack(bytes)
            });
            self.unpacked.insert(index, unpacked);
        }
    }
}

/// Reads the buffer that a URI refers to.
pub(super) fn load_buffer(reading: &Reading, name: &str, index: usize) -> Result<Vec<u8>> {
    let wrong = |what: String| Err(Error::parse(reading.path(), format!("buffer {index}"), what));
    let short = uri::shortened(name);
    match uri::locate(name, reading) {
        Ok(uri::ByteSource::Data { bytes, .. }) => Ok(bytes),
        Ok(uri::ByteSource::File(path)) if path.exists() => reading.read(&path),
        Ok(uri::ByteSource::File(path)) => {
            wrong(format!("the file '{short}' is missing; put it at {}", path.display()))
        }
        Err(why) => wrong(format!("'{short}': {why}")),
    }
}
