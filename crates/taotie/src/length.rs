//! Physical lengths: units, their text with as many digits as are known, limits, and texels as dots per inch.

use crate::error::{Error, Result};
use crate::names::Named;
use std::fmt;
use std::str::FromStr;

/// A unit of length.
///
/// ```
/// use taotie::length::Unit;
/// use taotie::names::Named;
///
/// let unit = Unit::from_name("cm")?;
/// assert_eq!((unit, unit.metres()), (Unit::Centimetre, 0.01));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Unit {
    /// 0.001 m.
    #[cfg_attr(feature = "serde", serde(rename = "mm"))]
    Millimetre,
    /// 0.01 m.
    #[cfg_attr(feature = "serde", serde(rename = "cm"))]
    Centimetre,
    /// The unit of glTF.
    #[default]
    #[cfg_attr(feature = "serde", serde(rename = "m"))]
    Metre,
    /// 0.0254 m.
    #[cfg_attr(feature = "serde", serde(rename = "in"))]
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

    /// Returns a length in this unit as text, such as `12.3 mm`.
    ///
    /// ```
    /// use taotie::length::{Precision, Unit};
    ///
    /// assert_eq!(Unit::Millimetre.format(0.5, Precision::Digits(3)), "500 mm");
    /// assert_eq!(Unit::Inch.format(0.0254, Precision::Uncertainty(0.0001)), "1.000 in");
    /// ```
    pub fn format(self, metres: f64, precision: Precision) -> String {
        Scale { metres: self.metres(), name: self.name() }.format(metres, precision)
    }
}

/// The digits that a length is written with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Precision {
    /// This many significant digits, at least 1; 0 is taken as 1.
    Digits(u8),
    /// The digits down to the first one of an uncertainty in metres. One that is 0, negative or not finite says nothing:
    /// the length then has six digits.
    Uncertainty(f64),
}

/// The significant digits of a length of unknown uncertainty.
const USUAL_DIGITS: u8 = 6;

/// Returns a length as text in µm, mm, cm or m: the unit follows from the size.
///
/// ```
/// use taotie::length::{Precision, format_length};
///
/// assert_eq!(format_length(0.000_051_3, Precision::Digits(2)), "51 µm");
/// assert_eq!(format_length(0.012_345_6, Precision::Uncertainty(0.000_02)), "12.35 mm");
/// assert_eq!(format_length(1.8, Precision::Digits(3)), "1.80 m");
/// ```
pub fn format_length(metres: f64, precision: Precision) -> String {
    // What is uncertain by a millimetre is not written in µm, however short it is.
    let size = match precision.checked() {
        Precision::Digits(digits) => rounded_to_digits(metres, digits).0.abs(),
        Precision::Uncertainty(uncertainty) => metres.abs().max(uncertainty),
    };
    let scale = SCALES.iter().find(|(below, _)| size < *below).map_or(METRES, |(_, scale)| *scale);
    let scale = if size == 0.0 { MILLIMETRES } else { scale };
    scale.format(metres, precision)
}

/// Returns the resolution of a texture whose texels have this side on the surface, in dots per inch.
///
/// ```
/// assert_eq!(taotie::length::dpi(0.000_0254), 1000.0);
/// ```
pub fn dpi(texel_metres: f64) -> f64 {
    INCH / texel_metres
}

/// A limit of a length, such as `0.2mm`, `50um` or `50µm`, or of its ratio to the size of an object, such as `0.4%`.
///
/// ```
/// use taotie::length::LengthLimit;
///
/// let limit: LengthLimit = "0.4%".parse()?;
/// assert_eq!(limit.metres(2.0), 0.008);
/// assert_eq!("50um".parse::<LengthLimit>()?, LengthLimit::Metres(50.0 * 1e-6));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LengthLimit {
    /// A length, at least 0.
    Metres(f64),
    /// A part of the size of an object, at least 0: 0.01 is one per cent.
    Fraction(f64),
}

impl LengthLimit {
    /// Returns the limit in metres for an object of this size in metres.
    pub fn metres(self, size: f64) -> f64 {
        match self {
            Self::Metres(metres) => metres,
            Self::Fraction(fraction) => fraction * size,
        }
    }
}

impl FromStr for LengthLimit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let invalid = || {
            let why =
                "use a number of at least 0 with a unit (um, mm, cm, m or in) or %, e.g. 0.2mm, 50um or 0.4%";
            Error::invalid(format!("invalid length `{text}`"), why)
        };
        let trimmed = text.trim();
        let ending = UNITS.iter().find(|(name, _)| trimmed.ends_with(name));
        let (name, unit) = ending.ok_or_else(invalid)?;
        let number: f64 = trimmed[..trimmed.len() - name.len()].trim_end().parse().map_err(|_| invalid())?;
        if !(number.is_finite() && number >= 0.0) {
            return Err(invalid());
        }
        Ok(match unit {
            Some(metres) => Self::Metres(number * metres),
            None => Self::Fraction(number / 100.0),
        })
    }
}

