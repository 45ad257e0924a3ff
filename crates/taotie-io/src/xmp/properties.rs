//! User-specified XMP properties for an asset, validated before any work is done; and the namespaces of their
//! prefixes.

use crate::file;
use crate::json::{Json, broken};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::result::Result as Checked;
use taotie_engine::error::{Error, Result};

/// Keys that start with `@` and may occur in a value.
const KEYWORDS: [&str; 6] = ["@id", "@language", "@list", "@set", "@type", "@value"];

/// Maximum size of a properties file in bytes: nested lists take a hundred times as much memory when read.
const MOST_BYTES: u64 = 1 << 20;

/// XMP properties as JSON-LD whose prefixes all have a namespace.
#[derive(Debug, Clone, PartialEq)]
pub struct XmpProperties(Map<String, Value>);

impl XmpProperties {
    /// Reads a file of properties, such as `{ "dc:title": "Jue" }`. Prefixes commonly used in XMP need no `@context`.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Limit`] if it is larger than a mebibyte; [`Error::Parse`] if the file is not valid
    /// JSON; [`Error::Invalid`] if it is not an object, a prefix has no namespace, or a value has a form that
    /// programs do not read.
    pub fn read(path: &Path) -> Result<Self> {
        if file::file_size(path)? > MOST_BYTES {
            return Err(Error::limit(path.display().to_string(), "the maximum for XMP properties is 1 MiB"));
        }
        let no_json = |error: serde_json::Error| broken(path, &error);
        let Value::Object(given) = serde_json::from_slice(&file::read(path)?).map_err(no_json)? else {
            let why = "expected a JSON object of XMP properties, such as {\"dc:title\": \"…\"}";
            return Err(Error::invalid(path.display().to_string(), why));
        };
        checked(given)
            .map_err(|Fault { property, why }| Error::invalid(format!("{}: {property}", path.display()), why))
    }

    /// Returns a packet with these properties, which override its own; contexts are joined.
    pub fn merged_into(self, packet: Option<&Json>) -> Json {
        let mut packet = packet.and_then(|packet| packet.0.as_object()).cloned().unwrap_or_default();
        for (name, value) in self.0 {
            let held = packet.entry(name.as_str()).or_insert(Value::Null);
            *held = match held.take() {
                known if name == "@context" => joined(known, value),
                _ => value,
            };
        }
        Json(packet.into())
    }
}

/// Joins two contexts into one array, in which the later one overrides the first.
fn joined(known: Value, more: Value) -> Value {
    match known {
        Value::Array(parts) => parts.into_iter().chain([more]).collect(),
        one => json!([one, more]),
    }
}

/// An invalid property.
#[derive(Debug)]
struct Fault {
    property: String,
    why: String,
}

fn checked(mut given: Map<String, Value>) -> Checked<XmpProperties, Fault> {
    let mut prefixes = Prefixes::of(given.remove("@context"))?;
    for (name, value) in &given {
        let faulty = |why| Fault { property: name.clone(), why };
        let is_about = ["@id", "@type"].contains(&name.as_str());
        if !is_about {
            prefixes.check(name).map_err(faulty)?;
            prefixes.check_value(value).map_err(faulty)?;
        }
    }
    given.insert("@context".into(), prefixes.0.into_iter().collect());
    Ok(XmpProperties(given))
}

/// Prefixes and their namespaces.
struct Prefixes(BTreeMap<String, Value>);

impl Prefixes {
    fn of(context: Option<Value>) -> Checked<Self, Fault> {
        let why = "expected an object of prefixes and their namespaces";
        let wrong = || Fault { property: "@context".into(), why: why.into() };
        let names = match context {
            None => return Ok(Self(BTreeMap::new())),
            Some(Value::Object(names)) => names,
            Some(_) => return Err(wrong()),
        };
        let is_address = |address: &Value| address.as_str().is_some_and(|address| address.contains(':'));
        if names.values().all(is_address) { Ok(Self(names.into_iter().collect())) } else { Err(wrong()) }
    }

    /// Checks that a name has a known prefix, and adds the namespace if it is a common one.
    fn check(&mut self, name: &str) -> Checked<(), String> {
        let Some((prefix, rest)) = name.split_once(':').filter(|(_, rest)| !rest.is_empty()) else {
            return Err(format!("`{name}` has no prefix; use a name such as dc:title"));
        };
        if rest.starts_with("//") {
            return Err(format!("`{name}` is a URL; define a prefix for it in @context"));
        }
        if self.0.contains_key(prefix) {
            return Ok(());
        }
        let unknown = || format!("unknown prefix `{prefix}`; add its namespace to @context");
        let address = namespace(prefix).ok_or_else(unknown)?;
        self.0.insert(prefix.to_owned(), address.into());
        Ok(())
    }

    fn check_value(&mut self, value: &Value) -> Checked<(), String> {
        match value {
            Value::Null => Err("it has no value".into()),
            Value::Array(items) => self.check_items(items),
            Value::Object(members) => self.check_members(members),
            _ => Ok(()),
        }
    }

