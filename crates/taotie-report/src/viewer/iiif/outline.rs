//! What manifests tell of a page.

use crate::Fact;
use crate::viewer::Bookmark;
use crate::viewer::camera::Orbit;
use serde_json::{Value, json};

/// The content of a page that its manifests tell.
#[derive(Debug, Clone)]
pub(in crate::viewer) struct Outline {
    pub title: String,
    pub facts: Vec<Fact>,
    pub bookmarks: Vec<Bookmark>,
    pub camera: Option<Orbit>,
    /// Sixteen numbers a light.
    pub lights: Vec<[f32; 16]>,
    pub ambient: [f32; 3],
}

impl Outline {
    /// What the page says of the model, as pairs.
    pub fn metadata(&self) -> Vec<Value> {
        let pair = |fact: &Fact| json!({ "label": label(&fact.name), "value": label(&fact.value) });
        self.facts.iter().map(pair).collect()
    }
}

/// A text in no language.
pub fn label(text: &str) -> Value {
    json!({ "none": [text] })
}

/// A bookmark's title and text as one.
pub fn comment(bookmark: &Bookmark) -> String {
    [bookmark.title.as_str(), bookmark.text.as_str()].join("\n").trim().to_owned()
}
