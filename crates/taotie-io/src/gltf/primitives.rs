//! A primitive of the file as a mesh in its rest pose, with the data that deforms it: morph targets and joint
//! weights.

use super::accessor::Accessor;
use super::document::Document;
use super::geometry::{Vertices, attribute, compact, read_indices, triangulate, vec3};
use crate::reading::Reason;
use gltf::json::mesh::{MorphTarget as JsonTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use taotie_engine::error::{Error, Warnings};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::deform::{Binding, Deformable, MorphTarget};
use taotie_engine::mesh::{Mesh, first, repair};

/// Maximum number of vertices and indices of all meshes together, per byte of the buffers. Sharing data between
/// primitives is common; a small file that requests gigabytes is not.
const MAX_ELEMENTS_PER_BYTE: usize = 8;

/// Constant added to that limit, so that tiny files are unrestricted.
const MAX_ELEMENTS_OF_SMALL: usize = 1 << 22;

/// Bytes per vertex, with every possible attribute, and per index, while a mesh is built.
const VERTEX: u64 = 80;
const INDEX: u64 = 12;
/// Bytes per corner with the normal of its facet: position, normal and uv.
const FLAT_CORNER: u64 = 12 + 12 + 8;

/// Returns the bytes needed for `vertices` and `indices` while a mesh is built.
pub(super) fn bytes_of(vertices: usize, indices: usize) -> u64 {
    vertices as u64 * VERTEX + indices as u64 * INDEX
}

/// Returns the maximum number of vertices and indices of all meshes of a file together.
pub(super) fn most_elements(document: &Document) -> usize {
    MAX_ELEMENTS_OF_SMALL + MAX_ELEMENTS_PER_BYTE * document.total_bytes()
}

/// The warning for primitives that are not drawn.
pub(super) const NOT_TRIANGLES: &str = "primitives with points or lines; only triangles are drawn";

/// The rest pose of a mesh: morph weights and skin.
#[derive(Default)]
pub(super) struct Pose {
    /// Weights of the morph targets; missing ones are zero.
    pub weights: Vec<f32>,
    /// The skin, as an index into [`super::meshes::Meshes::skins`], and its joint matrices.
    pub skin: Option<(usize, Vec<Mat4>)>,
}

/// A primitive as a mesh, and its source data if animations deform it.
pub(super) struct Built {
    /// The mesh.
    pub mesh: Mesh,
    /// The data by which animations deform it.
    pub shape: Option<Deformable>,
}

/// Reads primitives as long as their total size is plausible for the file.
pub(super) struct Primitives<'a> {
    document: &'a Document,
    /// Notes on invalid or missing parts that are not essential.
    pub warnings: &'a mut Warnings,
    /// `true` if anything in the file moves, so that the data that deforms meshes has to be kept.
    pub moves: bool,
    budget: usize,
}

impl<'a> Primitives<'a> {
    /// Reads from `document`.
    pub fn new(document: &'a Document, warnings: &'a mut Warnings) -> Self {
        let budget = most_elements(document);
        Self { document, warnings, moves: !document.animations.is_empty(), budget }
    }

