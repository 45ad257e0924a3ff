//! The packets of a glTF document, and the rights, sources and history in them.

use super::values::{items, text};
use crate::io::json::Json;
use serde_json::Value;

/// The glTF extension for XMP packets.
pub(in crate::io) const EXTENSION: &str = "KHR_xmp_json_ld";

/// A step in the history of a model, as recorded in an XMP packet (`xmpMM:History`).
///
/// ```
/// use taotie::io::XmpEvent;
///
/// /// Returns a line of a model's history.
/// fn line(event: &XmpEvent) -> String {
///     format!("{} by {}", event.action, event.agent.as_deref().unwrap_or("an unknown program"))
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
/// use taotie::io::{Json, xmp_rights};
///
/// let packet = Json::parse(r#"{ "dc:rights": { "@list": ["CC BY 4.0", "A museum"] } }"#)?;
/// assert_eq!(xmp_rights(&packet).as_deref(), Some("CC BY 4.0; A museum"));
/// # Ok::<(), taotie::Error>(())
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
/// use taotie::io::{Json, xmp_sources};
///
/// let packet = Json::parse(r#"{ "dc:source": { "@set": ["jug.ply (sha256:00ff)"] } }"#)?;
/// assert_eq!(xmp_sources(&packet), ["jug.ply (sha256:00ff)"]);
/// # Ok::<(), taotie::Error>(())
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
pub(in crate::io) fn packets(root: &Value) -> Vec<Value> {
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
    use crate::io::Provenance;
    use serde_json::json;

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
}
