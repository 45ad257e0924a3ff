//! The screen coverages at which levels of detail are shown, which nodes say in application data (MSFT_screencoverage).

use gltf::json::Value;
use std::collections::BTreeMap;

/// The parts of the screen for the levels of nodes, by the numbers of these.
pub(super) type Coverages = BTreeMap<usize, Vec<f32>>;

/// Returns what nodes say in application data: the least part of the screen that is covered while each of their levels is shown.
pub(super) fn of(json: &Value) -> Coverages {
    let of_node = |node: &Value| -> Option<Vec<f32>> {
        let parts = node.pointer("/extras/MSFT_screencoverage")?.as_array()?;
        let part =
            |part: &Value| part.as_f64().filter(|part| (0.0..=1.0).contains(part)).map(|part| part as f32);
        parts.iter().map(part).collect()
    };
    let nodes = json.get("nodes").and_then(Value::as_array).into_iter().flatten().enumerate();
    nodes.filter_map(|(number, node)| Some((number, of_node(node)?))).collect()
}
