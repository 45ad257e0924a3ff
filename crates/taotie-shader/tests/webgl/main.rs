//! Whole shaders in a browser: they compile without a warning, and in GLSL ES 3.00 match the renderer's images.
#![allow(clippy::print_stdout, reason = "tests report what they found and why they are skipped")]

#[allow(dead_code)]
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

const VISIBILITY_GLSL: &str = "float visibility(int light, vec3 position, vec3 n) { return 0.5; }\n";
const VISIBILITY_WGSL: &str = "fn visibility(light: i32, position: vec3f, n: vec3f) -> f32 { return 0.5; }\n";

fn written(case: &Case) -> Value {
    let [es, wgsl] =
        [Language::GlslEs, Language::Wgsl].map(|language| pixel_shader(&case.variant(), language));
    let [host_es, host_wgsl] = match case.options.shadows {
        true => [VISIBILITY_GLSL, VISIBILITY_WGSL],
        false => ["", ""],
    };
    json!({
        "name": case.name,
        "vertex": es.vertex_text.expect("GLSL ES has two shaders"),
        "fragment": es.text + host_es,
        "wgsl": wgsl.text + host_wgsl,
        "offsets": offsets(&es.interface),
    })
}

#[test]
fn chromium_compiles_every_seventh_shader() {
    compile("webgl", 7);
}

#[test]
#[ignore = "takes a minute"]
fn chromium_compiles_every_shader() {
    compile("webgl-all", 1);
}

/// Compiles every n-th shader. The assertions are in the script.
fn compile(folder: &str, step: usize) {
    let Some(node) = Node::find() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    let mut cases: Vec<Case> = all().into_iter().step_by(step).collect();
    if let Some(case) = cases.get_mut(1) {
        case.options.shadows = true;
    }
    let shaders: Vec<Value> = cases.iter().map(written).collect();
    std::fs::write(folder.join("shaders.json"), Value::from(shaders).to_string()).expect("it is writable");
    node.run(&["shaders.mjs"], &folder);
}
