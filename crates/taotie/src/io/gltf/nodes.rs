//! The node hierarchy: world matrices, and the nodes that the scene shows.

use super::document::Document;
use super::levels::Levels;
use super::reason::no_such;
use crate::error::{Error, Result, Warnings};
use crate::math::{Mat4, Vec3};
use crate::scene::animation::{Node, Transform, world_matrices};
use gltf::json;

/// The hierarchy, resolved.
pub(super) struct Nodes {
    /// Every node of the file, without morph weights.
    pub nodes: Vec<Node>,
    /// World matrix of every node in the file.
    pub world: Vec<Mat4>,
    /// The nodes of the shown scene, parents before children.
    pub shown: Vec<usize>,
    /// The number of levels of detail, at least 1.
    pub levels: usize,
    /// The screen coverage at which this level is first shown; `None` for the finest.
    pub coverage: Option<f32>,
}

impl Nodes {
    /// Resolves the hierarchy of `document` at a level of detail; 0 is the finest.
    ///
    /// # Errors
    /// Fails if a node is its own ancestor, a referenced node does not exist, or a transform is not finite.
    pub fn resolve(document: &Document, level: usize, warnings: &mut Warnings) -> Result<Self> {
        if !document.reading.take(document.root.nodes.len() as u64 * NODE) {
            document.reading.check()?;
        }
        let mut parents = parents(document, warnings)?;
        let levels = Levels::read(document, level, warnings);
        levels.hang(&mut parents);
        let nodes = (0..parents.len())
            .map(|n| {
                let local = local_transform(document, n, warnings)?;
                Ok(Node { parent: parents[n], local, weights: Vec::new() })
            })
            .collect::<Result<Vec<_>>>()?;
        let world = world_matrices(&nodes).map_err(|error| match error {
            Error::Invalid { what, why } => document.error(what, why),
            other => other,
        })?;
        let shown = shown(document, &parents, &levels)?;
        Ok(Self { nodes, world, shown, levels: levels.count, coverage: levels.coverage })
    }
}

/// Bytes per node in addition to those for parsing its text: transforms, and what shows its mesh.
const NODE: u64 = 512;

type Parents = Vec<Option<usize>>;

fn at(node: usize) -> String {
    format!("node {node}")
}

fn children(document: &Document, node: usize) -> impl Iterator<Item = usize> {
    document.root.nodes[node].children.iter().flatten().map(|c| c.value())
}

/// Returns the parent of each node; the first if there are several.
fn parents(document: &Document, warnings: &mut Warnings) -> Result<Parents> {
    let count = document.root.nodes.len();
    let mut parents = vec![None; count];
    for node in 0..count {
        for child in children(document, node) {
            match parents.get_mut(child) {
                None => return Err(document.error(at(node), no_such("child", child))),
                Some(parent @ None) => *parent = Some(node),
                Some(Some(_)) => warnings.note("nodes with two parents; using the first", 1),
            }
        }
    }
    Ok(parents)
}

fn local_transform(document: &Document, index: usize, warnings: &mut Warnings) -> Result<Transform> {
    let node = &document.root.nodes[index];
    let local = match &node.matrix {
        Some(m) => Transform::Matrix(from_columns(m, warnings)),
        None => from_parts(node, warnings),
    };
    let finite = local.matrix().is_finite();
    if finite { Ok(local) } else { Err(document.error(at(index), "the transform is not finite")) }
}

/// Converts a column-major matrix; projective parts are dropped.
pub(super) fn from_columns(m: &[f32; 16], warnings: &mut Warnings) -> Mat4 {
    let mut columns = [[0.0; 4]; 4];
    for (i, v) in m.iter().enumerate() {
        columns[i / 4][i % 4] = f64::from(*v);
    }
    let last_row = columns.map(|c| c[3]);
    if last_row != [0.0, 0.0, 0.0, 1.0] {
        warnings.note("matrices with a last row other than 0 0 0 1; row ignored", 1);
        columns.iter_mut().zip([0.0, 0.0, 0.0, 1.0]).for_each(|(c, v)| c[3] = v);
    }
    Mat4 { columns }
}

fn from_parts(node: &json::Node, warnings: &mut Warnings) -> Transform {
    let vector = |v: [f32; 3]| Vec3::from_array(v).to_f64();
    let translation = vector(node.translation.unwrap_or_default());
    let scale = vector(node.scale.unwrap_or([1.0; 3]));
    let rotation = node.rotation.unwrap_or_default().0.map(f64::from);
    let zero = rotation == [0.0; 4];
    warnings.note("zero-length rotations; treated as identity", usize::from(zero));
    Transform::parts(translation, rotation, scale)
}

/// Returns the nodes of the default scene, else of the first, else all trees, replaced according to the level of
/// detail.
fn shown(document: &Document, parents: &Parents, levels: &Levels) -> Result<Vec<usize>> {
    let root = &document.root;
    let scene = root.scene.map_or(0, |s| s.value());
    let mut waiting: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
        None if root.scene.is_some() => return Err(document.error("scene", no_such("scene", scene))),
        None => (0..parents.len()).filter(|n| parents[*n].is_none()).collect(),
    };
    if let Some(node) = waiting.iter().find(|n| **n >= parents.len()) {
        return Err(document.error(format!("scene {scene}"), no_such("node", *node)));
    }
    waiting.reverse();
    let mut seen = vec![false; parents.len()];
    let mut shown = Vec::new();
    while let Some(node) = waiting.pop() {
        let node = levels.stand_in(node);
        if std::mem::replace(&mut seen[node], true) {
            continue;
        }
        shown.push(node);
        let below: Vec<usize> = children(document, node).filter(|c| parents[*c] == Some(node)).collect();
        waiting.extend(below.into_iter().rev());
    }
    Ok(shown)
}
