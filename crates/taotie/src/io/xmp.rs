//! XMP packets as JSON-LD: the source of a model, and the tool that made it.
//!
//! Source: KHR_xmp_json_ld; XMP specification part 1 (ISO 16684-1), 8, for the properties.

use super::json::Json;
use serde_json::{Map, Value, json};

/// The extension of glTF that holds packets.
pub(super) const EXTENSION: &str = "KHR_xmp_json_ld";

/// The prefixes that [`Provenance`] uses, and their namespaces.
const CONTEXT: [(&str, &str); 4] = [
    ("dc", "http://purl.org/dc/elements/1.1/"),
    ("stEvt", "http://ns.adobe.com/xap/1.0/sType/ResourceEvent#"),
    ("xmp", "http://ns.adobe.com/xap/1.0/"),
    ("xmpMM", "http://ns.adobe.com/xap/1.0/mm/"),
];

/// The origin of a model: its source, the program and the parameters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Provenance<'a> {
    /// The file name of the source, without folder; empty where it is no file, of which nothing is said then.
    pub source: &'a str,
    /// The SHA-256 of the source's bytes, hexadecimal.
    pub sha256: &'a str,
    /// The program and its version, such as `taotie 0.1.0`.
    pub tool: &'a str,
    /// The parameters of the run, such as the command line.
    pub parameters: &'a str,
}

impl Provenance<'_> {
    /// Returns the packet of a model made of a source that has `packet`, which may be none. Everything in the source's
    /// packet stays; added are one more `dc:source` (name and hash), one more event in `xmpMM:History` (tool and
    /// parameters), and `xmp:CreatorTool` where there is none.
    pub fn extend(&self, packet: Option<&Json>) -> Json {
        let mut packet = packet.and_then(|packet| packet.0.as_object()).cloned().unwrap_or_default();
        extend_context(&mut packet);
        let source = format!("{} (sha256:{})", self.source, self.sha256);
        if !self.source.is_empty() {
            append(&mut packet, ("dc:source", "@set"), source.into());
        }
        let event = json!({
            "stEvt:action": "converted",
            "stEvt:softwareAgent": self.tool,
            "stEvt:parameters": self.parameters,
        });
        append(&mut packet, ("xmpMM:History", "@list"), event);
        packet.entry("xmp:CreatorTool").or_insert_with(|| self.tool.into());
        Json(Value::Object(packet))
    }
}

/// Adds the names that are lacking.
fn extend_context(packet: &mut Map<String, Value>) {
    let ours = || CONTEXT.into_iter().map(|(name, address)| (name.to_owned(), Value::from(address)));
    match packet.entry("@context").or_insert_with(|| json!({})) {
        Value::Object(known) => ours().for_each(|(name, address)| {
            known.entry(name).or_insert(address);
        }),
        Value::Array(contexts) => contexts.push(ours().collect()),
        other => *other = json!([other.take(), ours().collect::<Value>()]),
    }
}

/// Adds a value to a property, which becomes a collection of this `kind` where it holds a single one.
fn append(packet: &mut Map<String, Value>, (name, kind): (&str, &str), value: Value) {
    let held = packet.entry(name).or_insert_with(|| json!({ kind: [] }));
    let items = match held {
        Value::Object(members) => {
            let collection =
                ["@set", "@list"].into_iter().find(|kind| members.get(*kind).is_some_and(Value::is_array));
            collection.and_then(|kind| members.get_mut(kind))
        }
        Value::Array(_) => Some(&mut *held),
        _ => None,
    };
    match items.and_then(Value::as_array_mut) {
        Some(items) => items.push(value),
        None => {
            let old = packet.insert(name.to_owned(), Value::Null);
            packet.insert(name.to_owned(), json!({ kind: [old, value] }));
        }
    }
}

/// The packets of a glTF document, that of the whole asset first. What is no packet is left out.
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

#[cfg(test)]
mod tests {
    use super::*;

    const OURS: Provenance<'_> =
        Provenance { source: "jug.glb", sha256: "00ff", tool: "taotie 1.2", parameters: "bake --size 2048" };

    fn extended(packet: Value) -> Value {
        OURS.extend(Some(&Json(packet))).0
    }

    #[test]
    fn a_packet_is_begun_where_there_is_none() {
        let packet = OURS.extend(None).0;
        assert_eq!(packet["@context"]["dc"], "http://purl.org/dc/elements/1.1/");
        assert_eq!(packet["dc:source"], json!({ "@set": ["jug.glb (sha256:00ff)"] }));
        assert_eq!(packet["xmp:CreatorTool"], "taotie 1.2");
        assert_eq!(packet["xmpMM:History"]["@list"][0]["stEvt:parameters"], "bake --size 2048");
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
        let history = new["xmpMM:History"]["@list"].as_array().unwrap();
        assert_eq!((history.len(), &history[0]), (2, &json!({ "stEvt:action": "created" })));
        let twice = extended(new);
        assert_eq!(twice["dc:source"]["@set"].as_array().unwrap().len(), 3);
        assert_eq!(twice["xmpMM:History"]["@list"].as_array().unwrap().len(), 3);
    }

    #[test]
    fn any_context_is_extended() {
        for (context, at) in
            [(json!("https://x/"), "/1/dc"), (json!(["https://x/"]), "/1/dc"), (json!({}), "/dc")]
        {
            let packet = extended(json!({ "@context": context, "dc:source": ["a"] }));
            assert!(packet["@context"].pointer(at).is_some(), "{packet}");
            assert_eq!(packet["dc:source"].as_array().unwrap().len(), 2);
        }
        assert_eq!(extended(json!(7)), OURS.extend(None).0);
    }

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
}
