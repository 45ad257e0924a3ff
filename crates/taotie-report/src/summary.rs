//! Mean, quantiles and maximum as text.

use taotie_engine::compare::Summary;

/// Returns the mean, median, 95th percentile and maximum, in the order of table columns.
pub fn figures(summary: &Summary) -> [f64; 4] {
    [summary.mean, summary.median, summary.p95, summary.max]
}

/// Formats all statistics with `digits` decimals, each with its unit.
///
/// ```
/// use taotie_engine::compare::Field;
/// use taotie_report::summary;
///
/// let angles = Field::new(2, 1, vec![1.0, 2.0])?.summary().expect("two numbers");
/// let text = summary::text(&angles, 1, "°");
/// assert_eq!(text, "mean 1.5°, median 1.5°, quartiles 1.2° and 1.8°, p95 1.9°, max 2.0°");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
pub fn text(summary: &Summary, digits: usize, unit: &str) -> String {
    let number = |value: f64| format!("{value:.digits$}{unit}");
    let [mean, median, p95, max] = figures(summary).map(number);
    let [first, third] = summary.quartiles.map(number);
    format!("mean {mean}, median {median}, quartiles {first} and {third}, p95 {p95}, max {max}")
}
