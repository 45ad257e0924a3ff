//! The sizes of textures and the range of their base colours.

use super::check::{Check, CheckResult};
use super::range::AuditRange;
use super::schema::TextureSchema;
use super::words::{listed, rounded};
use crate::image::Bitmap;
use crate::image::Texels;
use crate::io::Loaded;
use crate::parallel;
use std::collections::BTreeSet;

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
