//! A collection as an IIIF document.

use super::{Entry, Gallery};
use serde_json::{Value, json};

/// The JSON-LD context of version 4 of the Presentation API, the first version with 3D scenes.
const CONTEXT: &str = "http://iiif.io/api/presentation/4/context.json";

/// Writes an IIIF Presentation API 4 collection: a manifest with one scene for each asset that has a model. `address`
/// is where the page will be published, since IIIF requires absolute URLs.
///
/// ```
/// use taotie_report::collection_page::{Entry, Gallery, iiif};
///
/// let jue = Entry { id: "jue.ply".into(), model: Some("objects/1f/1f2e/jue.glb".into()), ..Entry::default() };
/// let text = iiif(&Gallery { title: "Bronzes".into(), assets: vec![jue] }, "https://museum.example/bronzes");
/// assert!(text.contains("https://museum.example/bronzes/objects/1f/1f2e/jue.glb"));
/// ```
pub fn iiif(gallery: &Gallery, address: &str) -> String {
    let base = format!("{}/", address.trim_end_matches('/'));
    let base = if address.is_empty() { "" } else { base.as_str() };
    let items = gallery.assets.iter().filter_map(|asset| manifest(asset, base));
    let collection = json!({
        "@context": CONTEXT,
        "id": format!("{base}iiif.json"),
        "type": "Collection",
        "label": label(&gallery.title),
        "items": items.collect::<Vec<_>>(),
    });
    format!("{collection:#}")
}

/// Returns the manifest of an asset; `None` if it has no model.
fn manifest(asset: &Entry, base: &str) -> Option<Value> {
    let model = format!("{base}{}", asset.model.as_ref()?);
    let scene = format!("{model}#scene");
    let name = asset.title.as_ref().unwrap_or(&asset.id);
    let mut manifest = json!({
        "id": format!("{model}#manifest"),
        "type": "Manifest",
        "label": label(name),
        "items": [{
            "id": scene,
            "type": "Scene",
            "label": label(name),
            "items": [{
                "id": format!("{model}#page"),
                "type": "AnnotationPage",
                "items": [{
                    "id": format!("{model}#annotation"),
                    "type": "Annotation",
                    "motivation": ["painting"],
                    "body": [{ "id": model, "type": "Model", "format": "model/gltf-binary" }],
                    "target": [{ "id": scene, "type": "Scene" }],
                }],
            }],
        }],
    });
    if let Some(picture) = &asset.thumbnail {
        let id = format!("{base}{picture}");
        manifest["thumbnail"] = json!([{ "id": id, "type": "Image", "format": "image/webp" }]);
    }
    Some(manifest)
}

/// Returns a language map for a text without a language.
fn label(text: &str) -> Value {
    json!({ "none": [text] })
}
