//! Deforms vertices: morph targets and linear blend skinning.

use super::{MeshData, gather};
use crate::error::{Error, Result};
use crate::math::{Mat4, Vec3};
use crate::parallel;
use std::collections::HashMap;

/// Adds `weight · deltas[i]` to each `values[i]`. Surplus elements of either are unchanged.
///
/// Normals and tangents morphed this way must be normalised afterwards.
/// Source: glTF 2.0, 3.7.2.2.
pub fn morph(values: &mut [Vec3], deltas: &[Vec3], weight: f32) {
    for (value, delta) in values.iter_mut().zip(deltas) {
        *value += *delta * weight;
    }
}

/// The joints that move each vertex, with their weights.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Binding {
    /// The number of joints per vertex.
    pub per_vertex: usize,
    /// `per_vertex` joint indices per vertex.
    pub joints: Vec<u32>,
    /// `per_vertex` weights per vertex; each vertex's sum to one.
    pub weights: Vec<f32>,
}

/// Deforms the vertices of `data` by linear blend skinning: each by M = Σ wⱼ · `joint_matrices[j]`, normals by M's
/// cofactors, tangents by M's linear part; if M mirrors, the handedness flips. Joint matrices map object space to the
/// target space, usually `world_from_joint * joint_from_object_at_bind`.
///
/// The cofactors are M's inverse transpose up to a positive factor, so normals stay perpendicular under joints that
/// scale non-uniformly. The variation of the weights along the surface is ignored, as in every engine: a normal is
/// transformed as if its vertex's M applied all around it.
///
/// # Errors
/// [`Error::Invalid`] if the binding is not as long as the positions or refers to a joint that does not exist; `data`
/// is then unchanged.
/// Source: glTF 2.0, 3.7.3.3; Magnenat-Thalmann et al. 1988.
pub fn skin(data: &mut MeshData, binding: &Binding, joint_matrices: &[Mat4]) -> Result<()> {
    let vertices = data.positions.len();
    check(binding, vertices, joint_matrices.len())?;
    let matrix = |vertex: usize| blended(binding, vertex, joint_matrices);
    parallel::change(&mut data.positions, |i, position| {
        *position = matrix(i).transform_point(position.to_f64()).to_f32();
    });
    parallel::change(up_to(vertices, &mut data.normals), |i, normal| {
        let n = normal.to_f64();
        *normal = matrix(i).normal_matrix().transform_vector(n).normalize_or(n).to_f32();
    });
    parallel::change(up_to(vertices, &mut data.tangents), |i, [x, y, z, handedness]| {
        let (m, t) = (matrix(i), Vec3::new(*x, *y, *z).to_f64());
        [*x, *y, *z] = m.transform_vector(t).normalize_or(t).to_f32().to_array();
        if m.determinant3() < 0.0 {
            *handedness = -*handedness;
        }
    });
    Ok(())
}

/// Returns the first `count` elements, or all if there are fewer.
fn up_to<T>(count: usize, all: &mut [T]) -> &mut [T] {
    let count = count.min(all.len());
    &mut all[..count]
}

fn check(binding: &Binding, vertices: usize, joints: usize) -> Result<()> {
    let expected = vertices * binding.per_vertex;
    if binding.joints.len() != expected || binding.weights.len() != expected {
        let (j, w) = (binding.joints.len(), binding.weights.len());
        return Err(Error::invalid(
            "skin binding",
            format!("{j} joints and {w} weights; expected {expected}"),
        ));
    }
    match binding.joints.iter().position(|j| *j as usize >= joints) {
        Some(i) => Err(Error::invalid(
            format!("vertex {}", i / binding.per_vertex),
            format!("it refers to joint {}, but there are {joints}", binding.joints[i]),
        )),
        None => Ok(()),
    }
}

fn blended(binding: &Binding, vertex: usize, joint_matrices: &[Mat4]) -> Mat4 {
    let range = vertex * binding.per_vertex..(vertex + 1) * binding.per_vertex;
    let mut sum = [[0.0; 4]; 4];
    for (joint, weight) in binding.joints[range.clone()].iter().zip(&binding.weights[range]) {
        let columns = &joint_matrices[*joint as usize].columns;
        for (total, value) in sum.as_flattened_mut().iter_mut().zip(columns.as_flattened()) {
            *total += value * f64::from(*weight);
        }
    }
    Mat4 { columns: sum }
}

/// The displacements that a morph target of weight one adds to each vertex; unaffected arrays are empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MorphTarget {
    /// Added to positions, model units.
    pub positions: Vec<Vec3>,
    /// Added to normals.
    pub normals: Vec<Vec3>,
    /// Added to the directions of tangents; their handedness is unchanged.
    pub tangents: Vec<Vec3>,
}

/// A mesh before it is deformed, with its morph targets and its skin's weights.
#[derive(Debug, Clone, Default)]
pub struct Deformable {
    /// The arrays as authored.
    pub base: MeshData,
    /// The morph targets.
    pub targets: Vec<MorphTarget>,
    /// The joints that move each vertex; `None` without a skin.
    pub binding: Option<Binding>,
}

