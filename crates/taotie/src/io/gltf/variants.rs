//! KHR_materials_variants: the material of each primitive in each variant.

use super::document::Document;
use super::extensions::extension;
use super::reason::no_such;
use crate::error::Warnings;
use crate::io::variants::{Mapping, Variants};
use gltf::json::Value;
use gltf::json::mesh::Primitive;
use std::collections::BTreeMap;

const NAME: &str = "KHR_materials_variants";

/// Returns the names of the file's variants. A variant without a name is named by its number.
pub(super) fn names(document: &Document) -> Vec<String> {
    let extensions = document.root.extensions.as_ref();
    let variants = extensions.and_then(|e| e.others.get(NAME)).and_then(|json| json.get("variants"));
    let name = |(i, variant): (usize, &Value)| match variant.get("name").and_then(Value::as_str) {
        Some(name) => name.to_owned(),
        None => i.to_string(),
    };
    variants.and_then(Value::as_array).into_iter().flatten().enumerate().map(name).collect()
}

/// The index of a mesh in the file, and of a primitive in that mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct PrimitiveIndex {
    pub mesh: usize,
    pub primitive: usize,
}

/// Collects the variant mappings of primitives while meshes are built.
pub(super) struct Mappings {
    /// The mappings collected so far; `authored` is still empty.
    pub variants: Variants,
    materials: usize,
    known: BTreeMap<PrimitiveIndex, usize>,
}

impl Mappings {
    /// Makes an empty collection for the variants of `document`.
    pub fn new(document: &Document) -> Self {
        let variants = Variants { names: names(document), ..Variants::default() };
        Self { variants, materials: document.root.materials.len(), known: BTreeMap::new() }
    }

    /// Notes that the next mesh of the scene is the primitive `at` of the file. Mappings to anything that does not
    /// exist are skipped with a warning that starts with `place`.
    pub fn add(&mut self, at: PrimitiveIndex, primitive: &Primitive, place: &str, warnings: &mut Warnings) {
        let json = extension(primitive, NAME).filter(|_| !self.variants.names.is_empty());
        let mapping = json.map(|json| match self.known.get(&at) {
            Some(known) => *known,
            None => {
                let mapping =
                    self.read(json, |why| warnings.note(format!("{place}: variant mapping: {why}"), 1));
                self.variants.mappings.push(mapping);
                self.known.insert(at, self.variants.mappings.len() - 1);
                self.variants.mappings.len() - 1
            }
        });
        self.variants.mapping_of_mesh.push(mapping);
    }

    /// Reads the mapping; if a variant has several materials, the first is used.
    fn read(&self, json: &Value, mut note: impl FnMut(String)) -> Mapping {
        let mut materials = BTreeMap::new();
        let list =
            |json: &Value, key: &str| json.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
        for mapping in list(json, "mappings") {
            let Some(material) = index(mapping.get("material"), self.materials) else {
                note(no_such_value("material", mapping.get("material")));
                continue;
            };
            for variant in list(&mapping, "variants") {
                match index(Some(&variant), self.variants.names.len()) {
                    Some(variant) => drop(materials.entry(variant).or_insert(material)),
                    None => note(no_such_value("variant", Some(&variant))),
                }
            }
        }
        materials.into_iter().collect()
    }
}

fn index(value: Option<&Value>, count: usize) -> Option<usize> {
    let index = usize::try_from(value?.as_u64()?).ok()?;
    (index < count).then_some(index)
}

fn no_such_value(what: &str, value: Option<&Value>) -> String {
    match value.and_then(Value::as_u64) {
        Some(index) => no_such(what, index as usize),
        None => format!("missing {what}"),
    }
}
