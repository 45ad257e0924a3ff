//! A mesh before deformation, with everything that can deform it.

use super::{Binding, morph, skin};
use crate::error::{Error, Result};
use crate::math::{Mat4, Vec3};
use crate::mesh::MeshData;
use std::collections::HashMap;

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
        let base = MeshData {
            positions: gather(&self.base.positions, which),
            normals: gather(&self.base.normals, which),
            tangents: gather(&self.base.tangents, which),
            uvs: self.base.uvs.iter().map(|set| gather(set, which)).collect(),
            colors: gather(&self.base.colors, which),
            triangles: Vec::new(),
        };
        let targets = self.targets.iter().map(|target| MorphTarget {
            positions: gather(&target.positions, which),
            normals: gather(&target.normals, which),
            tangents: gather(&target.tangents, which),
        });
        Self { base, targets: targets.collect(), binding: self.binding.as_ref().map(|b| b.gathered(which)) }
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

/// Returns the elements `which`; nothing for an absent array.
fn gather<T: Copy>(from: &[T], which: &[usize]) -> Vec<T> {
    if from.is_empty() { Vec::new() } else { which.iter().map(|i| from[*i]).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

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
