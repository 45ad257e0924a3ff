//! Simplification of a high-poly surface: few triangles that stay close to the original.

mod apart;
mod blocks;
mod cluster;
mod collapse;
mod components;
mod fan;
mod folds;
mod morton;
mod options;
mod part;
mod seams;
mod slivers;
mod weld;
mod whole;

use crate::error::{Error, Result, Warnings};
use crate::mesh::{Mesh, MeshData};
use crate::progress::Progress;
use crate::surface::{creased, has_turned_facets, with_normals};
use collapse::Reduced;
pub(super) use collapse::is_near;
use components::{Components, Fate};
pub(super) use morton::morton;
pub use options::{SimplifyMethod, SimplifyOptions};
use part::Part;
pub(super) use part::{UnitCube, adapter, compact, triples};
pub(super) use weld::places;

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
    let (mut part, cube) = weld::weld(mesh, &mut notes);
    if part.triangles.is_empty() {
        return Err(Error::invalid(
            "the surface to simplify",
            "no triangle has three different corners; check the file",
        ));
    }
    let components = Components::of(&mut part);
    progress.at(0.1)?;
    let (part, in_blocks) = blocks::lighten(part, &components, options.triangles, progress.part(0.1, 0.7))?;
    progress.at(0.7)?;
    let mut reduced = whole::reduce(&part, &components, options);
    if reduced.method != SimplifyMethod::Kept {
        let normals = collapse::normals(&part.points, &part.triangles);
        folds::take_back(&part.points, &normals, &mut reduced);
        reduced.triangles = slivers::repaired(&reduced.points, reduced.triangles);
        reduced.triangles = folds::unfolded(&reduced.points, &normals, reduced.triangles);
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
    let (triangles, used) = part::compact(reduced.triangles, part.points.len());
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
