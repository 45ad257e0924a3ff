//! Physical lengths: units, lengths of a model as text, and texels as dots per inch.

use crate::names::Named;
use std::fmt;

/// A unit of length.
///
/// ```
/// use taotie_engine::length::Unit;
/// use taotie_engine::names::Named;
///
/// let unit = Unit::from_name("cm")?;
/// assert_eq!((unit, unit.metres()), (Unit::Centimetre, 0.01));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Unit {
    /// 0.001 m.
    #[serde(rename = "mm")]
    Millimetre,
    /// 0.01 m.
    #[serde(rename = "cm")]
    Centimetre,
    /// The unit of glTF.
    #[serde(rename = "m")]
    Metre,
    /// 0.0254 m.
    #[serde(rename = "in")]
    Inch,
}

impl Named for Unit {
    const WHAT: &'static str = "unit of length";
    const NAMES: &'static [(&'static str, Self)] =
        &[("mm", Self::Millimetre), ("cm", Self::Centimetre), ("m", Self::Metre), ("in", Self::Inch)];
}

/// Metres in an inch.
const INCH: f64 = 0.0254;

impl Unit {
    /// Returns the length of the unit in metres.
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Centimetre => 1e-2,
            Self::Metre => 1.0,
            Self::Inch => INCH,
        }
    }
}

/// The units that a limit may be written in, with their size in metres.
pub const OF_LIMITS: [(&str, f64); 7] = [
    ("um", 1e-6),
    // The micro sign, and the identical-looking Greek letter.
    ("\u{b5}m", 1e-6),
    ("\u{3bc}m", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("m", 1.0),
    ("in", INCH),
];

/// The display units of lengths, each with the length in metres below which it is used; the last covers all longer
/// ones.
const SHOWN: [(f64, &str, f64); 4] =
    [(1e-4, "µm", 1e-6), (0.1, "mm", 1e-3), (1.0, "cm", 1e-2), (f64::INFINITY, "m", 1.0)];

/// Returns the display unit of a length and its size in metres: µm below 0.1 mm, mm below 10 cm, cm below 1 m, else
/// m.
pub fn shown_unit(metres: f64) -> (&'static str, f64) {
    let size = metres.abs();
    let found = SHOWN.iter().find(|(below, _, _)| size < *below && size > 0.0);
    let (_, name, unit) = found.unwrap_or(if size == 0.0 { &SHOWN[1] } else { &SHOWN[3] });
    (name, *unit)
}

/// A length of a model for display: in µm, mm, cm or m by its size, or in model units if the model's unit is unknown.
///
/// ```
/// use taotie_engine::length::{ShownLength, Unit};
///
/// let shown = |length, unit| ShownLength::of(length, unit, 3).to_string();
/// assert_eq!(shown(0.4521, Some(Unit::Millimetre)), "0.452 mm");
/// assert_eq!(shown(0.000_051, Some(Unit::Metre)), "51.0 µm");
/// assert_eq!(shown(0.4521, None), "0.452 model units");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownLength {
    /// The number, rounded.
    pub value: f64,
    /// The number of decimals to write.
    pub decimals: usize,
    /// The unit's symbol.
    pub unit: &'static str,
}

impl ShownLength {
    /// Rounds a length of a model with coordinates in `unit` to significant digits; 0 digits count as 1.
    pub fn of(length: f64, unit: Option<Unit>, digits: u8) -> Self {
        let (metres, (name, size)) = match unit {
            Some(unit) => {
                let metres = length * unit.metres();
                // Rounding may carry into the next unit.
                (metres, shown_unit(rounded(metres, digits).0))
            }
            None => (length, ("model units", 1.0)),
        };
        let (value, decimals) = rounded(metres / size, digits);
        // Adding zero turns -0 into 0.
        Self { value: value + 0.0, decimals, unit: name }
    }
}

impl fmt::Display for ShownLength {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, decimals, unit } = self;
        write!(f, "{value:.decimals$} {unit}")
    }
}

/// Returns the resolution of a texture whose texels have this width on the surface, in dots per inch.
///
/// ```
/// use taotie_engine::length::{Unit, dpi};
///
/// assert_eq!(dpi(0.0254, Unit::Millimetre).round(), 1000.0);
/// ```
pub fn dpi(width: f64, unit: Unit) -> f64 {
    INCH / (width * unit.metres())
}

/// Returns the width of a texel on a surface as text, with dots per inch if the unit is known: `51.0 µm (498 dpi)`.
///
/// ```
/// use taotie_engine::length::{Unit, texel_text};
///
/// assert_eq!(texel_text(0.051, Some(Unit::Millimetre)), "51.0 µm (498 dpi)");
/// assert_eq!(texel_text(0.051, None), "0.0510 model units");
/// ```
pub fn texel_text(width: f64, unit: Option<Unit>) -> String {
    let shown = ShownLength::of(width, unit, 3);
    match unit {
        Some(unit) => {
            let (dots, decimals) = rounded(dpi(width, unit), 3);
            format!("{shown} ({dots:.decimals$} dpi)")
        }
        None => shown.to_string(),
    }
}

