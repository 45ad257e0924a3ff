//! The deformation of a primitive: its morph targets, its joint weights, and the skins.

use super::accessor::Accessor;
use super::document::Document;
use super::reason::{Reason, no_such};
use super::vertices::{Vertices, attribute, vec3};
use crate::error::Warnings;
use crate::math::{Mat4, Vec3};
use crate::mesh::deform::{Binding, MorphTarget};
use crate::scene::animation::Skin;
use gltf::json::Index;
use gltf::json::mesh::{MorphTarget as JsonTarget, Semantic};

/// Maximum number of sets of four joints read per vertex.
const MAX_JOINT_SETS: u32 = 4;

/// The choice of morph targets that are read.
pub(super) struct Wanted<'a> {
    /// The weights at rest; a target without one has weight 0.
    pub weights: &'a [f32],
    /// `true` if weights will change, so that all targets are needed, not only those with a weight.
    pub all: bool,
}

/// Returns the morph targets for the vertices `used`. One that cannot be read is skipped with a warning that starts
/// with `place`, unless it has a weight at rest. Targets that are not wanted are empty.
pub(super) fn targets(
    vertices: &Vertices,
    used: &[u32],
    wanted: &Wanted,
    note: &mut impl FnMut(String),
) -> Reason<Vec<MorphTarget>> {
    let mut targets = Vec::new();
    for (t, json) in vertices.primitive.targets.iter().flatten().enumerate() {
        let weighs = wanted.weights.get(t).is_some_and(|w| *w != 0.0);
        let target = match weighs || wanted.all {
            true => target(vertices, used, json).and_then(|t| if weighs { Ok(t) } else { finite(t) }),
            false => Ok(MorphTarget::default()),
        };
        match target.map_err(|why| format!("morph target {t}: {why}")) {
            Ok(target) => targets.push(target),
            Err(why) if weighs => return Err(why),
            Err(why) => {
                note(why);
                targets.push(MorphTarget::default());
            }
        }
    }
    Ok(targets)
}

fn finite(target: MorphTarget) -> Reason<MorphTarget> {
    let all = [&target.positions, &target.normals, &target.tangents];
    if all.into_iter().flatten().any(|delta| !delta.is_finite()) {
        return Err("infinite or NaN values".into());
    }
    Ok(target)
}

fn target(vertices: &Vertices, used: &[u32], json: &JsonTarget) -> Reason<MorphTarget> {
    let deltas = |index: Option<usize>| -> Reason<Vec<Vec3>> {
        let Some(index) = index else { return Ok(Vec::new()) };
        let accessor = vertices.open_optional(index)?;
        Ok(used.iter().map(|i| vec3(&accessor, *i)).collect())
    };
    Ok(MorphTarget {
        positions: deltas(json.positions.map(|i| i.value()))?,
        normals: deltas(json.normals.map(|i| i.value()))?,
        tangents: deltas(json.tangents.map(|i| i.value()))?,
    })
}

/// Returns the joint weights of the vertices `used`; the weights of each vertex sum to one.
pub(super) fn binding(vertices: &Vertices, used: &[u32], warnings: &mut Warnings) -> Reason<Binding> {
    let mut sets = Vec::new();
    for set in 0..MAX_JOINT_SETS {
        let joints = attribute(vertices.primitive, Semantic::Joints(set));
        let weights = attribute(vertices.primitive, Semantic::Weights(set));
        let (Some(joints), Some(weights)) = (joints, weights) else { break };
        let open = |i| vertices.open_optional(i).map_err(|why| format!("joints and weights {set}: {why}"));
        sets.push((open(joints)?, open(weights)?));
    }
    if sets.is_empty() {
        return Err("its node has a skin, but JOINTS_0 or WEIGHTS_0 is missing".into());
    }
    let mut binding = Binding { per_vertex: 4 * sets.len(), ..Binding::default() };
    for i in used.iter().map(|i| *i as usize) {
        for (joints, weights) in &sets {
            binding.joints.extend(joints.unsigned::<4>(i));
            binding.weights.extend(weights.floats::<4>(i));
        }
    }
    let unbound = normalize_weights(&mut binding);
    warnings.note("vertices without joint weights; bound to their first joint", unbound);
    Ok(binding)
}

/// Makes each vertex's weights sum to one and returns how many vertices had none; those are bound to their first
/// joint. Joints of weight zero are set to zero, since files may have any index there.
fn normalize_weights(binding: &mut Binding) -> usize {
    let mut unbound = 0;
    let weights = binding.weights.chunks_exact_mut(binding.per_vertex);
    for (weights, joints) in weights.zip(binding.joints.chunks_exact_mut(binding.per_vertex)) {
        weights.iter_mut().for_each(|w| *w = if w.is_finite() && *w > 0.0 { *w } else { 0.0 });
        let sum: f32 = weights.iter().sum();
        if sum > 0.0 {
            weights.iter_mut().for_each(|w| *w /= sum);
            joints.iter_mut().zip(weights).filter(|(_, w)| **w == 0.0).for_each(|(j, _)| *j = 0);
        } else {
            unbound += 1;
            weights[0] = 1.0;
        }
    }
    unbound
}

/// Reads skin `index`, checking that its joints are nodes of the file.
pub(super) fn skin(document: &Document, index: usize, warnings: &mut Warnings) -> Reason<Skin> {
    let skin = document.root.skins.get(index).ok_or_else(|| no_such("skin", index))?;
    let within = |why: String| format!("skin {index}: {why}");
    let joints: Vec<usize> = skin.joints.iter().map(Index::value).collect();
    if let Some(node) = joints.iter().find(|node| **node >= document.root.nodes.len()) {
        return Err(within(no_such("node", *node)));
    }
    let Some(binds) = skin.inverse_bind_matrices else {
        return Ok(Skin { inverse_bind_matrices: vec![Mat4::IDENTITY; joints.len()], joints });
    };
    let binds = Accessor::open(document, binds.value()).map_err(within)?;
    if binds.width != 16 || binds.count < joints.len() {
        return Err(within("expected one 4×4 inverse bind matrix per joint".into()));
    }
    let bind = |j: usize| super::nodes::from_columns(&binds.floats(j), warnings);
    let inverse_bind_matrices = (0..joints.len()).map(bind).collect();
    Ok(Skin { joints, inverse_bind_matrices })
}
