//! Figures that are the share of the surface within a limit: their names include the limit, as in `within-5deg`.

use super::figure::{Figure, split};
use crate::names::Named;
use std::borrow::Cow;

/// The prefix of their names.
const WITHIN: &str = "within-";

/// Returns the name of a figure, including the limit if it is a share within one.
pub(super) fn name_of(figure: Figure, limit: Option<f64>) -> Cow<'static, str> {
    match (figure.units_within(), limit) {
        (Some(units), Some(limit)) => format!("{WITHIN}{}{}", units[0].shortest(limit), units[0].name).into(),
        _ => figure.name().into(),
    }
}

/// Returns the title of a figure, including the limit if it is a share within one.
pub(super) fn title_of(figure: Figure, limit: Option<f64>) -> Cow<'static, str> {
    match (figure.units_within(), limit) {
        (Some(units), Some(limit)) => {
            // The printed symbol, rather than the typed one.
            let unit = units.iter().find(|unit| !unit.name.is_ascii()).unwrap_or(&units[0]);
            let of = if unit.name == "%" { " of the diagonal" } else { "" };
            format!("{} of {}{of}", figure.title(), unit.text(limit)).into()
        }
        _ => figure.title().into(),
    }
}

/// Parses a name with a limit, such as `within-5deg`, `within-3dE` or `within-0.5%`; `None` for names of other
/// figures.
pub(super) fn read(name: &str) -> Option<Result<(Figure, f64), String>> {
    Some(limit(name.strip_prefix(WITHIN)?.trim()))
}

fn limit(text: &str) -> Result<(Figure, f64), String> {
    let (number, unit) = split(text);
    let of = |figure: Figure| Some((figure, figure.units_within()?.iter().find(|u| u.name == unit)?.size));
    let found = [Figure::WithinAngle, Figure::WithinColor, Figure::WithinDistance].into_iter().find_map(of);
    let limit: Option<f64> = number.parse().ok().filter(|limit: &f64| limit.is_finite() && *limit >= 0.0);
    let why = || "expected a limit in deg, dE or % of the diagonal, e.g. within-5deg=99%".to_owned();
    let (figure, size) = found.ok_or_else(why)?;
    Ok((figure, limit.ok_or_else(why)? * size))
}
