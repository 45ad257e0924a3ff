//! Edits of a document: its JSON and its buffers. JSON changes by infallible edits that create missing parts, and by
//! removal of unused items from lists whose other items are renumbered. To buffers, bytes are added as views, and the
//! parts still in use are moved into one buffer without duplicates.

use crate::gltf::{INSTANCING, RawGltf, is_known};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use taotie_engine::error::{Error, Result};

/// Returns a member of an object, null if absent. A value that is not an object becomes one.
pub(super) fn member<'a>(of: &'a mut Value, name: &str) -> &'a mut Value {
    if !of.is_object() {
        *of = json!({});
    }
    &mut of[name]
}

/// Appends to a list; returns the item's index.
pub(super) fn push(of: &mut Value, name: &str, item: Value) -> usize {
    let list = member(of, name);
    let mut items = list.as_array_mut().map(std::mem::take).unwrap_or_default();
    items.push(item);
    let last = items.len() - 1;
    *list = Value::Array(items);
    last
}

/// Adds a name to a list of names, unless it is already there.
pub(super) fn name(of: &mut Value, list: &str, name: &str) {
    if !items(of, list).iter().any(|known| known == name) {
        push(of, list, name.into());
    }
}

/// Marks an extension as required: no program without it can read the document.
pub(super) fn require(of: &mut Value, extension: &str) {
    ["extensionsUsed", "extensionsRequired"].iter().for_each(|list| name(of, list, extension));
}

/// Returns the text of a document.
///
/// # Errors
/// [`Error::Invalid`] for values that JSON cannot express.
pub(super) fn text(json: &Value) -> Result<Vec<u8>> {
    serde_json::to_vec(json).map_err(|e| Error::invalid("glTF document", e.to_string()))
}

/// Removes a member.
pub(super) fn remove(of: &mut Value, name: &str) {
    of.as_object_mut().and_then(|members| members.remove(name));
}

/// Removes an extension of an object.
pub(super) fn drop_extension(of: &mut Value, name: &str) {
    let Some(extensions) = of.get_mut("extensions") else { return };
    remove(extensions, name);
    if *extensions == json!({}) {
        remove(of, "extensions");
    }
}

/// Removes a list and returns its items.
pub(super) fn taken(of: &mut Value, name: &str) -> Vec<Value> {
    match of.as_object_mut().and_then(|members| members.remove(name)) {
        Some(Value::Array(items)) => items,
        _ => Vec::new(),
    }
}

/// Returns the items of a list, or none if the list does not exist.
pub(super) fn items<'a>(of: &'a Value, name: &str) -> &'a [Value] {
    of.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// Returns the items of a list for editing.
pub(super) fn items_mut<'a>(of: &'a mut Value, name: &str) -> impl Iterator<Item = &'a mut Value> {
    of.get_mut(name).and_then(Value::as_array_mut).into_iter().flatten()
}

/// Returns the index in a member.
pub(super) fn number(of: &Value, name: &str) -> Option<usize> {
    usize::try_from(of.get(name)?.as_u64()?).ok()
}

/// Visits the members of every object below a value, except for those in application data. The depth is bounded by
/// the JSON parser's own limit of 128.
pub(super) fn each_object(value: &mut Value, visit: &mut impl FnMut(&mut Map<String, Value>)) {
    match value {
        Value::Object(members) => {
            visit(members);
            let below = members.iter_mut().filter(|(name, _)| *name != "extras");
            below.for_each(|(_, value)| each_object(value, visit));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| each_object(item, visit)),
        _ => {}
    }
}