/// Returns a point of a model as text, to about a thousandth of the model's size, with the unit of its coordinates.
///
/// ```
/// use taotie_engine::length::{Unit, place_text};
///
/// let place = [12.3456, -0.0001, 7.0];
/// assert_eq!(place_text(place, 80.0, Some(Unit::Millimetre)), "(12.3, 0.0, 7.0) mm");
/// assert_eq!(place_text(place, 8.0, None), "(12.35, 0.00, 7.00)");
/// ```
pub fn place_text(place: [f64; 3], size: f64, unit: Option<Unit>) -> String {
    let decimals = (3 - digits_before_point(size)).clamp(0, 12) as usize;
    let [x, y, z] = place.map(|v| {
        let text = format!("{:.decimals$}", (v * 1e12).round() / 1e12);
        // Values that round to zero get no sign.
        if text.parse() == Ok(0.0) { format!("{:.decimals$}", 0.0) } else { text }
    });
    let unit = unit.map_or_else(String::new, |unit| format!(" {}", unit.name()));
    format!("({x}, {y}, {z}){unit}")
}

/// Returns the exponent of the smallest power of ten that is at least the size; sizes below a billionth count as
/// that.
fn digits_before_point(size: f64) -> i32 {
    let text = format!("{:e}", size.max(1e-9));
    let (mantissa, exponent) = text.split_once('e').unwrap_or(("1", "0"));
    exponent.parse().unwrap_or(0) + i32::from(mantissa != "1")
}

/// Formats a value with this number of significant digits, at least 1.
pub fn significant(value: f64, digits: u8) -> String {
    let (value, decimals) = rounded(value, digits);
    format!("{value:.decimals$}")
}

/// Returns a value rounded to significant digits, and the number of decimals that shows them.
fn rounded(value: f64, digits: u8) -> (f64, usize) {
    let digits = usize::from(digits.max(1));
    let text = format!("{value:.*e}", digits - 1);
    match text.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()) {
        Some(exponent) => {
            let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
            (text.parse().unwrap_or(value), decimals)
        }
        // Infinite, or NaN.
        None => (value, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metres(metres: f64, digits: u8) -> String {
        ShownLength::of(metres, Some(Unit::Metre), digits).to_string()
    }

    #[test]
    fn the_unit_follows_the_size() {
        assert_eq!(metres(3.21e-7, 2), "0.32 µm");
        assert_eq!(metres(5.1e-5, 2), "51 µm");
        assert_eq!(metres(2e-4, 2), "0.20 mm");
        assert_eq!(metres(1e-3, 2), "1.0 mm");
        assert_eq!(metres(0.0456, 3), "45.6 mm");
        assert_eq!(metres(0.1, 3), "10.0 cm");
        assert_eq!(metres(0.523, 3), "52.3 cm");
        assert_eq!(metres(-1.0, 3), "-1.00 m");
        assert_eq!(metres(1234.0, 2), "1200 m");
        assert_eq!(metres(0.0, 3), "0.00 mm");
        assert_eq!(ShownLength::of(-0.0, None, 3).to_string(), "0.00 model units");
    }

    #[test]
    fn rounding_carries_into_the_next_unit() {
        assert_eq!(metres(9.996e-5, 2), "0.10 mm");
        assert_eq!(metres(9.94e-5, 2), "99 µm");
        assert_eq!(metres(0.9999, 3), "1.00 m");
        assert_eq!(metres(0.99, 0), "1 m");
    }

    #[test]
    fn lengths_that_are_no_numbers_are_written_as_such() {
        assert_eq!(metres(f64::NAN, 3), "NaN m");
        assert_eq!(metres(f64::INFINITY, 3), "inf m");
    }

    #[test]
    fn units_have_names_and_metres() {
        let all: Vec<(&str, f64)> = Unit::NAMES.iter().map(|(name, unit)| (*name, unit.metres())).collect();
        assert_eq!(all, [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("in", 0.0254)]);
        assert!(Unit::from_name("ft").unwrap_err().to_string().contains("unit of length `ft`"));
        let of_limits = |name: &str| OF_LIMITS.iter().find(|(own, _)| *own == name).map(|(_, size)| *size);
        assert!(all.iter().all(|(name, size)| of_limits(name) == Some(*size)), "all are units of limits");
    }

    #[test]
    fn texels_become_dots_per_inch() {
        assert_eq!(texel_text(84.667e-6, Some(Unit::Metre)), "84.7 µm (300 dpi)");
        assert_eq!(texel_text(1.0, Some(Unit::Inch)), "25.4 mm (1.00 dpi)");
    }

    #[test]
    fn places_have_the_digits_of_the_models_size() {
        assert_eq!(place_text([1234.5678, -0.4, 0.0], 5000.0, None), "(1235, 0, 0)");
        assert_eq!(place_text([0.012_345, 0.0, 0.0], 0.05, Some(Unit::Metre)), "(0.0123, 0.0000, 0.0000) m");
    }
}
