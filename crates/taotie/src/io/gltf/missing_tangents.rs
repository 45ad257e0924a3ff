//! MikkTSpace tangents for primitives of a file that have none, if no vertex needs more than one.

use super::accessor::Accessor;
use super::document::Document;
use super::extensions::{DRACO, extension};
use super::primitives::{bytes_of, most_elements};
use super::source::GltfSource;
use super::triangles::{read_indices, triangulate};
use super::vertices::{Vertices, attribute};
use crate::error::{Result, Warnings};
use crate::io::reading::Reading;
use crate::mesh::{Mesh, repair};
use crate::surface::{TangentMethod, with_tangents};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use std::sync::Arc;

/// The tangents of a primitive.
pub(in crate::io) struct MissingTangents {
    /// The index of its mesh in the file.
    pub mesh: usize,
    /// Its index in the mesh.
    pub primitive: usize,
    /// The tangents, in vertex order.
    pub tangents: Vec<[f32; 4]>,
}

/// Computes the tangents of the primitives in the file of `reading` that use one of `materials`, given by index, and
/// have normals and uvs but no tangents. Skips primitives whose vertices would have to be split, and those beyond the
/// budget of a file of its size.
///
/// # Errors
/// Those of reading the file; [`crate::Error::Limit`] if its meshes do not fit in memory.
pub(in crate::io) fn missing_tangents(
    source: GltfSource<'_>,
    reading: &Arc<Reading>,
    materials: &[usize],
) -> Result<Vec<MissingTangents>> {
    let content = source.bytes(reading)?.into_owned();
    let document = Document::of(reading, content, &mut Warnings::default())?;
    let mut budget = most_elements(&document);
    let count = document.root.materials.len();
    let mut found = Vec::new();
    for (mesh, json) in document.root.meshes.iter().enumerate() {
        for (primitive, json) in json.primitives.iter().enumerate() {
            let material = json.material.map_or(count, |material| material.value().min(count));
            if !materials.contains(&material) {
                continue;
            }
            if let Some(tangents) = tangents(&document, json, &mut budget) {
                found.push(MissingTangents { mesh, primitive, tangents });
            }
        }
    }
    // A primitive skipped for lack of memory must not pass as one without missing tangents.
    reading.check()?;
    Ok(found)
}

fn tangents(document: &Document, primitive: &Primitive, budget: &mut usize) -> Option<Vec<[f32; 4]>> {
    let has = |semantic: Semantic| attribute(primitive, semantic).is_some();
    if extension(primitive, DRACO).is_some()
        || has(Semantic::Tangents)
        || !has(Semantic::Normals)
        || !has(Semantic::TexCoords(0))
    {
        return None;
    }
    let Checked::Valid(mode) = primitive.mode else { return None };
    let vertices = Vertices::open(document, primitive).ok()??;
    let indices = primitive.indices.map(|index| Accessor::open(document, index.value()));
    let indices = indices.transpose().ok()?;
    let count = indices.as_ref().map_or(0, |indices| indices.count);
    *budget = budget.checked_sub(vertices.count.checked_add(count)?)?;
    if !document.reading.take(bytes_of(vertices.count, count)) {
        return None;
    }
    let triangles = triangulate(mode, &read_indices(indices.as_ref(), vertices.count).ok()?)?.list;
    let all: Vec<u32> = (0..vertices.count as u32).collect();
    let mut data = vertices.read(&all, "", &mut Warnings::default());
    data.triangles = triangles;
    repair(&mut data, &mut Warnings::default());
    one_a_vertex(&Mesh::new(data).ok()?)
}

/// Returns the tangent of each vertex; `None` if a vertex has several.
fn one_a_vertex(mesh: &Mesh) -> Option<Vec<[f32; 4]>> {
    let made = with_tangents(mesh, 0, TangentMethod::MikkTSpace).ok()?.mesh;
    let mut found = vec![None; mesh.positions().len()];
    let corners = mesh.triangles().as_flattened().iter().zip(made.triangles().as_flattened());
    for (vertex, split) in corners {
        let tangent = made.tangents()[*split as usize];
        if found[*vertex as usize].replace(tangent).is_some_and(|known| known != tangent) {
            return None;
        }
    }
    // Vertices without triangles still need a tangent of length 1.
    Some(found.into_iter().map(|tangent| tangent.unwrap_or([1.0, 0.0, 0.0, 1.0])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vec2, Vec3};
    use crate::mesh::MeshData;

    /// Two triangles that share an edge, the second with mirrored uvs if `is_mirrored`.
    fn pair(is_mirrored: bool) -> Mesh {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let uv = |x: f32, y: f32| Vec2::new(x, 1.0 - y);
        let last = if is_mirrored { uv(0.0, 0.0) } else { uv(1.0, 1.0) };
        Mesh::new(MeshData {
            positions: vec![
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(0.0, 1.0),
                corner(1.0, 1.0),
                corner(9.0, 9.0),
            ],
            normals: vec![Vec3::new(0.0, 0.0, 1.0); 5],
            uvs: vec![vec![uv(0.0, 0.0), uv(1.0, 0.0), uv(0.0, 1.0), last, uv(0.0, 0.0)]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..MeshData::default()
        })
        .unwrap()
    }

    #[test]
    fn vertices_with_two_tangents_get_none() {
        let found = one_a_vertex(&pair(false)).expect("each vertex has one");
        let is_right = |[x, y, z, w]: &[f32; 4]| (x - 1.0).abs() + y.abs() + z.abs() < 1e-6 && *w == 1.0;
        assert!(found.len() == 5 && found.iter().all(is_right), "{found:?}");
        assert_eq!(one_a_vertex(&pair(true)), None);
    }
}
