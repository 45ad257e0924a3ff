//! A high-poly surface simplified: few triangles that lie near many.

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
    /// Positions, normals and triangles; neither uvs nor colours. Vertices moved to where they are nearest to the surface.
    pub mesh: Mesh,
    /// The distance of the low-poly surface from the high-poly one, model units: the estimate of meshoptimizer, of the
    /// size of the root mean square near the worst place, not a bound.
    pub error: f64,
    /// The roughest method that was needed.
    pub method: SimplifyMethod,
    /// `true` where the number of triangles is the wanted one, or less than 2 % off, or the surface had fewer. Where it
    /// is `false` all methods were tried that join nothing and lose no large part, and this is the best.
    pub reached: bool,
    /// The things that were left out, counted.
    pub notes: Warnings,
}

/// Simplifies a surface.
///
/// Vertices with equal positions are welded first, whatever normals, uvs and colours they have, and so are vertices of
/// open edges that differ by less than a thousandth of their shortest edge or by rounding, counted. Triangles with two
/// equal corners, and all but one of equal triangles, are left out and counted. The normals are
/// those of [`creased`]: one a position, but where a facet would turn away from it. Large surfaces are first simplified
/// block by block, in parallel; the result does not depend on the number of threads.
///
/// Parts without connection to one another are never joined, but in a soup of loose triangles. A part of more than half a
/// per cent of the area, or a fiftieth of the diagonal, is not lost; smaller ones may be, and are counted. Slivers are
/// flipped or collapsed away where that does not bend the surface; so are facets that face away from the normals of the
/// high-poly surface. Two facets back to back on an edge of the surface are taken off.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Invalid`] where no triangle is wanted, the weight is not a number from 0 up, the mesh
/// has no triangle with three corners, or none is left since so few are wanted.
///
/// Source: Garland and Heckbert 1997, "Surface simplification using quadric error metrics", as meshoptimizer does it.
pub fn simplify(mesh: &Mesh, options: &SimplifyOptions, progress: Progress<'_>) -> Result<Simplified> {
    check(options)?;
    let mut notes = Warnings::default();
    let (mut part, cube) = weld::weld(mesh, &mut notes);
    if part.triangles.is_empty() {
        return Err(Error::invalid(
            "the surface to simplify",
            "it has no triangle with three different corners; check the file",
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
        reduced.triangles = slivers::mended(&reduced.points, reduced.triangles);
        reduced.triangles = folds::unfolded(&reduced.points, &normals, reduced.triangles);
    }
    let found = reduced.triangles.len();
    if found == 0 {
        return Err(Error::invalid(
            format!("a surface of {} triangles", options.triangles),
            "nothing is left of this one with so few, as all its parts are small; ask for more",
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
    notes.note(
        "small parts without connection to the rest, left out since so few triangles were wanted",
        small,
    );
    notes.note(
        "parts without connection to the rest, lost since so few triangles were wanted",
        fate.lost_large,
    );
    notes.note("parts that came apart since so few triangles were wanted", fate.torn);
}

fn check(options: &SimplifyOptions) -> Result<()> {
    if options.triangles == 0 {
        return Err(Error::invalid("a surface of 0 triangles", "ask for at least one"));
    }
    let weight = options.normal_weight;
    if !(weight >= 0.0 && weight.is_finite()) {
        return Err(Error::invalid(format!("a normal weight of {weight}"), "give a number from 0 up"));
    }
    Ok(())
}

/// Returns the triangles with positions in the space of the mesh, to the bit its own if they did not move, and normals that hardly a facet turns away
/// from.
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
    // Few are folded facets of a surface that goes on, whose neighbours say better which way is out.
    if has_turned_facets(&mesh) { creased(&mesh) } else { Ok(mesh) }
}
