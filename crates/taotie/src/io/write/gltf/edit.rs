//! Infallible edits of JSON that create missing parts.

use crate::error::{Error, Result};
use serde_json::{Map, Value, json};

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
}
