//! `xtask schemas`: the JSON Schema of each document that the command prints or writes, in docs/schemas.
//!
//! A schema is derived from the source of the types that are serialised: their fields, Serde's attributes and their
//! documentation. The types are not compiled for it, so they need no further derives, features or dependencies.
//! Documentation is part of the declaration:
//!
//! - `[0, 1]` in the documentation of a floating-point number is its range;
//! - `` `up` or `down` `` at the start of the documentation of a text, or after a colon, are its values;
//! - "the name of its `[Shading]`" gives it the values of that enum;
//! - a number that may be infinite or NaN is null then.
//!
//! The tests of the command validate every document that they print.

mod attributes;
mod document;
mod layers;
mod sources;

use crate::generated::{Content, Generated};
use anyhow::{Context, Result};
use document::{Document, Exception, Exceptions};
use serde_json::{Map, Value, json};
use sources::Sources;
use std::collections::BTreeMap;
use std::path::Path;

/// A document that the command prints or writes.
struct Printed {
    /// The name of its schema's file.
    name: &'static str,
    /// Where it comes from.
    title: &'static str,
    /// The type that is serialised.
    root: &'static str,
}

const fn printed(name: &'static str, title: &'static str, root: &'static str) -> Printed {
    Printed { name, title, root }
}

/// All documents.
const DOCUMENTS: [Printed; 21] = [
    printed("bake", "taotie bake --json, and OUT.report.json", "taotie_cli::bake::Printed"),
    printed("batch", "taotie batch --json", "taotie_cli::batch::Report"),
    printed("batch-check", "taotie batch --check --json", "taotie_cli::batch::AuditReport"),
    printed("batch-collection", "collection.json of taotie batch", "taotie_report::collection_page::Data"),
    printed("batch-manifest", "a line of manifest.jsonl of taotie batch", "taotie_batch::record::Record"),
    printed(
        "compare",
        "taotie compare --json, and report.json",
        "taotie_report::comparison::document::Document",
    ),
    printed(
        "compare-paper",
        "taotie compare --paper --json, and paper.json",
        "taotie_study::paper::page::Document",
    ),
    printed("demo", "taotie demo --json", "taotie_cli::demo::Demo"),
    printed("diff", "taotie diff --json", "taotie_cli::diff::Report"),
    printed("inspect", "taotie inspect --json", "taotie_cli::inspect::report::Report"),
    printed("inspect-audit", "taotie inspect --audit --json", "taotie_cli::inspect::AuditReport"),
    printed("materials", "taotie materials --json", "taotie_cli::materials::List"),
    printed("normals", "taotie normals --json", "taotie_cli::normals::Report"),
    printed(
        "photometric",
        "taotie photometric --json, and report.json",
        "taotie_cli::photometric::report::Report",
    ),
    printed(
        "photometric-materials",
        "taotie photometric --model --json, and report.json",
        "taotie_cli::photometric::materials::MaterialsReport",
    ),
    printed("progress", "a line on stderr with --progress", "taotie_cli::console::ProgressLine"),
    printed("render", "taotie render --json", "taotie_cli::render::Printed"),
    printed("shader", "taotie shader --json", "taotie_cli::shader::Report"),
    printed("shader-interface", "NAME.json of taotie shader", "taotie_cli::shader::description::Description"),
    printed("verify", "taotie verify --json, and OUT.json", "taotie::asset::proof::report::Report"),
    printed("view", "taotie view --json", "taotie_cli::view::Report"),
];

/// Returns the files of docs/schemas.
///
/// # Errors
/// If a source cannot be read, or a type cannot be described.
pub fn generated(root: &Path) -> Result<Generated> {
    let sources = Sources::read(&root.join("crates"))?;
    let folder = root.join("docs/schemas");
    let mut files = BTreeMap::new();
    for document in &DOCUMENTS {
        let schema = document.schema(&sources).with_context(|| format!("the schema of {}", document.name))?;
        let text = serde_json::to_string_pretty(&schema)? + "\n";
        files.insert(folder.join(format!("{}.json", document.name)), Content::Text(text));
    }
    Ok(Generated { files, folder: Some(folder) })
}

impl Printed {
    fn schema(&self, sources: &Sources) -> Result<Value> {
        let exceptions = exceptions();
        let document = Document::new(sources, &exceptions);
        let (mut schema, definitions) = document.finish(sources.named(self.root)?)?;
        let version = schema["properties"]["schema"]["const"].clone();
        schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
        schema["$id"] = match version {
            Value::Null => format!("urn:taotie:{}", self.name),
            version => format!("urn:taotie:{}:{version}", self.name),
        }
        .into();
        schema["title"] = self.title.into();
        if !definitions.is_empty() {
            schema["$defs"] = definitions.into_iter().collect::<Map<_, _>>().into();
        }
        Ok(schema)
    }
}

/// Returns the declarations that types lack: values with separate code for writing, and untyped values.
fn exceptions() -> Exceptions {
    let number = json!({ "type": "number" });
    let vector = json!({ "type": "array", "items": number, "minItems": 3, "maxItems": 3 });
    let level = json!({ "anyOf": [{ "type": "integer", "minimum": 0 }, { "type": "string", "pattern": "^[0-9]+px$" }] });
    Exceptions::from([
        ("Vec3", Exception::Schema(vector)),
        ("Lod", Exception::Schema(level)),
        ("MaterialReport.layers", Exception::Schema(layers::properties())),
        ("Report.parameters", Exception::SameOrNull("taotie::asset::write::provenance::Fields")),
        ("Document.parameters", Exception::Same("taotie_report::comparison::document::DocumentParameters")),
        ("DocumentParameters.material", Exception::SameOrNull("taotie_cli::studio::surface::MaterialReport")),
        (
            "DocumentParameters.environment",
            Exception::SameOrNull("taotie_cli::studio::light::EnvironmentReport"),
        ),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::root;

    #[test]
    fn the_committed_schemas_are_up_to_date() {
        let schemas = generated(&root()).expect("every type can be described");
        let stale = schemas.stale().expect("the schemas are readable");
        assert!(stale.is_empty(), "run `make schemas`: {stale:?}");
    }
}
