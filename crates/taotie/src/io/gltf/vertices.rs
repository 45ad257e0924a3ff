//! The vertex arrays of a primitive: read, deformed to the rest pose, repaired.

use super::accessor::Accessor;
use super::document::{Document, Reason, no_such};
use crate::error::Warnings;
use crate::math::{Mat4, Vec2, Vec3};
use crate::mesh::MeshData;
use crate::mesh::deform::{self, Binding};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// The most uv sets of a mesh that are read.
pub(super) const MAX_UV_SETS: u32 = 8;

/// The most sets of four joints of a vertex that are read.
const MAX_JOINT_SETS: u32 = 4;

/// How a primitive is moved to its rest pose.
#[derive(Default)]
pub(super) struct Pose {
    /// Weights of the morph targets; missing ones are zero.
    pub weights: Vec<f32>,
    /// World from bind-time object space for each joint of the skin.
    pub joints: Option<Vec<Mat4>>,
}

/// Reads the attributes of one primitive, for the vertices `used` only.
pub(super) struct Vertices<'a> {
    document: &'a Document,
    primitive: &'a Primitive,
    /// How many vertices the file has for the primitive.
    pub count: usize,
    positions: Accessor<'a>,
}

impl<'a> Vertices<'a> {
    /// Opens POSITION; `None` where the primitive has none.
    pub fn open(document: &'a Document, primitive: &'a Primitive) -> Reason<Option<Self>> {
        let Some(index) = attribute(primitive, Semantic::Positions) else { return Ok(None) };
        let positions = Accessor::open(document, index).map_err(|why| format!("POSITION: {why}"))?;
        if positions.width != 3 {
            return Err("POSITION: it must have 3 components".into());
        }
        if positions.count > u32::MAX as usize {
            return Err(format!("POSITION: {} vertices; at most 2^32 - 1", positions.count));
        }
        if positions.is_implicit() && primitive_is_compressed(primitive) {
            return Err("POSITION: it is compressed by an extension that is not supported".into());
        }
        Ok(Some(Self { document, primitive, count: positions.count, positions }))
    }

    /// Reads every attribute of the vertices `used` and applies `pose`. Attributes other than POSITION that cannot
    /// be read are left out, with a warning that starts with `place`.
    pub fn read(&self, used: &[u32], pose: &Pose, place: &str, warnings: &mut Warnings) -> Reason<MeshData> {
        let mut optional = |semantic: Semantic| {
            let name = semantic.to_string();
            let index = attribute(self.primitive, semantic)?;
            self.open_optional(index)
                .map_err(|w| warnings.note(format!("{place}: {name} left out: {w}"), 1))
                .ok()
        };
        let mut data = MeshData {
            positions: used.iter().map(|i| vec3(&self.positions, *i)).collect(),
            ..MeshData::default()
        };
        if let Some(normals) = optional(Semantic::Normals) {
            data.normals = used.iter().map(|i| vec3(&normals, *i)).collect();
            if let Some(tangents) = optional(Semantic::Tangents) {
                data.tangents = used.iter().map(|i| tangents.floats(*i as usize)).collect();
            }
        }
        let sets = (0..MAX_UV_SETS).map(|set| optional(Semantic::TexCoords(set))).collect::<Vec<_>>();
        data.uvs = read_uvs(&sets, used);
        if let Some(colors) = optional(Semantic::Colors(0)) {
            data.colors = used.iter().map(|i| color(&colors, *i)).collect();
        }
        self.morph(&mut data, used, &pose.weights)?;
        if let Some(joints) = &pose.joints {
            self.skin(&mut data, used, joints, warnings)?;
        }
        if let Some(i) = data.positions.iter().position(|p| !p.is_finite()) {
            return Err(format!("POSITION: vertex {} is infinite or NaN", used[i]));
        }
        Ok(data)
    }

