//! Levels of detail of an unwrapped mesh, all of which use the same maps.

use super::simplify::{UnitCube, adapter, compact, is_near, triples};
use crate::error::{Error, Result};
use crate::mesh::{Mesh, MeshData, RELIEF_OF_VERTICES};
use crate::parallel;
use crate::progress::Progress;
use crate::surface;
use meshopt::SimplifyOptions as Choices;

/// The weight of a distance on the map relative to one on the surface: the map's side counts as the mesh's longest
/// side times this.
const UV_WEIGHT: f32 = 3.0;

/// A level of detail.
#[derive(Debug, Clone)]
pub struct DetailLevel {
    /// The unwrapped mesh's vertices with all attributes except tangents, and fewer triangles. If a facet would turn
    /// away from its normals, and hardly any of the unwrapped mesh does, they are recomputed, and vertices are split at
    /// creases.
    pub mesh: Mesh,
    /// The distance from the unwrapped mesh and the shift of the maps on it, in model units: meshoptimizer's
    /// estimate, not a bound.
    pub error: f64,
    /// `true` if the number of triangles is the requested one or within 2 % of it, or the mesh had fewer. Corners of
    /// UV islands are never removed, so meshes with many islands have a minimum.
    pub reached: bool,
}

/// Returns levels of detail with these numbers of triangles, each made from the unwrapped mesh itself, in the order
/// of `counts`.
///
/// Vertices are those of the mesh, so all levels share its maps; where UV islands meet, both sides lose the same
/// vertices, so no level has a crack. Uvs in the first set are weighted like positions; for a mesh without uvs,
/// changes of normals are.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Invalid`] if a count is 0.
pub fn levels(mesh: &Mesh, counts: &[usize], progress: Progress<'_>) -> Result<Vec<DetailLevel>> {
    if counts.contains(&0) {
        return Err(Error::invalid("a level of 0 triangles", "use at least one"));
    }
    let cube = UnitCube::of(mesh.positions());
    let points: Vec<[f32; 3]> = mesh.positions().iter().map(|p| cube.scaled(*p)).collect();
    let attributes = Attributes::of(mesh);
    // Normals that face away on purpose, such as those of foliage, are kept.
    let keeps_normals = mesh.normals().is_empty() || surface::has_turned_facets(mesh);
    let levels = parallel::try_tasks(counts.len(), &|i| {
        progress.at(i as f64 / counts.len() as f64)?;
        let (triangles, error) = fewer(mesh, &points, &attributes, counts[i]);
        let reached = is_near(triangles.len(), counts[i]) || triangles.len() < counts[i];
        let level = with_triangles(mesh, triangles)?;
        let is_sound = keeps_normals || !surface::has_turned_facets(&level);
        let level = if is_sound { level } else { surface::creased(&level)? };
        Ok(DetailLevel { mesh: level, error: error * cube.extent, reached })
    })?;
    progress.at(1.0)?;
    Ok(levels)
}

/// Vertex attributes weighted in addition to positions, all numbers of a vertex together.
struct Attributes {
    values: Vec<f32>,
    /// The weight of each number of a vertex.
    weights: Vec<f32>,
}

impl Attributes {
    fn of(mesh: &Mesh) -> Self {
        match mesh.uvs().first() {
            Some(uvs) => {
                let values = uvs.iter().flat_map(|uv| [uv.x, uv.y]).collect();
                Self { values, weights: vec![UV_WEIGHT; 2] }
            }
            None => {
                let values: Vec<f32> = mesh.normals().iter().flat_map(|normal| normal.to_array()).collect();
                let weights = vec![RELIEF_OF_VERTICES; if values.is_empty() { 0 } else { 3 }];
                Self { values, weights }
            }
        }
    }
}

fn fewer(mesh: &Mesh, points: &[[f32; 3]], attributes: &Attributes, count: usize) -> (Vec<[u32; 3]>, f64) {
    if mesh.triangles().len() <= count {
        return (mesh.triangles().to_vec(), 0.0);
    }
    let (mut error, unlocked) = (0.0, vec![false; points.len()]);
    let corners = meshopt::simplify_with_attributes_and_locks(
        mesh.triangles().as_flattened(),
        &adapter(points),
        &attributes.values,
        &attributes.weights,
        size_of_val(attributes.weights.as_slice()),
        &unlocked,
        3 * count,
        f32::MAX,
        Choices::ErrorAbsolute,
        Some(&mut error),
    );
    (triples(corners), f64::from(error))
}

/// Returns the mesh with other triangles, without the vertices that they do not use.
fn with_triangles(mesh: &Mesh, triangles: Vec<[u32; 3]>) -> Result<Mesh> {
    let (triangles, used) = compact(triangles, mesh.positions().len());
    Mesh::new(MeshData {
        positions: chosen(mesh.positions(), &used),
        normals: chosen(mesh.normals(), &used),
        colors: chosen(mesh.colors(), &used),
        uvs: mesh.uvs().iter().map(|uvs| chosen(uvs, &used)).collect(),
        tangents: Vec::new(),
        triangles,
    })
}

/// Returns the values of some vertices; empty if no vertex has any.
pub(super) fn chosen<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { vertices.iter().map(|v| values[*v as usize]).collect() }
}
