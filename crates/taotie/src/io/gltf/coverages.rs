//! The screen coverages at which levels of detail are shown, from the nodes' application data (MSFT_screencoverage).

use gltf::json::Value;
use std::collections::BTreeMap;

/// The screen coverages of the levels of nodes, by node index.
pub(super) type Coverages = BTreeMap<usize, Vec<f32>>;

/// Returns the coverages in nodes' application data: the minimum screen coverage at which each of their levels is
/// shown.
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
