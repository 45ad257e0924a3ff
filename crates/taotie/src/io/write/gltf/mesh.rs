//! Writes meshes as accessors.

use super::draft::{Component, GltfDraft};
use super::parts::MeshPart;
use crate::math::Vec3;
use crate::mesh::Mesh;
use serde_json::{Value, json};

/// Maximum number of vertices for 16-bit indices; 65535 itself restarts a primitive.
pub(super) const MOST_OF_U16: usize = 65535;

/// Adds a mesh and returns one primitive per part; all share its vertices.
pub(super) fn add(draft: &mut GltfDraft, mesh: &Mesh, parts: &[MeshPart]) -> Vec<Value> {
    let attributes = attributes(draft, mesh);
    let primitive = |part: &MeshPart| {
        let indices = indices(draft, &part.triangles, mesh.positions().len());
        json!({ "attributes": attributes, "indices": indices, "material": part.material })
    };
    parts.iter().map(primitive).collect()
}

fn attributes(draft: &mut GltfDraft, mesh: &Mesh) -> Value {
    let mut attributes = json!({ "POSITION": draft.bounded_floats(&arrays(mesh.positions())) });
    if !mesh.normals().is_empty() {
        attributes["NORMAL"] = draft.floats(&arrays(mesh.normals())).into();
        if !mesh.tangents().is_empty() {
            attributes["TANGENT"] = draft.floats(mesh.tangents()).into();
        }
    }
    for (set, uvs) in mesh.uvs().iter().enumerate() {
        let uvs: Vec<[f32; 2]> = uvs.iter().map(|uv| [uv.x, uv.y]).collect();
        attributes[semantic("TEXCOORD", set)] = draft.floats(&uvs).into();
    }
    if !mesh.colors().is_empty() {
        attributes[semantic("COLOR", 0)] = draft.floats(mesh.colors()).into();
    }
    let accessors = attributes.as_object().into_iter().flatten().filter_map(|(_, a)| a.as_u64());
    accessors.for_each(|accessor| draft.mark_vertices(accessor as usize));
    attributes
}

/// Returns the name of one of several attributes of a kind.
pub(super) fn semantic(kind: &str, set: usize) -> String {
    format!("{kind}_{set}")
}

fn arrays(vectors: &[Vec3]) -> Vec<[f32; 3]> {
    vectors.iter().map(|v| v.to_array()).collect()
}

fn indices(draft: &mut GltfDraft, triangles: &[[u32; 3]], vertices: usize) -> usize {
    let indices = triangles.as_flattened().iter();
    let (bytes, component): (Vec<u8>, _) = if vertices <= MOST_OF_U16 {
        (indices.flat_map(|index| (*index as u16).to_le_bytes()).collect(), Component::U16)
    } else {
        (indices.flat_map(|index| index.to_le_bytes()).collect(), Component::U32)
    };
    let accessor = draft.elements(&bytes, component, 1);
    draft.mark_indices(accessor);
    accessor
}