/// Returns the number that prints like the float: 0.7 rather than 0.699999988.
pub(super) fn short(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// Drops the name of an extension that is no longer used by any item of the lists `holders`, such as `textures`.
pub(super) fn drop_unused(json: &mut Value, holders: &[&str], name: &str) {
    let has_it = |holder: &Value| holder.pointer(&format!("/extensions/{name}")).is_some();
    if holders.iter().flat_map(|list| items(json, list)).any(has_it) {
        return;
    }
    for list in ["extensionsUsed", "extensionsRequired"] {
        let names: Vec<Value> = taken(json, list).into_iter().filter(|known| known != name).collect();
        if !names.is_empty() {
            json[list] = Value::Array(names);
        }
    }
}

/// Visits all references to items of one kind in a document.
pub(super) type Visit = fn(&mut Value, &mut dyn FnMut(&mut Value));

/// Drops the unreferenced items of a list, and renumbers the others; returns the old indices of those kept.
pub(super) fn drop_unnamed(json: &mut Value, list: &str, each: Visit) -> Vec<u64> {
    let mut named = BTreeSet::new();
    each(json, &mut |number| named.extend(number.as_u64()));
    let items = taken(json, list);
    let kept: Vec<u64> = (0..items.len() as u64).filter(|i| named.contains(i)).collect();
    each(json, &mut |number| {
        if let Some(old) = number.as_u64() {
            // An invalid index stays invalid.
            *number = kept.binary_search(&old).unwrap_or(kept.len()).into();
        }
    });
    let is_kept = |(i, _): &(usize, Value)| kept.binary_search(&(*i as u64)).is_ok();
    let items: Vec<Value> = items.into_iter().enumerate().filter(is_kept).map(|(_, item)| item).collect();
    if !items.is_empty() {
        json[list] = Value::Array(items);
    }
    kept
}

/// Empties the items of a list that neither a reference nor one of `foreign` numbers names, so that all keep their numbers;
/// drops the list if none is named.
pub(super) fn empty_unnamed(json: &mut Value, list: &str, (each, foreign): (Visit, &BTreeSet<u64>)) {
    let mut named = foreign.clone();
    each(json, &mut |number| named.extend(number.as_u64()));
    let mut items = taken(json, list);
    let is_named = |i: usize| named.contains(&(i as u64));
    let empty = match list {
        "accessors" => Some(json!({ "componentType": 5121, "count": 1, "type": "SCALAR" })),
        // The first byte of a view that is kept.
        _ => items.iter().enumerate().find(|(i, _)| is_named(*i)).map(|(_, view)| {
            let [buffer, offset] = ["buffer", "byteOffset"].map(|name| number(view, name).unwrap_or(0));
            json!({ "buffer": buffer, "byteOffset": offset, "byteLength": 1 })
        }),
    };
    let Some(empty) = empty.filter(|_| (0..items.len()).any(is_named)) else { return };
    let unnamed = items.iter_mut().enumerate().filter(|(i, _)| !is_named(*i));
    unnamed.for_each(|(_, item)| *item = empty.clone());
    json[list] = Value::Array(items);
}

/// Returns the numbers in extensions that are neither known nor about materials, textures or lights: any of them may be that
/// of an accessor or a view.
pub(super) fn foreign_numbers(json: &Value) -> BTreeSet<u64> {
    fn all(value: &Value, found: &mut BTreeSet<u64>) {
        match value {
            Value::Object(members) => members.values().for_each(|value| all(value, found)),
            Value::Array(items) => items.iter().for_each(|value| all(value, found)),
            Value::Number(number) => found.extend(number.as_u64()),
            _ => {}
        }
    }
    fn search(value: &Value, found: &mut BTreeSet<u64>) {
        match value {
            Value::Object(members) => {
                let extensions = members.get("extensions").and_then(Value::as_object).into_iter().flatten();
                let foreign = extensions.filter(|(name, _)| !names_no_geometry(name));
                foreign.for_each(|(_, value)| all(value, found));
                let below = members.iter().filter(|(name, _)| *name != "extras");
                below.for_each(|(_, value)| search(value, found));
            }
            Value::Array(items) => items.iter().for_each(|item| search(item, found)),
            _ => {}
        }
    }
    let mut found = BTreeSet::new();
    search(json, &mut found);
    found
}

/// Removes an extension from an object.
pub(super) fn remove_extension(json: &mut Value, name: &str) {
    let Some(extensions) = json.get_mut("extensions").and_then(Value::as_object_mut) else { return };
    extensions.remove(name);
    if extensions.is_empty() {
        remove(json, "extensions");
    }
}

/// Visits the textures of materials: `index` of members such as `normalTexture`.
pub(super) fn each_texture(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        let slots = members.iter_mut().filter(|(name, _)| name.ends_with("Texture"));
        slots.filter_map(|(_, slot)| slot.get_mut("index")).for_each(&mut *visit);
    };
    items_mut(json, "materials").for_each(|material| each_object(material, &mut of));
}

