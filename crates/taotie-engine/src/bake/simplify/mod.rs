//! Simplification of a high-poly surface: few triangles that stay close to the original; and levels of detail of an
//! unwrapped mesh, all of which use the same maps.

mod collapse;
mod fan;
mod part;
mod reduction;
mod repair;
mod weld;

use crate::error::{Error, Result, Warnings};
use crate::mesh::{Mesh, MeshData, RELIEF_OF_VERTICES};
use crate::parallel;
use crate::progress::Progress;
use crate::surface::{creased, has_turned_facets, with_normals};
use collapse::{Reduced, is_near, lighten};
pub use collapse::{SimplifyMethod, SimplifyOptions};
use meshopt::SimplifyOptions as Choices;
use part::{Components, Fate, Part, adapter, compact, triples};
pub(super) use part::{UnitCube, morton};
use reduction::reduce;
pub(super) use weld::places;
use weld::weld;

/// A simplified surface.
#[derive(Debug, Clone)]
pub struct Simplified {
    /// Positions, normals and triangles; neither uvs nor colours. Vertices are moved to the positions nearest the
    /// surface.
    pub mesh: Mesh,
    /// The distance of the low-poly surface from the high-poly one, in model units: meshoptimizer's estimate, about
    /// the root mean square near the worst place, not a bound.
    pub error: f64,
    /// The roughest method that was needed.
    pub method: SimplifyMethod,
    /// `true` if the number of triangles is the requested one or within 2 % of it, or the surface had fewer. If
    /// `false`, all methods that join nothing and lose no large part were tried, and this is the best result.
    pub reached: bool,
    /// Counts of what was left out.
    pub notes: Warnings,
}

/// Simplifies a surface.
///
/// Vertices with equal positions are welded first, whatever their normals, uvs and colours, and so are vertices of
/// open edges that differ by less than a thousandth of their shortest edge or by rounding, counted. Triangles with
/// two equal corners, and duplicate triangles, are left out and counted. There is one normal per position, unless a
/// facet would turn away from it. Large surfaces are first simplified block by block, in parallel; the result does
/// not depend on the number of threads.
///
/// Disconnected parts are never joined, except in a soup of loose triangles. A part of more than half a per cent of
/// the area, or a fiftieth of the diagonal, is not lost; smaller ones may be, and are counted. Slivers are flipped or
/// collapsed away if that does not bend the surface; so are facets that face away from the normals of the high-poly
/// surface. Two facets back to back on an edge of the surface are removed.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Invalid`] if the requested number of triangles is 0, the weight is not a finite
/// number of at least 0, the mesh has no triangle with three different corners, or the requested number is so low
/// that none is left.
///
/// Source: Garland and Heckbert 1997, "Surface simplification using quadric error metrics", as meshoptimizer does it.
pub fn simplify(mesh: &Mesh, options: &SimplifyOptions, progress: Progress<'_>) -> Result<Simplified> {
    check(options)?;
    let mut notes = Warnings::default();
    let (mut part, cube) = weld(mesh, &mut notes);
    if part.triangles.is_empty() {
        return Err(Error::invalid(
            "the surface to simplify",
            "no triangle has three different corners; check the file",
        ));
    }
    let components = Components::of(&mut part);
    progress.at(0.1)?;
    let (part, in_blocks) = lighten(part, &components, options.triangles, progress.part(0.1, 0.7))?;
    progress.at(0.7)?;
    let mut reduced = reduce(&part, &components, options);
    if reduced.method != SimplifyMethod::Kept {
        let normals = collapse::normals(&part.points, &part.triangles);
        repair::take_back(&part.points, &normals, &mut reduced);
        reduced.triangles = repair::without_slivers(&reduced.points, reduced.triangles);
        reduced.triangles = repair::unfolded(&reduced.points, &normals, reduced.triangles);
    }
    let found = reduced.triangles.len();
    if found == 0 {
        return Err(Error::invalid(
            format!("a surface of {} triangles", options.triangles),
            "all its parts are too small to keep at this count; request more triangles",
        ));
    }
    let error = (f64::from(in_blocks) + f64::from(reduced.error)) * cube.extent;
    let method = if in_blocks > 0.0 { reduced.method.max(SimplifyMethod::Collapsed) } else { reduced.method };
    if method != SimplifyMethod::Clustered {
        note_fate(components.fate(&part, &reduced.triangles), &mut notes);
    }
    let mesh = finish(mesh, (&part, &cube), reduced)?;
    let reached = is_near(found, options.triangles) || method == SimplifyMethod::Kept;
    progress.at(1.0)?;
    Ok(Simplified { mesh, error, method, reached, notes })
}

fn note_fate(fate: Fate, notes: &mut Warnings) {
    let small = fate.lost - fate.lost_large;
    notes.note("small disconnected parts, left out because too few triangles were requested", small);
    notes.note("disconnected parts, lost because too few triangles were requested", fate.lost_large);
    notes.note("parts that came apart because too few triangles were requested", fate.torn);
}

fn check(options: &SimplifyOptions) -> Result<()> {
    if options.triangles == 0 {
        return Err(Error::invalid("a surface of 0 triangles", "request at least one"));
    }
    let weight = options.normal_weight;
    if !(weight >= 0.0 && weight.is_finite()) {
        return Err(Error::invalid(format!("a normal weight of {weight}"), "use a number of at least 0"));
    }
    Ok(())
}

/// Returns the triangles with positions in the space of the mesh, bit-identical to its own if they did not move, and
/// with normals from which hardly any facet turns away.
fn finish(mesh: &Mesh, (part, cube): (&Part, &UnitCube), reduced: Reduced) -> Result<Mesh> {
    let (triangles, used) = compact(reduced.triangles, part.points.len());
    let position = |v: &u32| {
        let v = *v as usize;
        match reduced.points[v] == part.points[v] {
            true => mesh.positions()[part.sources[v] as usize],
            false => cube.placed(reduced.points[v]),
        }
    };
    let positions = used.iter().map(position).collect();
    let mesh =
        with_normals(&Mesh::new(MeshData { positions, triangles, ..MeshData::default() })?)?.into_owned();
    // A few are folded facets of a continuous surface, whose neighbours indicate better which way is out.
    if has_turned_facets(&mesh) { creased(&mesh) } else { Ok(mesh) }
}

/// The weight of a distance on the map relative to one on the surface: the map's side counts as the mesh's longest
/// side times this.
const UV_WEIGHT: f32 = 3.0;

/// A level of detail.
#[derive(Debug, Clone)]
pub struct DetailLevel {
    /// The unwrapped mesh's vertices with all attributes except tangents, and fewer triangles. If a facet would turn
    /// away from its normals, and hardly any of the unwrapped mesh does, they are recomputed, and vertices are split
    /// at creases.
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
    let keeps_normals = mesh.normals().is_empty() || has_turned_facets(mesh);
    let levels = parallel::try_tasks(counts.len(), &|i| {
        progress.at(i as f64 / counts.len() as f64)?;
        let (triangles, error) = fewer(mesh, &points, &attributes, counts[i]);
        let reached = is_near(triangles.len(), counts[i]) || triangles.len() < counts[i];
        let level = with_triangles(mesh, triangles)?;
        let is_sound = keeps_normals || !has_turned_facets(&level);
        let level = if is_sound { level } else { creased(&level)? };
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