impl Deformable {
    /// Returns the deformed arrays: morph targets first, then the skin. Missing weights are zero; a target of weight
    /// zero changes no bit. `joint_matrices` are as for [`skin`] and unused without a binding.
    ///
    /// The mesh's own normals and tangents are deformed with it, so a tangent-space normal map is read in the frame
    /// in which it was baked, moved along with the surface.
    ///
    /// # Errors
    /// As for [`skin`].
    pub fn deformed(&self, weights: &[f32], joint_matrices: &[Mat4]) -> Result<MeshData> {
        let mut data = self.base.clone();
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            target.add_to(&mut data, *weight);
        }
        if let Some(binding) = &self.binding {
            skin(&mut data, binding, joint_matrices)?;
        }
        Ok(data)
    }

    /// Returns the mesh with these tangents at the corners of its triangles. A vertex whose corners differ is split.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is not one triple of tangents per triangle, or an array is neither empty nor as
    /// long as the positions.
    pub fn with_corner_tangents(self, tangents: &[[[f32; 4]; 3]]) -> Result<Self> {
        self.check()?;
        if tangents.len() != self.base.triangles.len() {
            let (given, wanted) = (tangents.len(), self.base.triangles.len());
            return Err(Error::invalid("corner tangents", format!("{given} for {wanted} triangles")));
        }
        let mut numbers = HashMap::new();
        let mut corners: Vec<(u32, [f32; 4])> = Vec::new();
        let mut number = |vertex: u32, tangent: [f32; 4]| {
            *numbers.entry((vertex, tangent.map(f32::to_bits))).or_insert_with(|| {
                corners.push((vertex, tangent));
                corners.len() as u32 - 1
            })
        };
        let pairs = self.base.triangles.iter().zip(tangents);
        let triangles = pairs.map(|(t, tangents)| [0, 1, 2].map(|i| number(t[i], tangents[i]))).collect();
        let old: Vec<usize> = corners.iter().map(|(vertex, _)| *vertex as usize).collect();
        let mut split = self.gathered(&old);
        split.base.tangents = corners.into_iter().map(|(_, tangent)| tangent).collect();
        split.base.triangles = triangles;
        Ok(split)
    }

    /// Checks that arrays are as long as the positions and that triangles refer to existing vertices.
    ///
    /// # Errors
    /// [`Error::Invalid`] if not.
    pub fn check(&self) -> Result<()> {
        self.base.check()?;
        let count = self.base.positions.len();
        let arrays = self.targets.iter().flat_map(|t| [&t.positions, &t.normals, &t.tangents]);
        let whole = arrays.map(Vec::len).all(|length| length == 0 || length == count);
        let bound = |b: &Binding| b.joints.len() == count * b.per_vertex && b.weights.len() == b.joints.len();
        match whole && self.binding.as_ref().is_none_or(bound) {
            true => Ok(()),
            false => Err(Error::invalid("a mesh's deformation", format!("it is not for {count} vertices"))),
        }
    }

    /// Returns only the vertices `which`, without triangles.
    fn gathered(&self, which: &[usize]) -> Self {
        let targets = self.targets.iter().map(|target| MorphTarget {
            positions: gather(&target.positions, which),
            normals: gather(&target.normals, which),
            tangents: gather(&target.tangents, which),
        });
        Self {
            base: self.base.gathered(which),
            targets: targets.collect(),
            binding: self.binding.as_ref().map(|b| b.gathered(which)),
        }
    }
}

impl MorphTarget {
    fn add_to(&self, data: &mut MeshData, weight: f32) {
        morph(&mut data.positions, &self.positions, weight);
        morph(&mut data.normals, &self.normals, weight);
        for ([x, y, z, _], delta) in data.tangents.iter_mut().zip(&self.tangents) {
            let moved = Vec3::new(*x, *y, *z) + *delta * weight;
            [*x, *y, *z] = moved.to_array();
        }
    }
}

impl Binding {
    fn gathered(&self, which: &[usize]) -> Self {
        let n = self.per_vertex;
        Self {
            per_vertex: n,
            joints: which.iter().flat_map(|i| &self.joints[i * n..(i + 1) * n]).copied().collect(),
            weights: which.iter().flat_map(|i| &self.weights[i * n..(i + 1) * n]).copied().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data() -> MeshData {
        MeshData {
            positions: vec![Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)],
            normals: vec![Vec3::new(1.0, 0.0, 0.0); 2],
            tangents: vec![[0.0, 1.0, 0.0, 1.0]; 2],
            ..MeshData::default()
        }
    }

    fn binding(weights: [f32; 4]) -> Binding {
        Binding { per_vertex: 2, joints: vec![0, 1, 0, 1], weights: weights.to_vec() }
    }

    #[test]
    fn morph_adds_weighted_deltas() {
        let mut values = vec![Vec3::new(1.0, 2.0, 3.0); 2];
        morph(&mut values, &[Vec3::new(2.0, 0.0, -4.0)], 0.5);
        assert_eq!(values, [Vec3::new(2.0, 2.0, 1.0), Vec3::new(1.0, 2.0, 3.0)]);
    }

    #[test]
    fn a_half_bound_vertex_goes_half_way() {
        let mut data = data();
        let joints = [Mat4::IDENTITY, Mat4::translation(Vec3::new(0.0, 0.0, 4.0))];
        skin(&mut data, &binding([0.5, 0.5, 0.0, 1.0]), &joints).unwrap();
        assert_eq!(data.positions, [Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 2.0, 4.0)]);
        assert_eq!(data.normals[0], Vec3::new(1.0, 0.0, 0.0));
    }

