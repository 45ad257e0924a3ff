//! The manifest by version 3 of the Presentation API, which knows models but no scenes: a canvas that stands for the model.

use super::outline::{Outline, comment, label};
use crate::viewer::Bookmark;
use serde_json::{Value, json};

const CONTEXT: &str = "http://iiif.io/api/presentation/3/context.json";

/// Units along the canvas's sides, which have no meaning here.
const SIDE: u32 = 1000;

pub(super) fn manifest(told: &Outline, base: &str) -> Value {
    let canvas = format!("{base}canvas");
    let page = json!({
        "id": format!("{base}index.html"),
        "type": "Text",
        "label": label(&told.title),
        "format": "text/html",
    });
    let mut shown = json!({
        "id": canvas,
        "type": "Canvas",
        "label": label(&told.title),
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
    if !told.bookmarks.is_empty() {
        let comments = told.bookmarks.iter().enumerate();
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
        "label": label(&told.title),
        "rendering": [page],
        "items": [shown],
    });
    if !told.facts.is_empty() {
        all["metadata"] = told.metadata().into();
    }
    all
}

/// A comment with the link of its view.
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
