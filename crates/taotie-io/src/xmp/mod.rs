//! XMP metadata as JSON-LD: the rights, sources and history of a model.
//!
//! Source: KHR_xmp_json_ld; XMP specification part 1 (ISO 16684-1), 8, for the properties.

mod properties;

pub use properties::XmpProperties;

use super::json::Json;
use properties::extend_context;
use serde_json::{Map, Value, json};

/// The glTF extension for XMP packets.
pub(super) const EXTENSION: &str = "KHR_xmp_json_ld";

/// A step in the history of a model, as recorded in an XMP packet (`xmpMM:History`).
///
/// ```
/// use taotie_io::XmpEvent;
///
/// /// Returns a line of a model's history.
/// fn line(event: &XmpEvent) -> String {
///     format!("{} by {}", event.action, event.agent.as_deref().unwrap_or("an unknown program"))
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct XmpEvent {
    /// The kind of step, such as `converted`; empty if the packet does not specify it.
    pub action: String,
    /// The program that performed it.
    pub agent: Option<String>,
    /// The time, as written in the packet.
    pub when: Option<String>,
    /// The parameters of the program.
    pub parameters: Option<String>,
}

impl XmpEvent {
    fn of(event: &Value) -> Self {
        let said = |name: &str| event.get(name).and_then(text);
        Self {
            action: said("stEvt:action").unwrap_or_default(),
            agent: said("stEvt:softwareAgent"),
            when: said("stEvt:when"),
            parameters: said("stEvt:parameters"),
        }
    }
}

/// Returns the rights stated in a packet (`dc:rights`): of several languages, the first, which is the default in XMP;
/// other statements are joined with semicolons. `None` if there are none.
///
/// ```
/// use taotie_io::{Json, xmp_rights};
///
/// let packet = Json::parse(r#"{ "dc:rights": { "@list": ["CC BY 4.0", "A museum"] } }"#)?;
/// assert_eq!(xmp_rights(&packet).as_deref(), Some("CC BY 4.0; A museum"));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
pub fn xmp_rights(packet: &Json) -> Option<String> {
    let rights = packet.0.get("dc:rights")?;
    let most = if rights.get("@type").is_some_and(|kind| kind == "rdf:Alt") { 1 } else { usize::MAX };
    let said: Vec<String> = texts(rights).take(most).collect();
    (!said.is_empty()).then(|| said.join("; "))
}

/// Returns the sources listed in a packet (`dc:source`), in order.
///
/// ```
/// use taotie_io::{Json, xmp_sources};
///
/// let packet = Json::parse(r#"{ "dc:source": { "@set": ["jug.ply (sha256:00ff)"] } }"#)?;
/// assert_eq!(xmp_sources(&packet), ["jug.ply (sha256:00ff)"]);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
pub fn xmp_sources(packet: &Json) -> Vec<String> {
    packet.0.get("dc:source").map(|sources| texts(sources).collect()).unwrap_or_default()
}

/// Returns the history recorded in a packet (`xmpMM:History`), the oldest step first.
pub fn xmp_history(packet: &Json) -> Vec<XmpEvent> {
    let history = packet.0.get("xmpMM:History").map(items).unwrap_or_default();
    history.into_iter().filter(|event| event.is_object()).map(XmpEvent::of).collect()
}

/// Returns the non-empty texts of a value.
fn texts(value: &Value) -> impl Iterator<Item = String> {
    items(value).into_iter().filter_map(text).filter(|text| !text.trim().is_empty())
}

/// Returns the packets of a glTF document, that of the whole asset first. Invalid packets are skipped.
pub(super) fn packets(root: &Value) -> Vec<Value> {
    let all = root.pointer("/extensions/KHR_xmp_json_ld/packets").and_then(Value::as_array);
    let mut packets: Vec<Value> = all.cloned().unwrap_or_default();
    let of_asset = root.pointer("/asset/extensions/KHR_xmp_json_ld/packet").and_then(Value::as_u64);
    if let Some(index) = of_asset.and_then(|i| usize::try_from(i).ok()).filter(|i| *i < packets.len()) {
        packets[..=index].rotate_right(1);
    }
    packets.retain(Value::is_object);
    packets
}

/// The origin of a model: its sources, the program and the parameters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Provenance<'a> {
    /// The file name of each source, without the folder, and the SHA-256 of its bytes, in hexadecimal; empty if the
    /// source is not a file.
    pub sources: &'a [[&'a str; 2]],
    /// The program and its version, such as `taotie 0.1.0`.
    pub tool: &'a str,
    /// The parameters of the run, such as the command line.
    pub parameters: &'a str,
}

