//! A model's views as IIIF viewers read them: cameras, lights and comments of a scene.

mod canvas;
mod outline;
mod scene;
mod view;

pub(super) use outline::Outline;

use super::PageFile;
use serde_json::Value;

/// Returns the manifests of a page that is published at `address`: `manifest.json` by version 4 of the Presentation API,
/// the first that knows scenes, cameras and lights, and `manifest-3.json` by version 3.
pub(super) fn manifests(told: &Outline, address: &str) -> [PageFile; 2] {
    let base = format!("{}/", address.trim_end_matches('/'));
    [
        file("manifest.json", &scene::manifest(told, &base)),
        file("manifest-3.json", &canvas::manifest(told, &base)),
    ]
}

fn file(name: &str, content: &Value) -> PageFile {
    PageFile { name: name.into(), bytes: format!("{content:#}\n").into_bytes() }
}
