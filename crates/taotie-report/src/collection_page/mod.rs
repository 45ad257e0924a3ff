//! A collection as one page: every asset with its picture and its figures, the worst first.
//!
//! The page opens from disk, at ten thousand assets too. It shows what its own data say, and pictures that lie beside it;
//! it fetches nothing else.

mod iiif;

use crate::document::{Document, json_element, report, sha256};
use serde::Serialize;

pub use iiif::iiif;

const STYLE: [&str; 2] = [include_str!("../page.css"), include_str!("collection.css")];

/// The script in parts; the last one begins.
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

/// A collection as its page shows it.
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

/// An asset of a collection. Addresses are relative to the page; what is `None` is not there, or was not measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Entry {
    /// Its name in the collection.
    pub id: String,
    /// What people call it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// `done`, `required-not-met`, `refused`, `failed` or `waiting`.
    pub state: String,
    /// Why it was not made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// The requirements that are not met, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unmet: Vec<String>,
    /// What was wrong and put right.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// A picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thumbnail: Option<String>,
    /// A moving picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turntable: Option<String>,
    /// The page that shows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viewer: Option<String>,
    /// The page that tells of its proof.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<String>,
    /// Its file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Triangles of the scan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles_in: Option<usize>,
    /// Triangles of the finest level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<usize>,
    /// Bytes of the scan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes_in: Option<u64>,
    /// Bytes of the asset.
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
    /// Largest shape error as a part of the diagonal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hausdorff: Option<f64>,
    /// The part of the texels with a missed ray.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missed: Option<f64>,
    /// The time it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// The most memory it took.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_bytes: Option<u64>,
}

/// Writes the page as one HTML document. Pictures lie beside it, and nothing else is fetched.
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
    let all = serde_json::json!({
        "schema": 1,
        "version": env!("CARGO_PKG_VERSION"),
        "title": gallery.title,
        "assets": gallery.assets,
    });
    all.to_string()
}

/// Only this style sheet, this script, and pictures within the page or where it lies; no connection of any kind.
fn policy(style: &str, script: &str) -> String {
    let [style, script] = [style, script].map(sha256);
    format!(
        "default-src 'none'; img-src 'self' file: data:; style-src 'sha256-{style}'; script-src 'sha256-{script}'; \
         base-uri 'none'; form-action 'none'"
    )
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
        let read: serde_json::Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
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
