//! The content of a page that manifests describe.

use crate::Fact;
use crate::viewer::Bookmark;
use crate::viewer::camera::Orbit;
use serde_json::{Value, json};

/// The content of a page that its manifests describe.
#[derive(Debug, Clone)]
pub(in crate::viewer) struct Outline {
    pub title: String,
    pub facts: Vec<Fact>,
    pub bookmarks: Vec<Bookmark>,
    pub camera: Option<Orbit>,
    /// Sixteen numbers per light.
    pub lights: Vec<[f32; 16]>,
    pub ambient: [f32; 3],
}

impl Outline {
    /// Returns the facts about the model as label–value pairs.
    pub fn metadata(&self) -> Vec<Value> {
        let pair = |fact: &Fact| json!({ "label": label(&fact.name), "value": label(&fact.value) });
        self.facts.iter().map(pair).collect()
    }
}

/// Returns a language map for a text without a language.
pub fn label(text: &str) -> Value {
    json!({ "none": [text] })
}

/// Joins a bookmark's title and text.
pub fn comment(bookmark: &Bookmark) -> String {
    [bookmark.title.as_str(), bookmark.text.as_str()].join("\n").trim().to_owned()
}
