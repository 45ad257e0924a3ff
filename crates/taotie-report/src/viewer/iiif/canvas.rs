//! The manifest for version 3 of the Presentation API, which has models but no scenes: a canvas represents the model.

use super::outline::{Outline, comment, label};
use crate::viewer::Bookmark;
use serde_json::{Value, json};

const CONTEXT: &str = "http://iiif.io/api/presentation/3/context.json";

/// The sides of the canvas, whose units have no meaning here.
const SIDE: u32 = 1000;

pub(super) fn manifest(outline: &Outline, base: &str) -> Value {
    let canvas = format!("{base}canvas");
    let page = json!({
        "id": format!("{base}index.html"),
        "type": "Text",
        "label": label(&outline.title),
        "format": "text/html",
    });
    let mut shown = json!({
        "id": canvas,
        "type": "Canvas",
        "label": label(&outline.title),
        "width": SIDE,
        "height": SIDE,
        "items": [{
            "id": format!("{base}canvas/page"),
            "type": "AnnotationPage",
            "items": [{
                "id": format!("{base}canvas/model"),
                "type": "Annotation",
                "motivation": "painting",
                "body": { "id": format!("{base}asset.glb"), "type": "Model", "format": "model/gltf-binary" },
                "target": canvas,
            }],
        }],
    });
    if !outline.bookmarks.is_empty() {
        let comments = outline.bookmarks.iter().enumerate();
        shown["annotations"] = json!([{
            "id": format!("{base}canvas/comments"),
            "type": "AnnotationPage",
            "items": comments.map(|(i, bookmark)| commented(i + 1, bookmark, base)).collect::<Vec<_>>(),
        }]);
    }
    let mut all = json!({
        "@context": CONTEXT,
        "id": format!("{base}manifest-3.json"),
        "type": "Manifest",
        "label": label(&outline.title),
        "rendering": [page],
        "items": [shown],
    });
    if !outline.facts.is_empty() {
        all["metadata"] = outline.metadata().into();
    }
    all
}

/// Returns a comment with the link to its view.
fn commented(number: usize, bookmark: &Bookmark, base: &str) -> Value {
    let text = format!("{}\n{base}index.html#{}", comment(bookmark), bookmark.link);
    json!({
        "id": format!("{base}canvas/comments/{number}"),
        "type": "Annotation",
        "motivation": "commenting",
        "body": { "type": "TextualBody", "value": text, "format": "text/plain" },
        "target": format!("{base}canvas"),
    })
}
