//! The views of a document: new ones, and the bytes of all views moved into one buffer.

use super::super::edit;
use super::spans::{Range, Spans};
use crate::error::Result;
use crate::io::gltf::RawGltf;
use serde_json::{Value, json};

/// Adds bytes as a view; returns its index.
pub(super) fn add(raw: &mut RawGltf, bytes: Vec<u8>) -> usize {
    let view = json!({ "buffer": raw.buffers.len(), "byteOffset": 0, "byteLength": bytes.len() });
    raw.buffers.push(Some(bytes));
    edit::push(&mut raw.json, "bufferViews", view)
}

/// Moves the bytes used by views into one buffer, which it returns; its length is a multiple of four. Overlapping
/// views still overlap. The document's buffers become this one, without a URI, followed by those that never had any
/// bytes.
///
/// # Errors
/// [`crate::Error::Parse`] if a view refers to missing bytes.
pub(in super::super) fn joined(raw: &mut RawGltf) -> Result<Vec<u8>> {
    let mut views = edit::taken(&mut raw.json, "bufferViews");
    let mut ranges = Vec::new();
    for (i, view) in views.iter_mut().enumerate() {
        let mut found = Vec::new();
        each_place(view, &mut |place| found.push(range(place)));
        let is_there = |range: &Option<Range>| range.is_some_and(|range| range.is_in(&raw.buffers));
        if !found.iter().all(is_there) {
            return Err(raw.error(format!("buffer view {i}"), "its bytes are missing; re-export the file"));
        }
        ranges.extend(found.into_iter().flatten().filter(|range| raw.buffers[range.buffer].is_some()));
    }
    let (spans, bytes) = Spans::moved(ranges, &raw.buffers);
    let empty: Vec<usize> = (0..raw.buffers.len()).filter(|i| raw.buffers[*i].is_none()).collect();
    for view in &mut views {
        each_place(view, &mut |place| set_place(place, &spans, &empty));
    }
    set_buffers(&mut raw.json, &empty, bytes.len());
    if !views.is_empty() {
        raw.json["bufferViews"] = Value::Array(views);
    }
    Ok(bytes)
}

/// Visits the objects in a view that refer to bytes: itself, and the one for its packed bytes.
pub(in super::super) fn each_place(view: &mut Value, visit: &mut impl FnMut(&mut Value)) {
    visit(view);
    let extensions = view.get_mut("extensions").and_then(Value::as_object_mut).into_iter().flatten();
    extensions.map(|(_, extension)| extension).filter(|e| e.get("buffer").is_some()).for_each(visit);
}

fn range(place: &mut Value) -> Option<Range> {
    let start = edit::number(place, "byteOffset").unwrap_or(0);
    let end = start.checked_add(edit::number(place, "byteLength")?)?;
    Some(Range { buffer: edit::number(place, "buffer")?, start, end })
}

/// Updates an object to the new position of its bytes, or to its buffer without bytes.
fn set_place(place: &mut Value, spans: &Spans, empty: &[usize]) {
    let Some(range) = range(place) else { return };
    match empty.iter().position(|buffer| *buffer == range.buffer) {
        Some(rank) => place["buffer"] = (rank + 1).into(),
        None => {
            place["buffer"] = 0.into();
            place["byteOffset"] = spans.moved_to(&range).into();
        }
    }
}

/// Writes the buffer of all bytes into the document, followed by those without bytes.
fn set_buffers(json: &mut Value, empty: &[usize], length: usize) {
    let declared = edit::taken(json, "buffers");
    let kept = empty.iter().filter_map(|i| declared.get(*i).cloned());
    let buffers: Vec<Value> = std::iter::once(json!({ "byteLength": length })).chain(kept).collect();
    if length > 0 {
        json["buffers"] = Value::Array(buffers);
    }
}
