//! A scene being written: its document, and the warnings about content that glTF lacks.

use super::super::GltfFormat;
use super::super::draft::GltfDraft;
use super::super::number::short;
use super::uses::Textures;
use crate::error::{Error, Result, Warnings};
use crate::math::Mat4;
use crate::scene::Scene;
use serde_json::{Value, json};

/// A scene being written.
pub(super) struct Writer<'a> {
    pub scene: &'a Scene,
    pub format: GltfFormat,
    pub draft: GltfDraft,
    pub textures: Textures,
    pub warnings: Warnings,
    pub nodes: Vec<Value>,
    /// The nodes listed by the scene.
    pub shown: Vec<usize>,
}

impl<'a> Writer<'a> {
    pub fn new(scene: &'a Scene, format: GltfFormat) -> Self {
        let generator = concat!("taotie ", env!("CARGO_PKG_VERSION"));
        let json = json!({ "asset": { "version": "2.0", "generator": generator }, "scene": 0 });
        Self {
            scene,
            format,
            draft: GltfDraft::begun(json, format.codecs),
            textures: Textures::default(),
            warnings: Warnings::default(),
            nodes: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Notes that `count` parts differ from the scene in some way.
    pub fn note(&mut self, what: &str, count: usize) {
        self.warnings.note(what, count);
    }

    /// Adds a node to the scene.
    pub fn show(&mut self, node: Value) {
        self.shown.push(self.nodes.len());
        self.nodes.push(node);
    }

    pub fn finish(mut self, materials: Vec<Value>) -> (GltfDraft, Warnings) {
        self.draft.json["scenes"] = json!([{ "nodes": self.shown }]);
        self.draft.json["nodes"] = self.nodes.into();
        if !materials.is_empty() {
            self.draft.json["materials"] = materials.into();
        }
        (self.draft, self.warnings)
    }
}

/// Returns a node with a transform; the identity has no matrix.
///
/// # Errors
/// [`Error::Invalid`] if the matrix does not fit 32-bit floats.
pub(super) fn placed(mut node: Value, world: &Mat4) -> Result<Value> {
    let rounded = world.columns.as_flattened().iter().map(|v| *v as f32);
    let rounded: Vec<f32> = rounded.collect();
    if !rounded.iter().all(|v| v.is_finite()) {
        return Err(Error::invalid("transform in the scene to write", "it does not fit 32-bit floats"));
    }
    if *world != Mat4::IDENTITY {
        node["matrix"] = rounded.into_iter().map(short).collect::<Vec<_>>().into();
    }
    Ok(node)
}
