//! Deforms vertices: morph targets and linear blend skinning.

mod deformable;

pub use deformable::{Deformable, MorphTarget};

use super::MeshData;
use crate::error::{Error, Result};
use crate::math::{Mat4, Vec3};
use crate::parallel;

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
}
