//! Levels of detail (MSFT_lod): the nodes that replace others at coarser levels.

use super::document::Document;
use crate::error::Warnings;
use gltf::json::Value;

const NAME: &str = "MSFT_lod";

/// The nodes shown at one level of detail.
pub(super) struct Levels {
    /// The number of levels of the file, at least 1.
    pub count: usize,
    /// The largest screen coverage of the object at which this level is shown; `None` for the finest.
    pub coverage: Option<f32>,
    /// The node shown instead of each node.
    stand_ins: Vec<usize>,
}

impl Levels {
    /// Selects a level; 0 is the finest. A node with fewer levels shows its coarsest; invalid node indices are
    /// skipped with a warning.
    pub fn read(document: &Document, level: usize, warnings: &mut Warnings) -> Self {
        let lists: Vec<Vec<usize>> =
            (0..document.root.nodes.len()).map(|node| coarser(document, node, warnings)).collect();
        let count = 1 + lists.iter().map(Vec::len).max().unwrap_or(0);
        let stand_in = |(node, coarser): (usize, &Vec<usize>)| match level.min(coarser.len()) {
            0 => node,
            level => coarser[level - 1],
        };
        let stand_ins = lists.iter().enumerate().map(stand_in).collect();
        let above = level.checked_sub(1);
        let of_node = |node: usize| document.coverages.get(&node)?.get(above?).copied();
        let has_levels = (0..lists.len()).filter(|node| !lists[*node].is_empty());
        Self { count, coverage: has_levels.filter_map(of_node).reduce(f32::max), stand_ins }
    }

    /// Returns the node shown instead of `node`.
    pub fn stand_in(&self, node: usize) -> usize {
        self.stand_ins[node]
    }

    /// Gives each replacement the parent of the node that it replaces.
    pub fn hang(&self, parents: &mut [Option<usize>]) {
        for (node, stand_in) in self.stand_ins.iter().enumerate() {
            if *stand_in != node {
                parents[*stand_in] = parents[node];
            }
        }
    }
}

/// Returns the coarser replacements of a node that exist, the finest first.
fn coarser(document: &Document, node: usize, warnings: &mut Warnings) -> Vec<usize> {
    let nodes = &document.root.nodes;
    let extension = nodes[node].extensions.as_ref().and_then(|extensions| extensions.others.get(NAME));
    let ids = extension.and_then(|extension| extension.get("ids")).and_then(Value::as_array);
    let ids = ids.map_or(&[][..], Vec::as_slice);
    let named = |id: &Value| Some(id.as_u64()? as usize).filter(|id| *id < nodes.len());
    let found: Vec<usize> = ids.iter().filter_map(named).collect();
    warnings.note("skipped levels of detail that are not nodes", ids.len() - found.len());
    found
}