impl Provenance<'_> {
    /// Returns the packet of a model made from a source with `packet`, if any. Everything in the source's packet is
    /// preserved; added are a `dc:source` (name and hash) for each file, another event in `xmpMM:History` (tool and
    /// parameters), and `xmp:CreatorTool` if missing.
    ///
    /// Ordered lists of anything but text become `rdf:Seq`, which is equivalent and is displayed by other programs.
    pub fn extend(&self, packet: Option<&Json>) -> Json {
        let mut packet = packet.and_then(|packet| packet.0.as_object()).cloned().unwrap_or_default();
        extend_context(packet.entry("@context").or_insert(Value::Null));
        for [name, sha256] in self.sources {
            append_source(&mut packet, format!("{name} (sha256:{sha256})"));
        }
        append_event(&mut packet, self.event());
        packet.entry("xmp:CreatorTool").or_insert_with(|| self.tool.into());
        for list in packet.values_mut().filter(|value| is_list_of_objects(value)) {
            *list = sequence(items(list).into_iter().cloned());
        }
        Json(Value::Object(packet))
    }

    fn event(&self) -> Value {
        json!({
            "stEvt:action": "converted",
            "stEvt:softwareAgent": self.tool,
            "stEvt:parameters": self.parameters,
        })
    }
}

/// Adds a source to those of the packet; an existing list stays a list.
fn append_source(packet: &mut Map<String, Value>, source: String) {
    let held = packet.get("dc:source").unwrap_or(&Value::Null);
    let kind = if held.get("@list").is_some() { "@list" } else { "@set" };
    let all: Vec<Value> = items(held).into_iter().cloned().chain([source.into()]).collect();
    packet.insert("dc:source".into(), json!({ kind: all }));
}

/// Adds an event to the history.
fn append_event(packet: &mut Map<String, Value>, event: Value) {
    let held = packet.get("xmpMM:History").map(items).unwrap_or_default();
    let history = sequence(held.into_iter().cloned().chain([event]));
    packet.insert("xmpMM:History".into(), history);
}

