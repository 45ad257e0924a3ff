//! The outcome of a requirement.

use super::figure::{Figure, FigureUnit};
use super::within;
use crate::length;
use std::borrow::Cow;

/// Returns the display unit of a length in metres.
pub(super) fn length_unit(metres: f64) -> FigureUnit {
    let (name, size) = length::shown_unit(metres);
    FigureUnit { name, size }
}

/// Returns the display unit of a figure and its limit: the figure's own, or a unit of length by the limit's size.
pub(super) fn shown_unit(figure: Figure, limit: f64, is_length: bool) -> FigureUnit {
    if is_length { length_unit(limit) } else { figure.unit() }
}

/// The outcome of a requirement at one level of detail, or for the whole asset.
///
/// ```
/// use taotie::asset::RequirementOutcome;
///
/// /// Returns a line for each requirement that is not met.
/// fn shortfalls(met: &[RequirementOutcome]) -> Vec<String> {
///     let line = |met: &RequirementOutcome| format!("{}: {}", met.name(), met.text());
///     met.iter().filter(|met| !met.met).map(line).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RequirementOutcome {
    /// The limited figure.
    pub figure: Figure,
    /// The limit: degrees, ΔE, a fraction of 1, pixels, or bytes; metres if `is_length`.
    pub most: f64,
    /// `true` if limit, value and interval are lengths in metres.
    #[cfg_attr(feature = "serde", serde(default))]
    pub is_length: bool,
    /// The level of detail, 0 the finest; `None` for a figure of the whole asset.
    pub level: Option<usize>,
    /// For figures that are the share of the surface within a limit: that limit, in degrees, ΔE, or as a fraction of
    /// the diagonal.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub within: Option<f64>,
    /// The figure's value; `None` if it could not be measured.
    pub value: Option<f64>,
    /// The bounds of the figure, with a confidence of 99 % if it is estimated from samples; equal if it is known
    /// exactly. `None` if it could not be measured.
    pub interval: Option<[f64; 2]>,
    /// `true` if the whole interval meets the limit.
    pub met: bool,
}

impl RequirementOutcome {
    /// Returns the name of the figure, like [`Requirement::name`](super::Requirement::name).
    pub fn name(&self) -> Cow<'static, str> {
        within::name_of(self.figure, self.within)
    }

    /// Returns the figure's title, including the limit if it is a share within one: `normal error, mean`, `surface
    /// within a normal error of 5°`.
    pub fn title(&self) -> Cow<'static, str> {
        within::title_of(self.figure, self.within)
    }

    /// Returns `true` if the limit lies within the interval, so that more samples may decide it.
    pub fn is_undecided(&self) -> bool {
        let Some([low, high]) = self.interval else { return false };
        !self.met && if self.figure.is_at_least() { high >= self.most } else { low <= self.most }
    }

    /// Returns the factor by which to increase the samples so that they are likely to decide the requirement, since
    /// intervals shrink with the square root of their number: at least 2, or 1 if it is decided.
    pub(super) fn samples_to_decide(&self) -> f64 {
        let (Some(value), Some([low, high]), true) = (self.value, self.interval, self.is_undecided()) else {
            return 1.0;
        };
        let ratio = (high - low) / 2.0 / (value - self.most).abs().max(f64::MIN_POSITIVE);
        (ratio * ratio).max(2.0)
    }

    /// Returns the display unit of value and limit: the figure's own, or a unit of length by the limit's size.
    pub fn unit(&self) -> FigureUnit {
        shown_unit(self.figure, self.most, self.is_length)
    }

    /// Returns value and limit in [`RequirementOutcome::unit`], such as `is 0.02 %, at most 0.1 %`. Both have all their digits if
    /// fewer would hide that the limit is exceeded.
    pub fn text(&self) -> String {
        let [value, limit] = self.value_and_limit();
        match (self.value, self.is_undecided()) {
            (None, _) => format!("could not be measured, {limit}"),
            (_, true) => format!("is undecided: {value}, {limit}"),
            _ => format!("is {value}, {limit}"),
        }
    }

    /// Returns name, value and limit for a list of several requirements, such as `missed 0.2 % (at most 0.1 %)`.
    pub(super) fn in_list(&self) -> String {
        let [value, limit] = self.value_and_limit();
        format!("{} {value} ({limit})", self.name())
    }

    /// Returns the value, or its bounds if the requirement is undecided, and the limit.
    fn value_and_limit(&self) -> [String; 2] {
        let (unit, most) = (self.unit(), self.most);
        let bound = if self.figure.is_at_least() { "at least" } else { "at most" };
        let (Some(value), Some(interval)) = (self.value, self.interval) else {
            return ["not measured".into(), format!("{bound} {}", unit.text(most))];
        };
        let [mut shown, mut limit] = [value, most].map(|number| unit.text(number));
        if self.is_undecided() {
            let [low, high] = interval.map(|number| unit.text(number));
            shown = format!("between {low} and {high}");
        } else if !self.met && shown == limit {
            [shown, limit] = [value, most].map(|number| unit.exact_text(number));
        }
        [shown, format!("{bound} {limit}")]
    }
}
