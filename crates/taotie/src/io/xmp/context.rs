//! The context of a packet: the namespaces of its prefixes.

use serde_json::{Map, Value};

/// The prefixes of every packet that Taotie writes, and their namespaces.
const OURS: [(&str, &str); 5] = [
    ("dc", "http://purl.org/dc/elements/1.1/"),
    ("rdf", "http://www.w3.org/1999/02/22-rdf-syntax-ns#"),
    ("stEvt", "http://ns.adobe.com/xap/1.0/sType/ResourceEvent#"),
    ("xmp", "http://ns.adobe.com/xap/1.0/"),
    ("xmpMM", "http://ns.adobe.com/xap/1.0/mm/"),
];

/// Further prefixes that need no user-defined context.
const COMMON: [(&str, &str); 6] = [
    ("Iptc4xmpCore", "http://iptc.org/std/Iptc4xmpCore/1.0/xmlns/"),
    ("Iptc4xmpExt", "http://iptc.org/std/Iptc4xmpExt/2008-02-29/"),
    ("model3d", "https://schema.khronos.org/model3d/xsd/1.0/"),
    ("photoshop", "http://ns.adobe.com/photoshop/1.0/"),
    ("stRef", "http://ns.adobe.com/xap/1.0/sType/ResourceRef#"),
    ("xmpRights", "http://ns.adobe.com/xap/1.0/rights/"),
];

/// Returns the common namespace of a prefix.
pub(super) fn namespace(prefix: &str) -> Option<&'static str> {
    OURS.iter().chain(&COMMON).find(|(name, _)| *name == prefix).map(|(_, address)| *address)
}

/// Adds missing prefixes of ours. Several contexts become one object; references to external contexts stay before it.
pub(super) fn extend(context: &mut Value) {
    let parts = match context.take() {
        Value::Array(parts) => parts,
        one => vec![one],
    };
    let (mut names, mut elsewhere) = (Map::new(), Vec::new());
    for part in parts {
        match part {
            Value::Object(more) => names.extend(more),
            Value::String(_) => elsewhere.push(part),
            _ => {}
        }
    }
    for (name, address) in OURS {
        names.entry(name).or_insert_with(|| address.into());
    }
    *context = match elsewhere.is_empty() {
        true => names.into(),
        false => elsewhere.into_iter().chain([names.into()]).collect(),
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn contexts_become_one_object_where_they_can() {
        let extended = |mut context: Value| {
            extend(&mut context);
            context
        };
        let bare = extended(Value::Null);
        assert_eq!(bare["dc"], "http://purl.org/dc/elements/1.1/");
        let joined = extended(json!([{ "a": "https://a/" }, 7, { "a": "https://b/", "dc": "https://c/" }]));
        assert_eq!((&joined["a"], &joined["dc"]), (&json!("https://b/"), &json!("https://c/")));
        assert_eq!(joined["rdf"], bare["rdf"]);
        assert_eq!(extended(json!("https://x/")), json!(["https://x/", bare]));
    }
}
