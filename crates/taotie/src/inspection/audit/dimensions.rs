//! The size of the model against limits and against its product.

use super::check::{Check, CheckResult};
use super::product_info::{ProductDimensions, ProductInfo};
use super::range::AuditRange;
use super::schema::{DimensionSchema, DimensionsSchema};
use super::words::{number, rounded};
use crate::scene::Scene;

/// Dimensions are rounded to a micrometre.
const STEPS: f64 = 1e6;

/// A dimension of the model with its limits in the schema.
struct Dimension {
    name: &'static str,
    /// Metres.
    size: f64,
    schema: DimensionSchema,
}

/// Checks the dimensions of a scene.
pub(super) fn results(
    scene: &Scene,
    schema: &DimensionsSchema,
    product: Option<&ProductInfo>,
) -> Vec<CheckResult> {
    let checks = [Check::OverallDimensions, Check::ProductDimensions];
    let Some(all) = dimensions(scene, schema) else {
        return checks.map(|check| CheckResult::not_tested(check, "nothing is drawn")).into();
    };
    vec![overall(&all), of_product(&all, product)]
}

/// Returns length, width and height: the extents along x, z and y, as the auditor defines them.
fn dimensions(scene: &Scene, schema: &DimensionsSchema) -> Option<[Dimension; 3]> {
    let bounds = scene.bounds()?;
    let [x, y, z] = (bounds.max - bounds.min).to_array().map(|size| rounded(size, STEPS));
    Some([
        Dimension { name: "length", size: x, schema: schema.length },
        Dimension { name: "width", size: z, schema: schema.width },
        Dimension { name: "height", size: y, schema: schema.height },
    ])
}

fn overall(all: &[Dimension; 3]) -> CheckResult {
    let check = Check::OverallDimensions;
    let range = |dimension: &Dimension| {
        let DimensionSchema { minimum, maximum, .. } = dimension.schema;
        AuditRange { minimum, maximum }
    };
    let words = |dimension: &Dimension| match range(dimension) {
        range if range.is_limited() => format!("{} ({})", metres(dimension), range.words()),
        _ => metres(dimension),
    };
    let message = all.iter().map(words).collect::<Vec<_>>().join(", ");
    match all.iter().any(|dimension| range(dimension).is_limited()) {
        true => {
            let passes = all.iter().all(|dimension| range(dimension).allows(dimension.size));
            CheckResult::tested(check, passes, message)
        }
        false => CheckResult::not_tested(check, message),
    }
}

fn of_product(all: &[Dimension; 3], product: Option<&ProductInfo>) -> CheckResult {
    let check = Check::ProductDimensions;
    let Some(product) = product else {
        return CheckResult::not_tested(check, "no product info given");
    };
    let ProductDimensions { length, width, height } = product.dimensions;
    let pairs = all.iter().zip([length, width, height]);
    let compared = pairs.filter_map(|(dimension, wanted)| Some((dimension, wanted?)));
    let (mut passes, mut messages) = (true, Vec::new());
    for (dimension, wanted) in compared {
        let percent = dimension.schema.percent_tolerance.unwrap_or(0.0);
        let margin = wanted * percent / 100.0;
        passes &= (dimension.size - wanted).abs() <= margin + 0.5 / STEPS;
        messages.push(format!("{} ({} m ± {} %)", metres(dimension), number(wanted), number(percent)));
    }
    CheckResult::tested(check, passes, messages.join(", "))
}

fn metres(dimension: &Dimension) -> String {
    format!("{} {} m", dimension.name, number(dimension.size))
}
