//! Texel density: the number of texels per metre of the surface.

use super::check::{Check, CheckResult};
use super::range::AuditRange;
use super::words::rounded;
use crate::math::Vec2;
use crate::parallel;
use crate::scene::{Instance, Scene};
use std::collections::BTreeMap;

/// Densities are rounded to a thousandth of a pixel per metre.
const STEPS: f64 = 1e3;

/// The minimum and maximum of some numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extremes {
    least: f64,
    greatest: f64,
}

impl Default for Extremes {
    fn default() -> Self {
        Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY }
    }
}

impl Extremes {
    fn take(&mut self, least: f64, greatest: f64) {
        self.least = self.least.min(least);
        self.greatest = self.greatest.max(greatest);
    }
}

/// Checks the texel density of all triangles in world space, in pixels per metre: the square root of texels per area.
/// Each triangle counts with the largest and the smallest texture of its material. Triangles without area are
/// ignored.
pub(super) fn results(scene: &Scene, range: AuditRange) -> Vec<CheckResult> {
    let (most, least) = (Check::TexelDensityMaximum, Check::TexelDensityMinimum);
    let mut all = Extremes::default();
    for instance in scene.instances() {
        for (uv_set, texels) in texels_by_uv_set(scene, instance) {
            let ratios = uv_over_area(scene, instance, uv_set);
            if ratios.greatest >= ratios.least {
                all.take(ratios.least * texels.least, ratios.greatest * texels.greatest);
            }
        }
    }
    if all.greatest < all.least {
        return [most, least].map(|check| CheckResult::not_tested(check, "no textured triangles")).into();
    }
    let value = |texels: f64| (rounded(texels.sqrt(), STEPS), " px/m");
    vec![
        CheckResult::of_value(most, value(all.greatest), AuditRange::at_most(range.maximum)),
        CheckResult::of_value(least, value(all.least), AuditRange::at_least(range.minimum)),
    ]
}

/// Returns the minimum and maximum number of texels per unit square of each uv set used by the material's textures.
fn texels_by_uv_set(scene: &Scene, instance: &Instance) -> BTreeMap<usize, Extremes> {
    let mut all = BTreeMap::<usize, Extremes>::new();
    for used in scene.materials()[instance.material].textures() {
        let texture = &scene.textures()[used.texture];
        let [[a, b], [c, d]] = used.transform.linear.map(|row| row.map(f64::from));
        let texels = f64::from(texture.width()) * f64::from(texture.height()) * (a * d - b * c).abs();
        all.entry(used.uv_set).or_default().take(texels, texels);
    }
    all
}

/// Returns the minimum and maximum ratio of the area in uv to that in the world, over the triangles of an instance.
fn uv_over_area(scene: &Scene, instance: &Instance, uv_set: usize) -> Extremes {
    let mesh = &scene.meshes()[instance.mesh];
    let Some(uvs) = mesh.uvs().get(uv_set) else { return Extremes::default() };
    let parts = parallel::fold(mesh.triangles().len(), |sum: &mut Extremes, triangle| {
        let [a, b, c] =
            mesh.corners(triangle).map(|p| instance.world_from_object.transform_point(p.to_f64()));
        let area = (b - a).cross(c - a).length();
        let [p, q, r] = mesh.triangles()[triangle].map(|i| wide(uvs[i as usize]));
        let (e, f) = (q - p, r - p);
        let ratio = (e.x * f.y - e.y * f.x).abs() / area;
        if ratio.is_finite() {
            sum.take(ratio, ratio);
        }
    });
    let mut all = Extremes::default();
    parts.into_iter().for_each(|part| all.take(part.least, part.greatest));
    all
}

fn wide(uv: Vec2) -> Vec2<f64> {
    Vec2::new(f64::from(uv.x), f64::from(uv.y))
}