    /// Returns the mesh of a primitive; `None` if it has nothing to draw.
    pub fn build(
        &mut self,
        primitive: &Primitive,
        pose: &Pose,
        place: &str,
    ) -> std::result::Result<Option<Built>, Stop> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err("unknown mode".to_owned().into());
        };
        let Some(vertices) = Vertices::open(self.document, primitive)? else {
            self.warnings.note("primitives without POSITION; nothing to draw", 1);
            return Ok(None);
        };
        let Some(triangles) = triangulate(mode, &self.indices(primitive, vertices.count)?) else {
            self.warnings.note(NOT_TRIANGLES, 1);
            return Ok(None);
        };
        self.warnings.note("surplus indices that do not form a triangle", triangles.surplus);
        let (used, triangles) = compact(triangles.list, vertices.count);
        if triangles.is_empty() {
            self.warnings.note("primitives without a triangle; nothing to draw", 1);
            return Ok(None);
        }
        let mut shape = self.shape(&vertices, &used, pose, place)?;
        shape.base.triangles = triangles;
        let deforms = shape.binding.is_some() || !shape.targets.is_empty();
        let mut data = match deforms {
            true => {
                let joints = pose.skin.as_ref().map_or(&[][..], |(_, joints)| joints);
                shape.deformed(&pose.weights, joints).map_err(|e| format!("JOINTS_0: {e}"))?
            }
            false => std::mem::take(&mut shape.base),
        };
        if let Some(i) = first(&data.positions, |p| !p.is_finite()) {
            return Err(format!("POSITION: vertex {} is infinite or NaN", used[i]).into());
        }
        repair(&mut data, self.warnings);
        let mesh = Mesh::new(data).map_err(|e| e.to_string())?;
        self.warnings.note("triangles without area", mesh.degenerate_triangles());
        Ok(Some(Built { mesh, shape: (deforms && self.moves).then_some(shape) }))
    }

    /// Returns the vertices `used` of a primitive with the data that deforms them, without triangles.
    fn shape(
        &mut self,
        vertices: &Vertices,
        used: &[u32],
        pose: &Pose,
        place: &str,
    ) -> std::result::Result<Deformable, Stop> {
        let base = vertices.read(used, place, self.warnings);
        let wanted = Wanted { weights: &pose.weights, all: self.moves };
        if wanted.all {
            self.spend(used.len().saturating_mul(vertices.primitive.targets.as_ref().map_or(0, Vec::len)))?;
        }
        let mut note = |why: String| self.warnings.note(format!("{place}: skipped {why}"), 1);
        let targets = read_targets(vertices, used, &wanted, &mut note)?;
        let binding = match &pose.skin {
            Some(_) => Some(read_binding(vertices, used, self.warnings)?),
            None => None,
        };
        Ok(Deformable { base, targets, binding })
    }

    fn indices(&mut self, primitive: &Primitive, vertices: usize) -> std::result::Result<Vec<u32>, Stop> {
        let within = |why: String| format!("indices: {why}");
        let accessor = match primitive.indices {
            Some(index) => Some(Accessor::open(self.document, index.value()).map_err(within)?),
            None => None,
        };
        let indices = accessor.as_ref().map_or(vertices, |a| a.count);
        self.spend(indices)?;
        // Without normals, each corner becomes a vertex of its facet.
        let is_flat = attribute(primitive, Semantic::Normals).is_none();
        self.take(bytes_of(vertices, indices) + if is_flat { indices as u64 * FLAT_CORNER } else { 0 })?;
        let read = read_indices(accessor.as_ref(), vertices).map_err(within)?;
        if let Some(restart) = accessor.as_ref().and_then(Accessor::restart) {
            let what = "indices that are the largest number of their type, which viewers take for the start of a new primitive, so \
                        that triangles are missing: store larger indices";
            self.warnings.note(what, read.iter().filter(|index| **index == restart).count());
        }
        Ok(read)
    }

    /// Counts bytes that are about to be allocated.
    fn take(&self, bytes: u64) -> std::result::Result<(), Stop> {
        let reading = &self.document.reading;
        match reading.take(bytes) {
            true => Ok(()),
            false => reading.check().map_err(Stop::Everything),
        }
    }

    fn spend(&mut self, elements: usize) -> std::result::Result<(), Stop> {
        match self.budget.checked_sub(elements) {
            Some(rest) => self.budget = rest,
            None => {
                let bytes = self.document.total_bytes();
                return Err(Stop::Everything(Error::limit(
                    format!("{}: the geometry", self.document.path.display()),
                    format!("its primitives share {bytes} bytes too often; split the file"),
                )));
            }
        }
        Ok(())
    }
}

/// The extent of a failure: one primitive or the whole file.
pub(super) enum Stop {
    Here(String),
    Everything(Error),
}

impl From<String> for Stop {
    fn from(why: String) -> Self {
        Self::Here(why)
    }
}

/// Maximum number of sets of four joints read per vertex.
const MAX_JOINT_SETS: u32 = 4;

/// The choice of morph targets that are read.
struct Wanted<'a> {
    /// The weights at rest; a target without one has weight 0.
    weights: &'a [f32],
    /// `true` if weights will change, so that all targets are needed, not only those with a weight.
    all: bool,
}

/// Returns the morph targets for the vertices `used`. One that cannot be read is skipped with a warning that starts
/// with `place`, unless it has a weight at rest. Targets that are not wanted are empty.
fn read_targets(
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
fn read_binding(vertices: &Vertices, used: &[u32], warnings: &mut Warnings) -> Reason<Binding> {
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