    fn open_optional(&self, index: usize) -> Reason<Accessor<'a>> {
        let accessor = Accessor::open(self.document, index)?;
        if accessor.count == self.count {
            Ok(accessor)
        } else {
            Err(format!("{} elements for {} positions", accessor.count, self.count))
        }
    }

    fn morph(&self, data: &mut MeshData, used: &[u32], weights: &[f32]) -> Reason<()> {
        let targets = self.primitive.targets.iter().flatten();
        for (t, (target, weight)) in targets.zip(weights).enumerate().filter(|(_, (_, w))| **w != 0.0) {
            let deltas = |index: Option<usize>| -> Reason<Vec<Vec3>> {
                let Some(index) = index else { return Ok(Vec::new()) };
                let accessor = self.open_optional(index).map_err(|why| format!("morph target {t}: {why}"))?;
                Ok(used.iter().map(|i| vec3(&accessor, *i)).collect())
            };
            let value = |index: &Option<gltf::json::Index<_>>| index.map(|i| i.value());
            deform::morph(&mut data.positions, &deltas(value(&target.positions))?, *weight);
            deform::morph(&mut data.normals, &deltas(value(&target.normals))?, *weight);
            let tangents = deltas(value(&target.tangents))?;
            for (tangent, delta) in data.tangents.iter_mut().zip(&tangents) {
                let [x, y, z, handedness] = *tangent;
                let moved = Vec3::new(x, y, z) + *delta * *weight;
                *tangent = [moved.x, moved.y, moved.z, handedness];
            }
        }
        Ok(())
    }

    fn skin(
        &self,
        data: &mut MeshData,
        used: &[u32],
        joints: &[Mat4],
        warnings: &mut Warnings,
    ) -> Reason<()> {
        let mut binding = self.binding(used)?;
        let unbound = normalize_weights(&mut binding);
        warnings.note("vertices without joint weights; they follow their first joint", unbound);
        deform::skin(data, &binding, joints).map_err(|e| format!("JOINTS_0: {e}"))
    }

    fn binding(&self, used: &[u32]) -> Reason<Binding> {
        let mut sets = Vec::new();
        for set in 0..MAX_JOINT_SETS {
            let joints = attribute(self.primitive, Semantic::Joints(set));
            let weights = attribute(self.primitive, Semantic::Weights(set));
            let (Some(joints), Some(weights)) = (joints, weights) else { break };
            let open = |i| self.open_optional(i).map_err(|why| format!("joints and weights {set}: {why}"));
            sets.push((open(joints)?, open(weights)?));
        }
        if sets.is_empty() {
            return Err("its node has a skin, but there are no JOINTS_0 and WEIGHTS_0".into());
        }
        let mut binding = Binding { per_vertex: 4 * sets.len(), ..Binding::default() };
        for i in used.iter().map(|i| *i as usize) {
            for (joints, weights) in &sets {
                binding.joints.extend(joints.unsigned::<4>(i));
                binding.weights.extend(weights.floats::<4>(i));
            }
        }
        Ok(binding)
    }
}

/// The accessor index of an attribute.
fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|i| i.value())
}

fn primitive_is_compressed(primitive: &Primitive) -> bool {
    primitive.extensions.as_ref().is_some_and(|e| e.others.keys().any(|k| k.contains("compression")))
}

fn vec3(accessor: &Accessor, i: u32) -> Vec3 {
    Vec3::from_array(accessor.floats(i as usize))
}

fn color(accessor: &Accessor, i: u32) -> [f32; 4] {
    let [r, g, b, a] = accessor.floats(i as usize);
    [r, g, b, if accessor.width < 4 { 1.0 } else { a }]
}

/// The uv sets up to the last that exists; one that is missing between others is zero.
fn read_uvs(sets: &[Option<Accessor>], used: &[u32]) -> Vec<Vec<Vec2>> {
    let count = sets.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let uv = |accessor: &Accessor, i: u32| {
        let [u, v] = accessor.floats(i as usize);
        Vec2::new(u, v)
    };
    let read = |set: &Option<Accessor>| match set {
        Some(accessor) => used.iter().map(|i| uv(accessor, *i)).collect(),
        None => vec![Vec2::default(); used.len()],
    };
    sets[..count].iter().map(read).collect()
}

/// Makes each vertex's weights sum to one and returns how many vertices had none; those follow their first joint.
/// Joints of weight zero are set to zero, since files leave any number there.
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

/// The inverse bind matrices of skin `index` times the world matrices of its joints.
pub(super) fn joint_matrices(
    document: &Document,
    index: usize,
    world: &[Mat4],
    warnings: &mut Warnings,
) -> Reason<Vec<Mat4>> {
    let skin = document.root.skins.get(index).ok_or_else(|| no_such("skin", index))?;
    let within = |why: String| format!("skin {index}: {why}");
    let binds = match skin.inverse_bind_matrices {
        Some(accessor) => Some(Accessor::open(document, accessor.value()).map_err(within)?),
        None => None,
    };
    if let Some(binds) = &binds
        && (binds.width != 16 || binds.count < skin.joints.len())
    {
        return Err(within("it needs one inverse bind matrix of 4×4 a joint".into()));
    }
    let mut matrices = Vec::with_capacity(skin.joints.len());
    for (j, joint) in skin.joints.iter().enumerate() {
        let node = joint.value();
        let world = world.get(node).ok_or_else(|| within(no_such("node", node)))?;
        let bind =
            binds.as_ref().map_or(Mat4::IDENTITY, |b| super::nodes::from_columns(&b.floats(j), warnings));
        matrices.push(*world * bind);
    }
    Ok(matrices)
}