    #[test]
    fn normals_turn_and_mirrors_turn_the_handedness() {
        let quarter = Mat4::rotation_about(Vec3::new(0.0, 0.0, 1.0), std::f64::consts::FRAC_PI_2);
        let joints = [quarter, Mat4::scale(Vec3::new(-1.0, 1.0, 1.0))];
        let mut data = data();
        skin(&mut data, &binding([1.0, 0.0, 0.0, 1.0]), &joints).unwrap();
        let close = |a: Vec3, b: [f32; 3]| (a - Vec3::from_array(b)).length() < 1e-6;
        assert!(close(data.positions[0], [0.0, 1.0, 0.0]) && close(data.normals[0], [0.0, 1.0, 0.0]));
        assert!(close(data.normals[1], [-1.0, 0.0, 0.0]));
        assert_eq!([data.tangents[0][3], data.tangents[1][3]], [1.0, -1.0]);
        // b = s · cross(n, t) is the image of the old bitangent under either matrix.
        let [x, y, z, s] = data.tangents[1];
        assert!(close(data.normals[1].cross(Vec3::new(x, y, z)) * s, [0.0, 0.0, 1.0]));
    }

    #[test]
    fn bindings_are_checked() {
        let joints = [Mat4::IDENTITY];
        let why = skin(&mut data(), &binding([1.0; 4]), &joints).unwrap_err().to_string();
        assert!(why.contains("joint 1"), "{why}");
        assert!(skin(&mut data(), &Binding { per_vertex: 2, ..Binding::default() }, &joints).is_err());
    }

    fn square() -> Deformable {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let base = MeshData {
            positions: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)],
            normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
            tangents: vec![[1.0, 0.0, 0.0, -1.0]; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        };
        let target = MorphTarget {
            positions: (0..4).map(|i| Vec3::new(0.0, 0.0, i as f32)).collect(),
            normals: vec![Vec3::new(0.0, 2.0, 0.0); 4],
            tangents: vec![Vec3::new(0.0, 0.0, 4.0); 4],
        };
        let binding = Binding { per_vertex: 1, joints: vec![0, 0, 1, 1], weights: vec![1.0; 4] };
        Deformable { base, targets: vec![MorphTarget::default(), target], binding: Some(binding) }
    }

    #[test]
    fn targets_come_before_the_skin() {
        let joints = [Mat4::IDENTITY, Mat4::scale(Vec3::new(1.0, 1.0, 10.0))];
        let data = square().deformed(&[9.0, 0.5], &joints).unwrap();
        assert_eq!([data.positions[1].z, data.positions[3].z], [0.5, 15.0]);
        let at_rest = square().deformed(&[], &[Mat4::IDENTITY; 2]).unwrap();
        assert_eq!(at_rest.positions, square().base.positions);
    }

    #[test]
    fn targets_move_normals_and_tangents_but_not_the_handedness() {
        let still = Deformable { binding: None, ..square() };
        let data = still.deformed(&[0.0, 0.5], &[]).unwrap();
        assert_eq!(data.normals[0], Vec3::new(0.0, 1.0, 1.0));
        assert_eq!(data.tangents[0], [1.0, 0.0, 2.0, -1.0]);
    }

    #[test]
    fn vertices_split_only_where_their_corners_differ() {
        let (x, y) = ([1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]);
        let split = square().with_corner_tangents(&[[x, x, y], [x, x, x]]).unwrap();
        // Vertex 2 has two tangents, the others one.
        assert_eq!(split.base.triangles, [[0, 1, 2], [0, 3, 4]]);
        assert_eq!(split.base.tangents, [x, x, y, x, x]);
        assert_eq!(split.base.positions[2], split.base.positions[3]);
        assert_eq!(split.binding.unwrap().joints, [0, 0, 1, 1, 1]);
        assert_eq!(split.targets[1].positions[4].z, 3.0);
        assert!(split.targets[0].positions.is_empty());
        assert!(square().with_corner_tangents(&[[x; 3]]).is_err());
        let short = Deformable { binding: Some(Binding::default()), ..square() };
        assert!(short.with_corner_tangents(&[[x; 3]; 2]).is_ok(), "no joints at all");
        let mut short = square();
        short.targets[1].positions.pop();
        assert!(short.with_corner_tangents(&[[x; 3]; 2]).is_err());
    }
}
