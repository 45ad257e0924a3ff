//! Documents that the command prints or writes, checked against the schemas in docs/schemas.

use jsonschema::Validator;
use serde_json::Value;
use std::path::Path;

/// Fails unless the document that the command printed with these arguments is as its schema states.
pub fn check_printed<'a>(arguments: impl IntoIterator<Item = &'a str>, document: &Value) {
    let arguments: Vec<&str> = arguments.into_iter().collect();
    let has = |option: &str| arguments.contains(&option);
    let name = match arguments[0] {
        "batch" if has("--check") => "batch-check",
        "compare" if has("--paper") => "compare-paper",
        "inspect" if has("--audit") => "inspect-audit",
        command => command,
    };
    check(name, document);
}

/// Fails unless a document is as the schema with this name states.
pub fn check(name: &str, document: &Value) {
    let faults = faults(name, document);
    let all = faults.join("\n");
    assert!(
        faults.is_empty(),
        "not as docs/schemas/{name}.json states; after a change run `make schemas`:\n{all}"
    );
}

/// Returns where a document differs from the schema with this name, and how.
pub fn faults(name: &str, document: &Value) -> Vec<String> {
    let validator = validator(name);
    validator.iter_errors(document).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// Returns the number of the schema with this name.
pub fn number(name: &str) -> u64 {
    schema(name)["properties"]["schema"]["const"].as_u64().expect("the schema has a number")
}

/// Returns the schema with this name, to validate many documents.
pub fn validator(name: &str) -> Validator {
    jsonschema::draft202012::new(&schema(name)).expect("the schema is valid")
}

fn schema(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../docs/schemas/{name}.json"));
    let text = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&text).expect("the schema is JSON")
}