/// Visits the images of textures.
pub(super) fn each_image(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        members.get_mut("source").into_iter().for_each(&mut *visit);
    };
    items_mut(json, "textures").for_each(|texture| each_object(texture, &mut of));
}

/// Visits the views of accessors, images and everything else.
pub(super) fn each_view(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        members.get_mut("bufferView").into_iter().for_each(&mut *visit);
    };
    each_object(json, &mut of);
}

/// Visits the accessors of primitives, instances, skins and animations.
pub(super) fn each_accessor(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for mesh in items_mut(json, "meshes") {
        for primitive in items_mut(mesh, "primitives") {
            primitive.get_mut("indices").into_iter().for_each(&mut *visit);
            for attributes in items_mut(primitive, "targets") {
                attributes.as_object_mut().into_iter().flatten().for_each(|(_, accessor)| visit(accessor));
            }
            let attributes = primitive.get_mut("attributes").and_then(Value::as_object_mut);
            attributes.into_iter().flatten().for_each(|(_, accessor)| visit(accessor));
        }
    }
    for node in items_mut(json, "nodes") {
        let attributes = node.pointer_mut(&format!("/extensions/{INSTANCING}/attributes"));
        let attributes = attributes.and_then(Value::as_object_mut);
        attributes.into_iter().flatten().for_each(|(_, accessor)| visit(accessor));
    }
    items_mut(json, "skins").filter_map(|skin| skin.get_mut("inverseBindMatrices")).for_each(&mut *visit);
    for animation in items_mut(json, "animations") {
        for sampler in items_mut(animation, "samplers") {
            ["input", "output"].iter().for_each(|name| {
                sampler.get_mut(*name).into_iter().for_each(&mut *visit);
            });
        }
    }
}

/// Returns `true` if an extension is known, or is about materials, textures or lights.
pub(super) fn names_no_geometry(name: &str) -> bool {
    let looks = ["KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "EXT_lights_"];
    is_known(name) || looks.iter().any(|prefix| name.starts_with(prefix))
}

/// Adds bytes as a view; returns its index.
pub(super) fn add_view(raw: &mut RawGltf, bytes: Vec<u8>) -> usize {
    let view = json!({ "buffer": raw.buffers.len(), "byteOffset": 0, "byteLength": bytes.len() });
    raw.buffers.push(Some(bytes));
    push(&mut raw.json, "bufferViews", view)
}

/// Moves the bytes used by views into one buffer, which it returns; its length is a multiple of four. Overlapping
/// views still overlap. The document's buffers become this one, without a URI, followed by those that never had any
/// bytes.
///
/// # Errors
/// [`taotie_engine::Error::Parse`] if a view refers to missing bytes.
pub(super) fn joined_buffers(raw: &mut RawGltf) -> Result<Vec<u8>> {
    let mut views = taken(&mut raw.json, "bufferViews");
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
    let start = number(place, "byteOffset").unwrap_or(0);
    let end = start.checked_add(number(place, "byteLength")?)?;
    Some(Range { buffer: number(place, "buffer")?, start, end })
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
    let declared = taken(json, "buffers");
    let kept = empty.iter().filter_map(|i| declared.get(*i).cloned()).map(|mut buffer| {
        remove(&mut buffer, "uri");
        buffer
    });
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
    fn lists_and_members_are_made() {
        let mut json = json!({ "a": 1 });
        assert_eq!([push(&mut json, "list", json!(5)), push(&mut json, "list", json!(6))], [0, 1]);
        *member(member(&mut json, "a"), "b") = json!(2);
        ["x", "y", "x"].iter().for_each(|text| name(&mut json, "names", text));
        remove(&mut json, "nobody");
        assert_eq!(json, json!({ "a": { "b": 2 }, "list": [5, 6], "names": ["x", "y"] }));
    }

    #[test]
    fn application_data_is_not_visited() {
        let mut json = json!({ "a": [{ "bufferView": 1 }], "extras": { "bufferView": 2 } });
        let mut seen = Vec::new();
        each_object(&mut json, &mut |members| seen.extend(members.get("bufferView").cloned()));
        assert_eq!(seen, [json!(1)]);
    }

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
