//! The normals of a scan whose file has none, or one per facet: smooth, with the hard edges of modelled shapes.

use super::extent::{Extent, Spot, Whole};
use super::scan_options::ScanOptions;
use crate::error::{Result, Warnings};
use crate::math::{Mat4, Vec3, scalar};
use crate::mesh::{Mesh, MeshData, with_flat_normals};
use crate::scene::{NormalSpace, Scene, SceneData};
use crate::surface::{Bends, MODELLED_CREASE_DEG, looks_scanned};

/// The changes made to the meshes of a scan.
#[derive(Default)]
struct Outcome {
    /// Meshes that had one normal per facet and are now smooth everywhere.
    smoothed: usize,
    /// Meshes to which the crease angle applied.
    affected: usize,
    /// The number of hard edges.
    hard: usize,
    /// The midpoints of the hard edges, by length.
    spots: Vec<Spot>,
    /// The length of all edges of the meshes that have hard ones.
    length: f64,
}

/// Computes normals of meshes that have none or one per facet, wherever they split at hard edges; elsewhere they are
/// removed, so that smooth ones are computed. Meshes with a tangent-space normal map keep theirs: the map is relative
/// to them. All changes are noted.
///
/// # Errors
/// Those of [`ScanOptions::check`].
pub(super) fn compute(parts: &mut SceneData, options: &ScanOptions, warnings: &mut Warnings) -> Result<()> {
    options.check()?;
    let is_mapped = mapped(parts);
    let mut outcome = Outcome::default();
    for (i, is_mapped) in is_mapped.into_iter().enumerate() {
        let mesh = &parts.meshes[i];
        let has_facets = is_faceted(mesh);
        if mesh.triangles().is_empty() || is_mapped || !(mesh.normals().is_empty() || has_facets) {
            continue;
        }
        outcome.affected += 1;
        let placed = placements(parts, i);
        let mesh = std::mem::take(&mut parts.meshes[i]);
        parts.meshes[i] = match options.crease_angle_deg {
            Some(angle) if angle <= 0.0 && has_facets => mesh,
            Some(angle) if angle <= 0.0 => Mesh::new(with_flat_normals(&mesh.into_data()))?,
            _ => outcome.with_normals(mesh, &placed, options)?,
        };
        outcome.smoothed += usize::from(has_facets && parts.meshes[i].normals().is_empty());
    }
    outcome.note(options, parts, warnings);
    Ok(())
}

/// Returns the transform of each instance of a mesh.
pub(super) fn placements(parts: &SceneData, mesh: usize) -> Vec<Mat4> {
    let shown = parts.instances.iter().filter(|instance| instance.mesh == mesh);
    shown.map(|instance| instance.world_from_object).collect()
}

/// Returns for each mesh whether it has a tangent-space normal map.
fn mapped(parts: &SceneData) -> Vec<bool> {
    let mut is_mapped = vec![false; parts.meshes.len()];
    for instance in &parts.instances {
        let normal = parts.materials[instance.material].normal;
        is_mapped[instance.mesh] |= normal.is_some_and(|map| map.space == NormalSpace::Tangent);
    }
    is_mapped
}

impl Outcome {
    /// Returns a mesh with normals split at its hard edges; without normals if it has none.
    fn with_normals(&mut self, mesh: Mesh, placed: &[Mat4], options: &ScanOptions) -> Result<Mesh> {
        let smooth = |mesh: Mesh| {
            Mesh::new(MeshData { normals: Vec::new(), tangents: Vec::new(), ..mesh.into_data() })
        };
        if options.crease_angle_deg.is_none() && looks_scanned(&mesh)? {
            return smooth(mesh);
        }
        let bends = Bends::of(&mesh);
        let crease = options.crease_angle_deg.unwrap_or(MODELLED_CREASE_DEG).to_radians();
        let hard = match options.crease_angle_deg {
            Some(_) => bends.sharper_than(crease),
            None => bends.modelled(),
        };
        if hard.is_empty() {
            return smooth(mesh);
        }
        let total = bends.total_length();
        for m in placed {
            let scale = scalar::cbrt(m.determinant3().abs());
            self.length += scale * total;
            self.hard += hard.len();
            self.spots.extend(hard.iter().map(|edge| {
                let [a, b] = bends.ends(*edge);
                Spot { at: m.transform_point((a + b) * 0.5), amount: scale * bends.length(*edge) }
            }));
        }
        bends.split_at(&hard, crease)
    }

    fn note(&self, options: &ScanOptions, parts: &SceneData, warnings: &mut Warnings) {
        if options.crease_angle_deg.is_some() && self.affected == 0 {
            warnings.note("the crease angle has no effect: the scan has its own normals, which are kept", 1);
        }
        let smoothed =
            "flat-shaded scan: smooth normals computed; a crease angle keeps edges hard, 0 all facets";
        warnings.note(smoothed, self.smoothed);
        if self.spots.is_empty() {
            return;
        }
        let whole = Whole { amount: self.length, ..Whole::of(parts, options.unit) };
        let Some(extent) = Extent::of(&self.spots, whole) else { return };
        let crease = options.crease_angle_deg.unwrap_or(MODELLED_CREASE_DEG);
        let advice = match options.crease_angle_deg {
            Some(_) => "",
            None => "; set a crease angle of 180 to smooth all of them, or 0 to keep all facets",
        };
        let text = format!(
            "scan without smooth normals: smoothed below {crease}°, {} hard edges kept ({} of the length of its edges, most \
             of it around {}){advice}",
            self.hard,
            extent.percent(),
            extent.place()
        );
        warnings.note(text, 1);
    }
}

/// Returns the maximum number of vertices that computing normals may add to a scene as read, over all instances.
pub(super) fn added_vertices(scene: &Scene, options: &ScanOptions) -> u64 {
    /// The crease angle below which most vertices of a scan are split, degrees.
    const SPLITTING: f64 = 20.0;
    if options.crease_angle_deg.is_none_or(|angle| angle > SPLITTING) {
        return 0;
    }
    let added = |mesh: &Mesh| (3 * mesh.triangles().len()).saturating_sub(mesh.positions().len()) as u64;
    let meshes = scene.instances().iter().map(|instance| &scene.meshes()[instance.mesh]);
    meshes.filter(|mesh| mesh.normals().is_empty()).map(added).sum()
}

/// Returns `true` if the triangles of a mesh share nothing and each has one normal.
fn is_faceted(mesh: &Mesh) -> bool {
    let is_alone = |(t, triangle): (usize, &[u32; 3])| *triangle == [0, 1, 2].map(|i| 3 * t as u32 + i);
    let is_flat = |normals: &[Vec3]| normals[0] == normals[1] && normals[1] == normals[2];
    !mesh.normals().is_empty()
        && mesh.triangles().iter().enumerate().all(is_alone)
        && mesh.normals().chunks_exact(3).all(is_flat)
}
