//! The range and the orientation of uvs.

use super::check::{Check, CheckResult};
use super::gutter;
use super::overlap;
use super::schema::UvSchema;
use super::words::counted;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::parallel;
use crate::scene::Scene;

/// The extent of uvs and the triangles that are mirrored.
struct Uvs {
    least: [f32; 2],
    greatest: [f32; 2],
    inverted: usize,
}

impl Default for Uvs {
    fn default() -> Self {
        Self { least: [f32::INFINITY; 2], greatest: [f32::NEG_INFINITY; 2], inverted: 0 }
    }
}

/// Checks uv set 0 of all meshes.
///
/// # Errors
/// As [`overlap::result`] and [`gutter::result`].
pub(super) fn results(scene: &Scene, schema: &UvSchema) -> Result<Vec<CheckResult>> {
    let is_mapped = |mesh: &&Mesh| !mesh.uvs().is_empty() && !mesh.triangles().is_empty();
    let meshes: Vec<&Mesh> = scene.meshes().iter().filter(is_mapped).collect();
    let checks = [Check::UvRange, Check::InvertedUvs, Check::OverlappingUvs, Check::GutterWidth];
    if meshes.is_empty() {
        return Ok(checks.map(|check| CheckResult::not_tested(check, "no uvs")).into());
    }
    let mut uvs = Uvs::default();
    meshes.iter().for_each(|mesh| uvs.add(&Uvs::of(mesh)));
    Ok(vec![
        uvs.range(schema.require_range_zero_to_one),
        uvs.inverted(schema.require_not_inverted),
        overlap::result(&meshes, schema.require_not_overlapping)?,
        gutter::result(&meshes, schema.gutter_width.widest())?,
    ])
}

impl Uvs {
    fn of(mesh: &Mesh) -> Self {
        let uvs = &mesh.uvs()[0];
        let parts = parallel::fold(mesh.triangles().len(), |sum: &mut Self, triangle| {
            let corners = mesh.triangles()[triangle].map(|i| [uvs[i as usize].x, uvs[i as usize].y]);
            corners.iter().for_each(|uv| sum.take(*uv));
            let [a, b, c] = corners.map(|uv| uv.map(f64::from));
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            // Rows count from the top of the image, so counter-clockwise triangles have a negative area there.
            sum.inverted += usize::from(area > 0.0);
        });
        let mut all = Self::default();
        parts.iter().for_each(|part| all.add(part));
        all
    }

    fn take(&mut self, uv: [f32; 2]) {
        for (axis, v) in uv.into_iter().enumerate() {
            self.least[axis] = self.least[axis].min(v);
            self.greatest[axis] = self.greatest[axis].max(v);
        }
    }

    fn add(&mut self, other: &Self) {
        self.take(other.least);
        self.take(other.greatest);
        self.inverted += other.inverted;
    }

    fn range(&self, required: bool) -> CheckResult {
        let ([u0, v0], [u1, v1]) = (self.least, self.greatest);
        let message = format!("u {u0} to {u1}, v {v0} to {v1} (0 to 1)");
        let is_within = self.least.iter().all(|v| *v >= 0.0) && self.greatest.iter().all(|v| *v <= 1.0);
        match required {
            true => CheckResult::tested(Check::UvRange, is_within, message),
            false => CheckResult::not_tested(Check::UvRange, message),
        }
    }

    fn inverted(&self, required: bool) -> CheckResult {
        let message = format!("{} mirrored in uv (at most 0)", counted(self.inverted, "triangle"));
        match required {
            true => CheckResult::of_faults(Check::InvertedUvs, self.inverted, message),
            false => CheckResult::not_tested(Check::InvertedUvs, message),
        }
    }
}
