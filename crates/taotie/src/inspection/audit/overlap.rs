//! Triangles that overlap in uv.

use super::check::{Check, CheckResult};
use super::uv_raster::{MOST_SIDE, UvRaster};
use super::words::{counted, number};
use crate::error::Result;
use crate::mesh::Mesh;

/// Raster texels per triangle, on average over the uvs' box.
const TEXELS: f64 = 9.0;

/// The minimum length of a raster's longer side.
const LEAST_SIDE: f64 = 1024.0;

/// Checks that no two triangles of a mesh overlap in uv: no two cover the centre of the same texel. Edges are exact,
/// so that neighbours never overlap. Different meshes may overlap.
///
/// # Errors
/// [`crate::Error::Limit`] for a mesh of 2³¹ triangles.
pub(super) fn result(meshes: &[&Mesh], required: bool) -> Result<CheckResult> {
    if !required {
        return Ok(CheckResult::not_tested(Check::OverlappingUvs, "not required"));
    }
    let (mut shared, mut covered) = (0, 0);
    for mesh in meshes {
        let count = mesh.triangles().len();
        let side = (count as f64 * TEXELS).sqrt().clamp(LEAST_SIDE, f64::from(MOST_SIDE));
        let Some(raster) = UvRaster::across(mesh, side) else { continue };
        let coverage = raster.coverage(0..count as u32)?;
        shared += coverage.shared();
        covered += coverage.covered();
    }
    let covered = number(covered as f64);
    let message =
        format!("{} of {covered} covered by more than one triangle (at most 0)", counted(shared, "texel"));
    Ok(CheckResult::of_faults(Check::OverlappingUvs, shared, message))
}
