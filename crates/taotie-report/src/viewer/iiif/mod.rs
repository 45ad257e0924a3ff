//! IIIF manifests of a model's views: the cameras, lights and comments of a scene.

mod canvas;
mod outline;
mod scene;
mod view;

pub(super) use outline::Outline;

use super::PageFile;
use serde_json::Value;

/// Returns the manifests of a page published at `address`: `manifest.json` for version 4 of the Presentation API, the
/// first with scenes, cameras and lights, and `manifest-3.json` for version 3.
pub(super) fn manifests(outline: &Outline, address: &str) -> [PageFile; 2] {
    let base = format!("{}/", address.trim_end_matches('/'));
    [
        file("manifest.json", &scene::manifest(outline, &base)),
        file("manifest-3.json", &canvas::manifest(outline, &base)),
    ]
}

fn file(name: &str, content: &Value) -> PageFile {
    PageFile { name: name.into(), bytes: format!("{content:#}\n").into_bytes() }
}
