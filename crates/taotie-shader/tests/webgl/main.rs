//! Whole shaders in GLSL ES 3.00 in a browser: they compile without a warning, and show what the renderer shows.
#![allow(clippy::print_stdout, reason = "tests say what they found and why they are skipped")]

#[path = "../../../taotie-cli/tests/browser/node.rs"]
mod node;
mod pictures;
mod studio;
#[path = "../pixel/variants.rs"]
mod variants;

use node::Node;
use serde_json::{Map, Value, json};
use std::path::Path;
use taotie_shader::{Interface, Language, pixel_shader};
use variants::{Case, all};

/// The offsets of the uniform blocks' fields, by their names.
fn offsets(interface: &Interface) -> Map<String, Value> {
    let blocks = [("frame", &interface.frame), ("material", &interface.material)];
    let fields = blocks.iter().flat_map(|(block, fields)| fields.iter().map(move |field| (block, field)));
    fields.map(|(block, field)| (format!("{block}.{}", field.name), json!(field.offset))).collect()
}

fn written(case: &Case) -> Value {
    let shader = pixel_shader(&case.variant(), Language::GlslEs);
    let shadow = "float visibility(int light, vec3 position, vec3 n) { return 0.5; }\n";
    let host = if case.options.shadows { shadow } else { "" };
    json!({
        "name": case.name,
        "vertex": shader.vertex_text.expect("GLSL ES has two shaders"),
        "fragment": shader.text + host,
        "offsets": offsets(&shader.interface),
    })
}

/// The assertions are in the script.
#[test]
fn chromium_compiles_every_shader() {
    let Some(node) = Node::find() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("webgl");
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    let mut cases = all();
    if let Some(case) = cases.get_mut(1) {
        case.options.shadows = true;
    }
    let shaders: Vec<Value> = cases.iter().map(written).collect();
    std::fs::write(folder.join("shaders.json"), Value::from(shaders).to_string()).expect("it can be written");
    node.run(&["shaders.mjs"], &folder);
}