/// Returns the items of a value, which is a single one or several in one of the forms of JSON-LD and RDF: those of an
/// array, of `@set`, `@list` or an RDF container; otherwise the value itself.
fn items(value: &Value) -> Vec<&Value> {
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
fn sequence(items: impl IntoIterator<Item = Value>) -> Value {
    let numbered = (1..).zip(items).map(|(i, item): (u32, Value)| (format!("rdf:_{i}"), item));
    std::iter::once(("@type".to_owned(), json!("rdf:Seq"))).chain(numbered).collect()
}

/// Returns `true` for a `@list` of anything but text.
fn is_list_of_objects(value: &Value) -> bool {
    let list = value.get("@list");
    list.is_some_and(|list| list.as_array().is_none_or(|items| !items.iter().all(Value::is_string)))
}

/// Returns the text of a single value, with or without a language.
fn text(value: &Value) -> Option<String> {
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
    fn the_packet_of_the_asset_comes_first() {
        let of = |index: i64| {
            packets(&json!({
                "asset": { "extensions": { "KHR_xmp_json_ld": { "packet": index } } },
                "extensions": { "KHR_xmp_json_ld": { "packets": [{ "a": 1 }, 7, { "b": 1.0 }] } },
            }))
        };
        assert_eq!(of(2), [json!({ "b": 1.0 }), json!({ "a": 1 })]);
        assert_eq!(of(0), [json!({ "a": 1 }), json!({ "b": 1.0 })]);
        assert_eq!((of(9), of(-1)), (of(0), of(0)));
        assert!(packets(&json!({ "extensions": { "KHR_xmp_json_ld": { "packets": 3 } } })).is_empty());
    }

    #[test]
    fn rights_have_many_forms() {
        let rights = |value: Value| xmp_rights(&Json(json!({ "dc:rights": value })));
        let german = json!({ "@language": "de", "@value": "gemeinfrei" });
        let english = json!({ "@language": "en", "@value": "public domain" });
        let alternatives = json!({ "@type": "rdf:Alt", "rdf:_2": german, "rdf:_1": english });
        assert_eq!(rights(alternatives).as_deref(), Some("public domain"));
        assert_eq!(rights(english).as_deref(), Some("public domain"));
        assert_eq!(rights(json!("CC0")).as_deref(), Some("CC0"));
        assert_eq!(rights(json!({ "@set": ["CC0", "A museum"] })).as_deref(), Some("CC0; A museum"));
        for none in [json!(null), json!(" "), json!([]), json!({ "a": "b" }), json!({ "@type": "rdf:Alt" })] {
            assert_eq!(rights(none.clone()), None, "{none}");
        }
        assert_eq!(xmp_rights(&Json(json!(7))), None);
    }

    #[test]
    fn a_program_records_itself() {
        let made = Provenance { tool: "taotie 1.0", ..Provenance::default() };
        let history = xmp_history(&made.extend(None));
        assert_eq!(history[0].action, "converted");
        assert_eq!(history[0].agent.as_deref(), Some("taotie 1.0"));
    }

    #[test]
    fn histories_are_read_in_both_forms() {
        let scanned = json!({ "stEvt:action": "scanned", "stEvt:when": "2026-01-01" });
        let baked = json!({ "stEvt:softwareAgent": "taotie 1.0" });
        for history in [
            json!({ "@list": [scanned, baked] }),
            json!({ "@type": "rdf:Seq", "rdf:_2": baked, "rdf:_1": scanned }),
        ] {
            let events = xmp_history(&Json(json!({ "xmpMM:History": history })));
            assert_eq!((events.len(), events[0].action.as_str()), (2, "scanned"));
            assert_eq!((events[0].when.as_deref(), events[0].agent.as_deref()), (Some("2026-01-01"), None));
            assert_eq!((events[1].action.as_str(), events[1].agent.as_deref()), ("", Some("taotie 1.0")));
        }
    }

    const OURS: Provenance<'_> =
        Provenance { sources: &[["jug.glb", "00ff"]], tool: "taotie 1.2", parameters: "bake --size 2048" };

    fn extended(packet: Value) -> Value {
        OURS.extend(Some(&Json(packet))).0
    }

    #[test]
    fn a_packet_is_begun_where_there_is_none() {
        let packet = OURS.extend(None).0;
        assert_eq!(packet["@context"]["dc"], "http://purl.org/dc/elements/1.1/");
        assert_eq!(packet["@context"]["rdf"], "http://www.w3.org/1999/02/22-rdf-syntax-ns#");
        assert_eq!(packet["dc:source"], json!({ "@set": ["jug.glb (sha256:00ff)"] }));
        assert_eq!(packet["xmp:CreatorTool"], "taotie 1.2");
        assert_eq!(packet["xmpMM:History"]["@type"], "rdf:Seq");
        assert_eq!(packet["xmpMM:History"]["rdf:_1"]["stEvt:parameters"], "bake --size 2048");
    }

    #[test]
    fn what_the_source_says_stays() {
        let old = json!({
            "@context": { "dc": "http://purl.org/dc/elements/1.1/", "xmpRights": "http://ns.adobe.com/xap/1.0/rights/" },
            "dc:rights": { "@type": "rdf:Alt", "rdf:_1": { "@language": "en", "@value": "CC BY 4.0" } },
            "dc:source": "inventory 17",
            "xmp:CreatorTool": "Scanner",
            "xmpMM:History": { "@list": [{ "stEvt:action": "created" }] },
        });
        let new = extended(old.clone());
        assert_eq!(new["dc:rights"], old["dc:rights"]);
        assert_eq!(new["xmp:CreatorTool"], "Scanner");
        assert_eq!(new["@context"]["xmpRights"], old["@context"]["xmpRights"]);
        assert_eq!(new["dc:source"], json!({ "@set": ["inventory 17", "jug.glb (sha256:00ff)"] }));
        let history = items(&new["xmpMM:History"]);
        assert_eq!((history.len(), history[0]), (2, &json!({ "stEvt:action": "created" })));
        let twice = extended(new);
        assert_eq!(items(&twice["dc:source"]).len(), 3);
        assert_eq!(items(&twice["xmpMM:History"]).len(), 3);
    }

    #[test]
    fn any_context_and_any_sources_are_extended() {
        for context in [json!("https://x/"), json!(["https://x/"])] {
            let packet = extended(json!({ "@context": context, "dc:source": ["a"] }));
            assert!(packet["@context"].pointer("/1/dc").is_some(), "{packet}");
            assert_eq!(packet["dc:source"], json!({ "@set": ["a", "jug.glb (sha256:00ff)"] }));
        }
        let listed = extended(json!({ "dc:source": { "@list": ["a", "b"] } }));
        assert_eq!(listed["dc:source"], json!({ "@list": ["a", "b", "jug.glb (sha256:00ff)"] }));
        assert_eq!(extended(json!(7)), OURS.extend(None).0);
    }

    #[test]
    fn no_list_holds_anything_but_text() {
        let ingredients = json!([{ "stRef:filePath": "a" }, { "stRef:filePath": "b" }]);
        let packet = extended(json!({
            "xmpMM:Ingredients": { "@list": ingredients },
            "dc:creator": { "@list": ["a", "b"] },
        }));
        assert_eq!(packet["xmpMM:Ingredients"]["rdf:_2"], ingredients[1]);
        assert_eq!(packet["dc:creator"], json!({ "@list": ["a", "b"] }));
    }

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
