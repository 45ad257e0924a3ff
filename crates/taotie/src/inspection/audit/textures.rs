//! Checks of textures: their sizes, the range of their base colours, and their texel density, the number of texels
//! per metre of the surface.

use super::check::{AuditRange, Check, CheckResult, rounded};
use super::schema::TextureSchema;
use std::collections::{BTreeMap, BTreeSet};
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::Vec2;
use taotie_engine::parallel;
use taotie_engine::scene::{Instance, Scene};
use taotie_io::{Loaded, listed};

const NO_TEXTURES: &str = "no textures";

/// Checks the textures that materials use.
pub(super) fn results(loaded: &Loaded, schema: &TextureSchema) -> Vec<CheckResult> {
    let images = Images { loaded };
    let (height, width) = (schema.height, schema.width);
    let mut results: Vec<CheckResult> = base_colors(&images, schema.pbr_color_range);
    results.extend([
        images.sides(Check::TextureHeightMaximum, |image| image[1], AuditRange::at_most(height.maximum)),
        images.sides(Check::TextureHeightMinimum, |image| image[1], AuditRange::at_least(height.minimum)),
        images.sides(Check::TextureWidthMaximum, |image| image[0], AuditRange::at_most(width.maximum)),
        images.sides(Check::TextureWidthMinimum, |image| image[0], AuditRange::at_least(width.minimum)),
    ]);
    let powers = (Check::PowerOfTwoTextures, "powers of two", schema.require_dimensions_be_powers_of_two);
    results.push(images.all(powers, |size| size.iter().all(|side| side.is_power_of_two())));
    let square = (Check::SquareTextures, "square", schema.require_dimensions_be_quadratic);
    results.push(images.all(square, |[width, height]| width == height));
    results
}

/// The images that materials use.
struct Images<'a> {
    loaded: &'a Loaded,
}

impl Images<'_> {
    /// Returns the name and size of each image; an image stored for two uses is listed twice.
    fn sizes(&self) -> impl Iterator<Item = (String, [u32; 2])> + '_ {
        let textures = self.loaded.scene.textures().iter().enumerate();
        textures.map(|(index, texture)| (self.name(index), [texture.width(), texture.height()]))
    }

    fn name(&self, index: usize) -> String {
        self.loaded.texture_names.get(index).cloned().unwrap_or_else(|| format!("texture {index}"))
    }

    /// Compares a side of each image with its limit.
    fn sides(&self, check: Check, side: fn([u32; 2]) -> u32, range: AuditRange) -> CheckResult {
        let sides = self.sizes().map(|(_, size)| f64::from(side(size)));
        let extreme = if range.minimum.is_some() || is_minimum(check) { f64::min } else { f64::max };
        let Some(value) = sides.reduce(extreme) else { return CheckResult::not_tested(check, NO_TEXTURES) };
        let wrong = self.sizes().filter(|(_, size)| !range.allows(f64::from(side(*size))));
        let result = CheckResult::of_value(check, (value, ""), range);
        with_names(result, wrong.map(|(name, _)| name).collect())
    }

    /// Checks that the size of each image is as required.
    fn all(&self, (check, wanted, required): (Check, &str, bool), is: fn([u32; 2]) -> bool) -> CheckResult {
        if self.loaded.scene.textures().is_empty() {
            return CheckResult::not_tested(check, NO_TEXTURES);
        }
        let wrong: BTreeSet<String> = self
            .sizes()
            .filter(|(_, size)| !is(*size))
            .map(|(name, [width, height])| format!("{name} {width}×{height}"))
            .collect();
        let wrong = Vec::from_iter(wrong);
        let message = match wrong.is_empty() {
            true => format!("all are {wanted}"),
            false => format!("not {wanted}: {}", listed(&wrong)),
        };
        match required {
            true => CheckResult::of_faults(check, wrong.len(), message),
            false => CheckResult::not_tested(check, message),
        }
    }
}

