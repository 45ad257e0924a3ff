//! The buffers of a document that is edited: bytes are added as views, and the parts still in use are moved into one
//! buffer without duplicates.

use super::edit;
use crate::gltf::RawGltf;
use serde_json::{Value, json};
use taotie_engine::error::Result;

/// Adds bytes as a view; returns its index.
pub(super) fn add_view(raw: &mut RawGltf, bytes: Vec<u8>) -> usize {
    let view = json!({ "buffer": raw.buffers.len(), "byteOffset": 0, "byteLength": bytes.len() });
    raw.buffers.push(Some(bytes));
    edit::push(&mut raw.json, "bufferViews", view)
}

/// Moves the bytes used by views into one buffer, which it returns; its length is a multiple of four. Overlapping
/// views still overlap. The document's buffers become this one, without a URI, followed by those that never had any
/// bytes.
///
/// # Errors
/// [`taotie_engine::Error::Parse`] if a view refers to missing bytes.
pub(super) fn joined(raw: &mut RawGltf) -> Result<Vec<u8>> {
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
pub(super) fn each_place(view: &mut Value, visit: &mut impl FnMut(&mut Value)) {
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

/// A range of bytes in a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Range {
    buffer: usize,
    start: usize,
    end: usize,
}

impl Range {
    /// Returns `true` if its buffer exists and is long enough, or has no bytes at all.
    fn is_in(&self, buffers: &[Option<Vec<u8>>]) -> bool {
        match buffers.get(self.buffer) {
            Some(Some(bytes)) => self.end <= bytes.len(),
            Some(None) => true,
            None => false,
        }
    }
}

/// The new positions of parts of buffers.
struct Spans(Vec<Span>);

struct Span {
    from: Range,
    to: usize,
}

/// Positions are preserved modulo this, the largest alignment of any glTF component.
const ALIGNMENT: usize = 8;

impl Spans {
    /// Moves existing ranges of buffers into one buffer; its length is a multiple of four.
    fn moved(ranges: Vec<Range>, buffers: &[Option<Vec<u8>>]) -> (Self, Vec<u8>) {
        let (mut spans, mut bytes) = (Vec::new(), Vec::new());
        for from in merged(ranges) {
            let to = bytes.len().next_multiple_of(ALIGNMENT) + from.start % ALIGNMENT;
            bytes.resize(to, 0);
            bytes.extend_from_slice(buffers[from.buffer].as_ref().map_or(&[], |b| &b[from.start..from.end]));
            spans.push(Span { from, to });
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        (Self(spans), bytes)
    }

    /// Returns the new start of a range.
    fn moved_to(&self, range: &Range) -> usize {
        let begins_before = |span: &Span| (span.from.buffer, span.from.start) <= (range.buffer, range.start);
        let after = self.0.partition_point(begins_before);
        let span = after.checked_sub(1).and_then(|i| self.0.get(i));
        span.map_or(0, |span| span.to + range.start.saturating_sub(span.from.start))
    }
}

/// Returns the sorted ranges, with overlapping and adjacent ones merged.
fn merged(mut ranges: Vec<Range>) -> Vec<Range> {
    ranges.sort_unstable();
    let mut merged: Vec<Range> = Vec::new();
    for range in ranges {
        match merged.last_mut() {
            Some(last) if last.buffer == range.buffer && range.start <= last.end => {
                last.end = last.end.max(range.end);
            }
            _ => merged.push(range),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_there_once_and_aligned_as_it_was() {
        let buffers = [Some((0..40).collect()), None, Some(vec![7; 5])];
        let range = |buffer, start, end| Range { buffer, start, end };
        let ranges = vec![range(0, 12, 20), range(2, 1, 4), range(0, 16, 24), range(0, 32, 33)];
        let (spans, bytes) = Spans::moved(ranges.clone(), &buffers);
        for range in &ranges {
            let to = spans.moved_to(range);
            assert_eq!(to % ALIGNMENT, range.start % ALIGNMENT);
            let from = &buffers[range.buffer].as_ref().unwrap()[range.start..range.end];
            assert_eq!(&bytes[to..][..from.len()], from);
        }
        assert_eq!(spans.moved_to(&ranges[2]), spans.moved_to(&ranges[0]) + 4);
        assert!(bytes.len() < 40 && bytes.len().is_multiple_of(4), "{}", bytes.len());
    }

    #[test]
    fn what_is_not_there_is_known() {
        let buffers = [Some(vec![0; 4]), None];
        let is_in = |buffer, end| Range { buffer, start: 0, end }.is_in(&buffers);
        assert_eq!([is_in(0, 4), is_in(0, 5), is_in(1, 99), is_in(2, 0)], [true, false, true, false]);
    }
}