/// The endings of limits with their metres, longer ones before those they end in; `None` is per cent.
const UNITS: [(&str, Option<f64>); 8] = [
    ("%", None),
    ("um", Some(1e-6)),
    // The micro sign, and the Greek letter that looks like it.
    ("\u{b5}m", Some(1e-6)),
    ("\u{3bc}m", Some(1e-6)),
    ("mm", Some(1e-3)),
    ("cm", Some(1e-2)),
    ("in", Some(INCH)),
    ("m", Some(1.0)),
];

impl fmt::Display for LengthLimit {
    /// Writes the limit with at most six digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Metres(metres) => format_length(*metres, Precision::Digits(USUAL_DIGITS)),
            Self::Fraction(fraction) => {
                let (percent, decimals) = rounded_to_digits(fraction * 100.0, USUAL_DIGITS);
                format!("{percent:.decimals$} %")
            }
        };
        let (number, unit) = text.split_once(' ').unwrap_or((&text, ""));
        let short = match number.contains('.') {
            true => number.trim_end_matches('0').trim_end_matches('.'),
            false => number,
        };
        write!(f, "{short} {unit}")
    }
}

/// A unit that lengths are written in.
#[derive(Clone, Copy)]
struct Scale {
    metres: f64,
    name: &'static str,
}

const MICROMETRES: Scale = Scale { metres: 1e-6, name: "µm" };
const MILLIMETRES: Scale = Scale { metres: 1e-3, name: "mm" };
const CENTIMETRES: Scale = Scale { metres: 1e-2, name: "cm" };
const METRES: Scale = Scale { metres: 1.0, name: "m" };

/// The units of lengths below a number of metres.
const SCALES: [(f64, Scale); 3] = [(1e-3, MICROMETRES), (0.1, MILLIMETRES), (1.0, CENTIMETRES)];

impl Scale {
    fn format(self, metres: f64, precision: Precision) -> String {
        let value = metres / self.metres;
        let (value, decimals) = match precision.checked() {
            Precision::Digits(digits) => rounded_to_digits(value, digits),
            Precision::Uncertainty(uncertainty) => rounded_to_place(value, place(uncertainty / self.metres)),
        };
        // Adding zero turns -0 into 0.
        format!("{:.decimals$} {}", value + 0.0, self.name)
    }
}

impl Precision {
    /// Returns a precision that says something.
    fn checked(self) -> Self {
        match self {
            Self::Digits(digits) => Self::Digits(digits.max(1)),
            Self::Uncertainty(uncertainty) if uncertainty > 0.0 && uncertainty.is_finite() => self,
            Self::Uncertainty(_) => Self::Digits(USUAL_DIGITS),
        }
    }
}

/// Returns a value rounded to significant digits, and the number of decimals that shows them.
fn rounded_to_digits(value: f64, digits: u8) -> (f64, usize) {
    let digits = usize::from(digits);
    let text = format!("{value:.*e}", digits - 1);
    match text.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()) {
        Some(exponent) => {
            let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
            (text.parse().unwrap_or(value), decimals)
        }
        // Infinite, or not a number.
        None => (value, 0),
    }
}

