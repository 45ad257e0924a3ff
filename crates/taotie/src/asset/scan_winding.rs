//! Triangles of a scan that face the wrong way: flipped if there is no doubt, otherwise noted; and normals that
//! contradict the triangles.

use super::extent::{Extent, Spot, Whole};
use super::scan_normals::placements;
use crate::error::{Result, Warnings};
use crate::length::Unit;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use crate::scene::SceneData;
use crate::surface::{Opposed, facet_normal};

/// The share of the surface above which normals contradicting the geometry cause a warning.
const CONTRADICTED: f64 = 0.005;

/// Triangles in several meshes, as spots.
#[derive(Default)]
struct Found {
    triangles: usize,
    spots: Vec<Spot>,
    /// The unit of their coordinates.
    unit: Option<Unit>,
}

/// Flips triangles that are wound opposite to the surface around them, and notes where. Triangles whose correct
/// orientation is unclear are noted and left unchanged.
///
/// # Errors
/// None for meshes that were checked.
pub(super) fn turn(parts: &mut SceneData, unit: Option<Unit>, warnings: &mut Warnings) -> Result<()> {
    let (mut turned, mut doubtful) = (Found::with(unit), Found::with(unit));
    for i in 0..parts.meshes.len() {
        let opposed = Opposed::of(&parts.meshes[i]);
        turned.add(parts, i, &opposed.reversed);
        doubtful.add(parts, i, &opposed.doubtful);
        if !opposed.reversed.is_empty() {
            parts.meshes[i] = with_turned(std::mem::take(&mut parts.meshes[i]), &opposed.reversed)?;
        }
    }
    let text = |count, extent| {
        format!(
            "reversed winding of some triangles of the scan, flipped to match neighbours: {count} triangles, {extent}"
        )
    };
    turned.note(parts, text, warnings);
    let text = |count, extent| {
        format!(
            "parts of the scan face opposite ways, and it is unclear which is right: {count} triangles, {extent}; make \
             their winding consistent in a modelling program"
        )
    };
    doubtful.note(parts, text, warnings);
    Ok(())
}

/// Notes normals of the scan that point to the opposite side of their triangles.
pub(super) fn note_contradicting_normals(parts: &SceneData, unit: Option<Unit>, warnings: &mut Warnings) {
    let mut found = Found::with(unit);
    for (i, mesh) in parts.meshes.iter().enumerate().filter(|(_, mesh)| !mesh.normals().is_empty()) {
        let turned: Vec<u32> = turned(mesh).into_iter().map(|t| t as u32).collect();
        found.add(parts, i, &turned);
    }
    let Some(extent) = found.extent(parts).filter(|extent| extent.share > CONTRADICTED) else { return };
    let advice = match extent.share > 0.5 {
        true => "the scan is inside out, or its normals are: reverse one of them",
        false => "recompute its normals in a modelling program, or export it without",
    };
    let text = format!("normals of the scan contradict its triangles, by more than 90°: {extent}; {advice}");
    warnings.note(text, 1);
}

/// Returns the triangles that face away from the mean of their corners' normals.
pub(super) fn turned(mesh: &Mesh) -> Vec<usize> {
    parallel::filter(mesh.triangles().len(), |t| {
        let [a, b, c] = mesh.triangles()[t].map(|v| mesh.normals()[v as usize]);
        let [p, q, r] = mesh.corners(t).map(Vec3::to_f64);
        (q - p).cross(r - p).dot((a + b + c).to_f64()) < 0.0
    })
}

impl Found {
    fn with(unit: Option<Unit>) -> Self {
        Self { unit, ..Self::default() }
    }

    fn add(&mut self, parts: &SceneData, mesh: usize, triangles: &[u32]) {
        for m in if triangles.is_empty() { Vec::new() } else { placements(parts, mesh) } {
            self.triangles += triangles.len();
            let spot = |t: &u32| Spot::of_triangle(&parts.meshes[mesh], *t as usize, &m);
            self.spots.extend(triangles.iter().map(spot));
        }
    }

    fn extent(&self, parts: &SceneData) -> Option<Extent> {
        if self.spots.is_empty() { None } else { Extent::of(&self.spots, Whole::of(parts, self.unit)) }
    }

    fn note(&self, parts: &SceneData, text: impl Fn(usize, Extent) -> String, warnings: &mut Warnings) {
        if let Some(extent) = self.extent(parts) {
            warnings.note(text(self.triangles, extent), 1);
        }
    }
}

/// Returns a mesh with some of its triangles flipped. Normals that only they use and that would then contradict them
/// are negated too, along with the handedness of their tangents.
fn with_turned(mesh: Mesh, triangles: &[u32]) -> Result<Mesh> {
    let mut is_shared = vec![true; mesh.positions().len()];
    let mut data = mesh.into_data();
    for t in triangles {
        data.triangles[*t as usize].iter().for_each(|v| is_shared[*v as usize] = false);
        data.triangles[*t as usize].swap(1, 2);
    }
    let mut is_turned = vec![false; data.triangles.len()];
    triangles.iter().for_each(|t| is_turned[*t as usize] = true);
    let staying = data.triangles.iter().zip(&is_turned).filter(|(_, is_turned)| !**is_turned);
    staying.flat_map(|(triangle, _)| triangle).for_each(|v| is_shared[*v as usize] = true);
    for t in triangles {
        let corners = data.triangles[*t as usize];
        let facet = facet_normal(corners.map(|v| data.positions[v as usize]));
        for v in corners.map(|v| v as usize).into_iter().filter(|v| !is_shared[*v]) {
            let Some(normal) = data.normals.get_mut(v) else { break };
            if facet.is_some_and(|facet| facet.dot(*normal) < 0.0) {
                *normal = -*normal;
                if let Some(tangent) = data.tangents.get_mut(v) {
                    tangent[3] = -tangent[3];
                }
            }
        }
    }
    Mesh::new(data)
}
