//! Values of XMP properties: a single value, or several in one of the forms of JSON-LD and RDF.

use serde_json::{Map, Value, json};

/// Returns the items of a value: those of an array, of `@set`, `@list` or an RDF container; otherwise the value
/// itself.
pub(super) fn items(value: &Value) -> Vec<&Value> {
    match value {
        Value::Null => Vec::new(),
        Value::Array(items) => items.iter().collect(),
        Value::Object(members) => members_of(members).unwrap_or_else(|| vec![value]),
        _ => vec![value],
    }
}

/// Returns the items of an object that is a collection.
fn members_of(object: &Map<String, Value>) -> Option<Vec<&Value>> {
    if let Some(listed) = ["@set", "@list"].iter().find_map(|kind| object.get(*kind)) {
        return Some(items(listed));
    }
    let kind = object.get("@type").and_then(Value::as_str);
    matches!(kind, Some("rdf:Seq" | "rdf:Bag" | "rdf:Alt")).then(|| numbered(object))
}

/// Returns the members `rdf:_1`, `rdf:_2` and so on, in numeric order.
fn numbered(container: &Map<String, Value>) -> Vec<&Value> {
    let number = |name: &str| name.strip_prefix("rdf:_")?.parse::<u32>().ok();
    let mut items: Vec<(u32, &Value)> =
        container.iter().filter_map(|(name, value)| Some((number(name)?, value))).collect();
    items.sort_by_key(|(number, _)| *number);
    items.into_iter().map(|(_, value)| value).collect()
}

/// Returns ordered items as an RDF container. Programs expect each item of a `@list` to be text: `gltf-transform
/// inspect` fails if one is an object.
pub(super) fn sequence(items: impl IntoIterator<Item = Value>) -> Value {
    let numbered = (1..).zip(items).map(|(i, item): (u32, Value)| (format!("rdf:_{i}"), item));
    std::iter::once(("@type".to_owned(), json!("rdf:Seq"))).chain(numbered).collect()
}

/// Returns `true` for a `@list` of anything but text.
pub(super) fn is_list_of_objects(value: &Value) -> bool {
    let list = value.get("@list");
    list.is_some_and(|list| list.as_array().is_none_or(|items| !items.iter().all(Value::is_string)))
}

/// Returns the text of a single value, with or without a language.
pub(super) fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(_) | Value::Bool(_) => Some(value.to_string()),
        Value::Object(members) => text(members.get("@value").or_else(|| members.get("@id"))?),
        Value::Null | Value::Array(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_values_have_many_forms() {
        let wanted = json!(["a", "b"]);
        let forms = [
            json!(["a", "b"]),
            json!({ "@set": ["a", "b"] }),
            json!({ "@list": ["a", "b"] }),
            json!({ "@type": "rdf:Bag", "rdf:_2": "b", "rdf:_1": "a" }),
        ];
        for form in &forms {
            assert_eq!(json!(items(form)), wanted, "{form}");
        }
        assert_eq!((items(&json!("a")), items(&json!(null)).len()), (vec![&json!("a")], 0));
        assert_eq!(items(&json!({ "@value": "a" })).len(), 1);
    }

    #[test]
    fn a_sequence_keeps_its_order() {
        let twelve: Vec<Value> = (0..12).map(|i| json!(i)).collect();
        let made = sequence(twelve.clone());
        assert_eq!((&made["@type"], &made["rdf:_12"]), (&json!("rdf:Seq"), &json!(11)));
        assert_eq!(items(&made), twelve.iter().collect::<Vec<_>>());
    }

    #[test]
    fn lists_that_other_programs_trip_over_are_known() {
        for (list, is) in
            [(json!(["a"]), false), (json!([]), false), (json!(["a", 1]), true), (json!("a"), true)]
        {
            assert_eq!(is_list_of_objects(&json!({ "@list": list })), is, "{list}");
        }
        assert!(!is_list_of_objects(&json!([{}])));
    }

    #[test]
    fn a_language_is_no_part_of_a_text() {
        assert_eq!(text(&json!({ "@language": "en", "@value": "CC0" })).as_deref(), Some("CC0"));
        assert_eq!(text(&json!({ "@id": "https://x/" })).as_deref(), Some("https://x/"));
        assert_eq!((text(&json!(4)).as_deref(), text(&json!({ "a": "b" }))), (Some("4"), None));
    }
}
