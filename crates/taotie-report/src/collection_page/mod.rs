//! A collection as one page, every asset with its picture and figures, worst first; and as an IIIF document.
//!
//! The page opens from disk, even with ten thousand assets. It shows its embedded data and pictures next to it, and
//! fetches nothing else.

use crate::document::{Document, json_element, report, sha256};
use serde::Serialize;
use serde_json::{Value, json};

const STYLE: [&str; 2] = [include_str!("../page.css"), include_str!("collection.css")];

/// The parts of the script; the last one starts it.
const SCRIPT: [&str; 8] = [
    "\"use strict\";\n",
    include_str!("../page/dom.js"),
    include_str!("../page/numbers.js"),
    include_str!("figures.js"),
    include_str!("choice.js"),
    include_str!("cards.js"),
    include_str!("rows.js"),
    include_str!("main.js"),
];

/// The JSON-LD context of version 4 of the IIIF Presentation API, the first version with 3D scenes.
const IIIF_CONTEXT: &str = "http://iiif.io/api/presentation/4/context.json";

/// Version of the page's data.
const SCHEMA: u32 = 1;

/// The page's data.
#[derive(Serialize)]
struct Data<'a> {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    #[serde(flatten)]
    gallery: &'a Gallery,
}

/// The content of a collection page.
///
/// ```
/// use taotie_report::collection_page::{Entry, Gallery, html};
///
/// let jue = Entry { id: "bronzes/jue.ply".into(), state: "done".into(), mean_angle: Some(1.8), ..Entry::default() };
/// let gallery = Gallery { title: "Bronzes".into(), assets: vec![jue] };
/// assert!(html(&gallery).contains("bronzes/jue.ply"));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Gallery {
    /// The heading.
    pub title: String,
    /// The assets.
    pub assets: Vec<Entry>,
}

/// An asset of a collection. Addresses are relative to the page; `None` means missing or not measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Entry {
    /// Its identifier in the collection.
    pub id: String,
    /// Its display name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// `done`, `required-not-met`, `refused`, `failed` or `waiting`.
    pub state: String,
    /// The reason why it was not baked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Descriptions of the requirements that are not met.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unmet: Vec<String>,
    /// Problems that were corrected.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Its picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thumbnail: Option<String>,
    /// Its turntable animation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turntable: Option<String>,
    /// Its viewer page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viewer: Option<String>,
    /// The report page of its proof or estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<String>,
    /// Its model file; the relief of photographs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// The number of photographs; `None` for a scan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub photographs: Option<usize>,
    /// Median uncertainty of normals from photographs, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma: Option<f64>,
    /// Its 95th percentile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p95_sigma: Option<f64>,
    /// The number of triangles of the scan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles_in: Option<usize>,
    /// The number of triangles of the finest level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<usize>,
    /// The size of the scan, or of the photographs, bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes_in: Option<u64>,
    /// The size of the asset, or of all files made from photographs, bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes_out: Option<u64>,
    /// Mean normal error, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_angle: Option<f64>,
    /// Its 95th percentile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p95_angle: Option<f64>,
    /// Its maximum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_angle: Option<f64>,
    /// Mean colour error, CIEDE2000.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_color: Option<f64>,
    /// Largest shape error as a fraction of the diagonal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hausdorff: Option<f64>,
    /// The share of texels with a missed ray.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missed: Option<f64>,
    /// The processing time, seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// The peak memory use, bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_bytes: Option<u64>,
}

/// Writes the page as one HTML document. It loads the pictures next to it and fetches nothing else.
pub fn html(gallery: &Gallery) -> String {
    let [style, script] = [STYLE.concat(), SCRIPT.concat()].map(|text| text.replace('\r', ""));
    let document = Document {
        title: &gallery.title,
        policy: policy(&style, &script),
        style: &style,
        main: &report(),
        data: &json_element(&json(gallery)),
        scripts: &[&script],
    };
    document.html()
}

/// Writes the page's data as JSON.
pub fn json(gallery: &Gallery) -> String {
    let data = Data { schema: SCHEMA, version: env!("CARGO_PKG_VERSION"), gallery };
    serde_json::to_string(&data).expect("all keys are text")
}

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
        "@context": IIIF_CONTEXT,
        "id": format!("{base}iiif.json"),
        "type": "Collection",
        "label": label(&gallery.title),
        "items": items.collect::<Vec<_>>(),
    });
    format!("{collection:#}")
}

/// Allows only this style sheet, this script, and pictures within the page or next to it; no connections.
fn policy(style: &str, script: &str) -> String {
    let [style, script] = [style, script].map(sha256);
    format!(
        "default-src 'none'; img-src 'self' file: data:; style-src 'sha256-{style}'; script-src 'sha256-{script}'; \
         base-uri 'none'; form-action 'none'"
    )
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

#[cfg(test)]
mod tests {
    use super::*;

    const NASTY: &str = "</script><img src=x onerror=alert(1)><!--{policy}&amp;";

    #[test]
    fn no_text_breaks_out_of_its_place() {
        let asset = Entry { id: NASTY.into(), error: Some(NASTY.into()), ..Entry::default() };
        let document = html(&Gallery { title: NASTY.into(), assets: vec![asset] });
        assert_eq!((document.matches("<script").count(), document.matches("</script>").count()), (2, 2));
        assert!(!document.contains("<img") && !document.contains("<!--"));
        let (_, rest) = document.split_once("id=\"data\">").unwrap();
        let read: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
        assert_eq!(read["assets"][0]["error"], NASTY);
    }

    #[test]
    fn style_and_script_name_no_other_place() {
        let own = [STYLE.concat(), SCRIPT.concat().replace("http://www.w3.org/2000/svg", "")].concat();
        for word in
            ["://", "url(", "@import", "fetch(", "XMLHttp", "eval(", "innerHTML", "insertAdjacent", "</"]
        {
            assert!(!own.contains(word), "{word}");
        }
    }
}
