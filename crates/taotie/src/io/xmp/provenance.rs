//! The source of a model and the tool that made it, added to its source's metadata.

use super::context;
use super::values::{is_list_of_objects, items, sequence};
use crate::io::json::Json;
use serde_json::{Map, Value, json};

/// The origin of a model: its source, the program and the parameters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Provenance<'a> {
    /// The file name of the source, without the folder; empty if it is not a file, in which case it is omitted.
    pub source: &'a str,
    /// The SHA-256 of the source's bytes, in hexadecimal.
    pub sha256: &'a str,
    /// The program and its version, such as `taotie 0.1.0`.
    pub tool: &'a str,
    /// The parameters of the run, such as the command line.
    pub parameters: &'a str,
}

impl Provenance<'_> {
    /// Returns the packet of a model made from a source with `packet`, if any. Everything in the source's packet is
    /// preserved; added are another `dc:source` (name and hash), another event in `xmpMM:History` (tool and
    /// parameters), and `xmp:CreatorTool` if missing.
    ///
    /// Ordered lists of anything but text become `rdf:Seq`, which is equivalent and is displayed by other programs.
    pub fn extend(&self, packet: Option<&Json>) -> Json {
        let mut packet = packet.and_then(|packet| packet.0.as_object()).cloned().unwrap_or_default();
        context::extend(packet.entry("@context").or_insert(Value::Null));
        if !self.source.is_empty() {
            append_source(&mut packet, format!("{} (sha256:{})", self.source, self.sha256));
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
}