    fn check_items(&mut self, items: &[Value]) -> Checked<(), String> {
        if items.iter().any(Value::is_array) {
            return Err("nested arrays are not supported".into());
        }
        items.iter().try_for_each(|item| self.check_value(item))
    }

    fn check_members(&mut self, members: &Map<String, Value>) -> Checked<(), String> {
        let is_array = |kind: &str| members.get(kind).is_none_or(Value::is_array);
        if let Some(kind) = ["@list", "@set"].into_iter().find(|kind| !is_array(kind)) {
            return Err(format!("its {kind} is not an array"));
        }
        let is_choice = members.get("@type").is_some_and(|kind| kind == "rdf:Alt");
        if is_choice && members.get("rdf:_1").and_then(|first| first.get("@value")).is_none() {
            return Err("its rdf:Alt has no rdf:_1 with a @value".into());
        }
        for (name, value) in members {
            if !KEYWORDS.contains(&name.as_str()) {
                self.check(name)?;
            }
            self.check_value(value)?;
        }
        members.get("@type").and_then(Value::as_str).map_or(Ok(()), |kind| self.check(kind))
    }
}

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
fn namespace(prefix: &str) -> Option<&'static str> {
    OURS.iter().chain(&COMMON).find(|(name, _)| *name == prefix).map(|(_, address)| *address)
}

/// Adds missing prefixes of ours to the context of a packet, which has the namespaces of its prefixes. Several
/// contexts become one object; references to external contexts stay before it.
pub(super) fn extend_context(context: &mut Value) {
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

    fn given(value: Value) -> Checked<XmpProperties, Fault> {
        checked(value.as_object().cloned().unwrap_or_default())
    }

    #[test]
    fn common_prefixes_need_no_context() {
        let properties = given(json!({
            "dc:title": { "@type": "rdf:Alt", "rdf:_1": { "@language": "en", "@value": "Jue" } },
            "dc:creator": { "@list": ["a", "b"] },
            "dc:subject": ["bronze", "vessel"],
            "xmp:Rating": 4,
            "xmpRights:Marked": true,
            "mus:number": "17",
            "@context": { "mus": "https://museum.example/" },
        }))
        .unwrap();
        let names: Vec<&str> =
            properties.0["@context"].as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(names, ["dc", "mus", "rdf", "xmp", "xmpRights"]);
    }

    #[test]
    fn what_programs_cannot_read_is_refused() {
        let cases = [
            (json!({ "title": "a" }), "title", "has no prefix"),
            (json!({ "dc:": "a" }), "dc:", "has no prefix"),
            (json!({ "http://purl.org/dc/elements/1.1/title": "a" }), "http://", "define a prefix"),
            (json!({ "dcx:title": "a" }), "dcx:title", "unknown prefix `dcx`; add its namespace"),
            (json!({ "dc:title": null }), "dc:title", "no value"),
            (json!({ "dc:title": [["a"]] }), "dc:title", "nested arrays"),
            (json!({ "dc:title": { "@list": "a" } }), "dc:title", "its @list is not an array"),
            (json!({ "dc:title": { "@set": [null] } }), "dc:title", "no value"),
            (json!({ "dc:title": { "@type": "rdf:Alt" } }), "dc:title", "no rdf:_1"),
            (json!({ "dc:title": { "dcx:a": "b" } }), "dc:title", "unknown prefix `dcx`"),
            (json!({ "dc:title": { "@graph": [] } }), "dc:title", "`@graph` has no prefix"),
            (json!({ "dc:title": { "@type": "dcx:A" } }), "dc:title", "unknown prefix `dcx`"),
            (json!({ "@context": "https://x/" }), "@context", "an object of prefixes"),
            (json!({ "@context": { "a": 1 } }), "@context", "an object of prefixes"),
        ];
        for (value, at, why) in cases {
            let fault = given(value.clone()).unwrap_err();
            assert!(fault.property.contains(at) && fault.why.contains(why), "{value}: {fault:?}");
        }
    }

    #[test]
    fn what_is_given_goes_before_what_the_scan_says() {
        let scan = Json(json!({
            "@context": [{ "mus": "https://old/" }, { "a": "https://a/" }],
            "dc:title": "old",
            "a:b": "stays",
        }));
        let more = given(json!({ "dc:title": "new", "@context": { "mus": "https://new/" } })).unwrap();
        let merged = more.clone().merged_into(Some(&scan)).0;
        assert_eq!((&merged["dc:title"], &merged["a:b"]), (&json!("new"), &json!("stays")));
        let contexts = merged["@context"].as_array().unwrap();
        assert_eq!((contexts.len(), &contexts[2]["mus"]), (3, &json!("https://new/")));
        assert_eq!(more.merged_into(None).0["dc:title"], "new");
    }

    #[test]
    fn contexts_become_one_object_where_they_can() {
        let extended = |mut context: Value| {
            extend_context(&mut context);
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