/// Returns the power of ten of an uncertainty's first digit.
fn place(uncertainty: f64) -> i32 {
    let text = format!("{uncertainty:.0e}");
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// Returns a value rounded to a power of ten, and the number of decimals that shows it.
fn rounded_to_place(value: f64, place: i32) -> (f64, usize) {
    match usize::try_from(-place) {
        // Printing rounds.
        Ok(decimals) => {
            let text = format!("{value:.decimals$}");
            (text.parse().unwrap_or(value), decimals)
        }
        Err(_) => {
            let power: f64 = format!("1e{place}").parse().unwrap_or(1.0);
            ((value / power).round() * power, 0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digits(metres: f64, digits: u8) -> String {
        format_length(metres, Precision::Digits(digits))
    }

    fn within(metres: f64, uncertainty: f64) -> String {
        format_length(metres, Precision::Uncertainty(uncertainty))
    }

    #[test]
    fn the_unit_follows_the_size() {
        assert_eq!(digits(3.21e-7, 2), "0.32 µm");
        assert_eq!(digits(2e-4, 2), "200 µm");
        assert_eq!(digits(1e-3, 2), "1.0 mm");
        assert_eq!(digits(0.0456, 3), "45.6 mm");
        assert_eq!(digits(0.1, 3), "10.0 cm");
        assert_eq!(digits(0.523, 3), "52.3 cm");
        assert_eq!(digits(-1.0, 3), "-1.00 m");
        assert_eq!(digits(1234.0, 2), "1200 m");
        assert_eq!(digits(0.0, 3), "0.00 mm");
    }

    /// What is rounded up to the next unit is written in that unit.
    #[test]
    fn rounding_carries_into_the_next_unit() {
        assert_eq!(digits(9.996e-4, 2), "1.0 mm");
        assert_eq!(digits(9.94e-4, 2), "990 µm");
        assert_eq!(digits(0.9999, 3), "1.00 m");
        assert_eq!(digits(0.99, 0), "1 m");
    }

    #[test]
    fn digits_end_where_the_uncertainty_begins() {
        assert_eq!(within(0.0123456, 2e-5), "12.35 mm");
        assert_eq!(within(0.0123456, 1e-5), "12.35 mm");
        assert_eq!(within(0.0123456, 2e-3), "12 mm");
        assert_eq!(within(1.23456, 0.04), "1.23 m");
        assert_eq!(within(123.4, 20.0), "120 m");
        assert_eq!(within(3e-6, 2e-5), "0 µm");
        assert_eq!(within(-3e-6, 2e-5), "0 µm");
        assert_eq!(within(2e-4, 1e-3), "0 mm");
        assert_eq!(within(0.0123456, 9.7e-5), "12.3 mm", "one digit of the uncertainty, rounded");
        for nothing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(within(0.0123456, nothing), "12.3456 mm");
        }
    }

    #[test]
    fn lengths_that_are_no_numbers_are_written_as_such() {
        assert_eq!(digits(f64::NAN, 3), "NaN m");
        assert_eq!(digits(f64::INFINITY, 3), "inf m");
    }

    #[test]
    fn units_have_names_and_metres() {
        let all: Vec<(&str, f64)> = Unit::NAMES.iter().map(|(name, unit)| (*name, unit.metres())).collect();
        assert_eq!(all, [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("in", 0.0254)]);
        assert!(Unit::from_name("ft").unwrap_err().to_string().contains("unit of length `ft`"));
        assert_eq!(Unit::Inch.format(0.127, Precision::Digits(2)), "5.0 in");
        assert_eq!(Unit::Centimetre.format(0.0123, Precision::Uncertainty(1e-4)), "1.23 cm");
    }

    #[test]
    fn limits_are_read_as_people_write_them() {
        let read = |text: &str| text.parse::<LengthLimit>().ok();
        assert_eq!(read("0.2mm"), Some(LengthLimit::Metres(0.2 * 1e-3)));
        for micrometres in ["50um", "50µm", "50μm", " 50 um "] {
            assert_eq!(read(micrometres), Some(LengthLimit::Metres(50.0 * 1e-6)), "{micrometres}");
        }
        assert_eq!(read("1.5 cm"), Some(LengthLimit::Metres(1.5 * 1e-2)));
        assert_eq!(read("2m"), Some(LengthLimit::Metres(2.0)));
        assert_eq!(read("1in"), Some(LengthLimit::Metres(0.0254)));
        assert_eq!(read("0.4%"), Some(LengthLimit::Fraction(0.004)));
        assert_eq!(read("1e-3m"), Some(LengthLimit::Metres(1e-3)));
        for wrong in ["", "5", "mm", "-1mm", "nanm", "infm", "1km", "1,5mm", "5 µ", "%", "1mm2"] {
            assert!(read(wrong).is_none(), "{wrong}");
        }
        let error = "5".parse::<LengthLimit>().unwrap_err().to_string();
        assert!(error.contains("invalid length `5`") && error.contains("0.2mm"), "{error}");
    }

    #[test]
    fn limits_are_written_without_idle_zeros() {
        let text = |text: &str| text.parse::<LengthLimit>().unwrap().to_string();
        assert_eq!(
            ["0.2mm", "50um", "2m", "0.4%", "100 %", "0mm"].map(text),
            ["200 µm", "50 µm", "2 m", "0.4 %", "100 %", "0 mm"]
        );
        assert_eq!(LengthLimit::Fraction(0.25).metres(0.4), 0.1);
    }

    #[test]
    fn texels_become_dots_per_inch() {
        assert!((dpi(84.667e-6) - 300.0).abs() < 0.01);
        assert_eq!(dpi(0.0254), 1.0);
    }
}