fn is_minimum(check: Check) -> bool {
    matches!(check, Check::TextureHeightMinimum | Check::TextureWidthMinimum)
}

/// Returns a result whose message lists the images that fail.
fn with_names(result: CheckResult, wrong: BTreeSet<String>) -> CheckResult {
    if wrong.is_empty() {
        return result;
    }
    let message = format!("{}: {}", result.message, listed(&Vec::from_iter(wrong)));
    CheckResult { message, ..result }
}

/// Checks the brightest and the darkest texel of base colour images, by the maximum of red, green and blue in steps
/// of 1/255: V of HSV. Every texel counts, used by uvs or not and whatever its alpha.
fn base_colors(images: &Images<'_>, range: AuditRange) -> Vec<CheckResult> {
    let (most, least) = (Check::PbrColorMaximum, Check::PbrColorMinimum);
    let materials = images.loaded.scene.materials().iter();
    let used: BTreeSet<usize> =
        materials.filter_map(|material| Some(material.base_color_texture?.texture)).collect();
    if used.is_empty() {
        return [most, least].map(|check| CheckResult::not_tested(check, "no base colour textures")).into();
    }
    let textures = images.loaded.scene.textures();
    let values: Vec<(String, Values)> =
        used.iter().map(|index| (images.name(*index), Values::of(textures[*index].bitmap()))).collect();
    let extreme = |check, of: fn(&Values) -> f64, range: AuditRange, pick: fn(f64, f64) -> f64| {
        let value = values.iter().map(|(_, values)| of(values)).reduce(pick).unwrap_or(0.0);
        let wrong = values.iter().filter(|(_, values)| !range.allows(of(values)));
        let result = CheckResult::of_value(check, (value, " of 255"), range);
        with_names(result, wrong.map(|(name, _)| name.clone()).collect())
    };
    vec![
        extreme(most, |values| values.greatest(), AuditRange::at_most(range.maximum), f64::max),
        extreme(least, |values| values.least(), AuditRange::at_least(range.minimum), f64::min),
    ]
}

/// The minimum and maximum V of HSV of an image, 1 being the maximum of an integer type.
struct Values {
    least: f32,
    greatest: f32,
}

impl Default for Values {
    fn default() -> Self {
        Self { least: f32::INFINITY, greatest: f32::NEG_INFINITY }
    }
}

impl Values {
    fn of(bitmap: &Bitmap) -> Self {
        let value = |i: usize| match bitmap.texels() {
            Texels::U8(texels) => {
                let [r, g, b, _] = texels[i];
                f32::from(r.max(g).max(b)) / 255.0
            }
            _ => {
                let [r, g, b, _] = bitmap.stored(i);
                r.max(g).max(b)
            }
        };
        let parts = parallel::fold(bitmap.texels().len(), |sum: &mut Self, i| sum.take(value(i), value(i)));
        let mut all = Self::default();
        parts.into_iter().for_each(|part| all.take(part.least, part.greatest));
        all
    }

    fn take(&mut self, least: f32, greatest: f32) {
        self.least = self.least.min(least);
        self.greatest = self.greatest.max(greatest);
    }

    fn least(&self) -> f64 {
        steps(self.least)
    }

    fn greatest(&self) -> f64 {
        steps(self.greatest)
    }
}

/// Returns a value in steps of 1/255, to a thousandth of a step.
fn steps(value: f32) -> f64 {
    rounded(f64::from(value) * 255.0, 1e3)
}

/// Densities are rounded to a thousandth of a pixel per metre.
const DENSITY_STEPS: f64 = 1e3;

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
pub(super) fn texel_density(scene: &Scene, range: AuditRange) -> Vec<CheckResult> {
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
    let value = |texels: f64| (rounded(texels.sqrt(), DENSITY_STEPS), " px/m");
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
        let ratio = (q - p).cross(r - p).abs() / area;
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
