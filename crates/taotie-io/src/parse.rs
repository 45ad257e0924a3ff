//! Parses numbers, vectors and colours as people write them.
//!
//! ```
//! use taotie_engine::math::Vec3;
//! use taotie_io::parse;
//!
//! assert_eq!(parse::number(" 2.5 ")?, 2.5);
//! assert_eq!(parse::numbers("1,-2")?, [1.0, -2.0]);
//! assert_eq!(parse::vector("0,1,0")?, Vec3::new(0.0, 1.0, 0.0));
//! assert_eq!(parse::color("0.25")?, Vec3::splat(0.25));
//! assert!(parse::color("#d0c8b0").is_ok() && parse::color("mauve-ish").is_err());
//! # Ok::<(), taotie_engine::Error>(())
//! ```

use taotie_engine::error::{Error, Result};
use taotie_engine::math::{Vec3, srgb};
use taotie_engine::scene::Light;

/// The maximum magnitude of a parsed number. Sums and products of a few such numbers still fit single precision.
pub const MOST: f64 = 1e18;

/// Parses a finite number of either sign, with a magnitude of at most [`MOST`].
///
/// ```
/// assert_eq!(taotie_io::parse::number(" 2.5 ")?, 2.5);
/// assert!(taotie_io::parse::number("inf").is_err());
/// assert!(taotie_io::parse::number("1e39").is_err());
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if it is not one, or too large.
pub fn number(text: &str) -> Result<f64> {
    let number = text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    match number {
        Some(number) if number.abs() <= MOST => Ok(number),
        Some(_) => Err(Error::invalid("number", format!("`{text}` is too large; use at most 1e18"))),
        None => Err(Error::invalid("number", format!("`{text}` is not a number"))),
    }
}

/// Parses finite numbers separated by commas.
///
/// ```
/// assert_eq!(taotie_io::parse::numbers("1,-2")?, [1.0, -2.0]);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// As [`number`].
pub fn numbers(text: &str) -> Result<Vec<f64>> {
    text.split(',').map(number).collect()
}

/// Parses exactly three numbers separated by commas.
///
/// ```
/// use taotie_engine::math::Vec3;
/// use taotie_io::parse::vector;
///
/// assert_eq!(vector("0,1,0")?, Vec3::new(0.0, 1.0, 0.0));
/// assert!(vector("0,1").is_err());
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// As [`number`], and if there are more or fewer.
pub fn vector(text: &str) -> Result<Vec3<f64>> {
    match numbers(text)?.as_slice() {
        [x, y, z] => Ok(Vec3::new(*x, *y, *z)),
        other => {
            let why = format!("expected three numbers, such as 0,1,0, found {}", other.len());
            Err(Error::invalid("vector", why))
        }
    }
}

/// Parses a CSS colour, or one linear number for grey. Returns linear RGB, each from 0 to [`Light::MOST`].
///
/// ```
/// use taotie_engine::math::Vec3;
/// use taotie_io::parse::color;
///
/// assert_eq!(color("0.25")?, Vec3::splat(0.25));
/// assert_eq!(color("#000000")?, Vec3::splat(0.0));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if it is neither, or out of range.
pub fn color(text: &str) -> Result<Vec3> {
    if text.trim().parse::<f64>().is_ok() {
        let grey = Vec3::splat(number(text)? as f32);
        let why = || format!("`{text}` is not a colour; a linear grey is between 0 and 1e12");
        return if Light::is_strength(grey) { Ok(grey) } else { Err(Error::invalid("color", why())) };
    }
    let css = csscolorparser::parse(text).map_err(|_| {
        let advice = "use a CSS colour such as #d0c8b0 or a linear grey such as 0.5";
        Error::invalid("color", format!("`{text}` is not a colour; {advice}"))
    })?;
    let linear = |v: f32| srgb::linear_from_srgb(f64::from(v)) as f32;
    let color = Vec3::new(linear(css.r), linear(css.g), linear(css.b));
    Ok(Vec3::from_array(color.to_array().map(|v| v.max(0.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_linear() {
        let grey = color("#808080").unwrap();
        assert!((grey.x - 0.2158).abs() < 1e-3);
        assert_eq!(color("0.25").unwrap(), Vec3::splat(0.25));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let why = |error: Error| error.to_string();
        assert!(why(color("mauve-ish").unwrap_err()).contains("`mauve-ish` is not a colour"));
        assert!(why(vector("1,2").unwrap_err()).contains("found 2"));
        assert!(number("inf").is_err() && numbers("1,,2").is_err());
        assert!(why(number("-1e39").unwrap_err()).contains("at most 1e18"));
        assert!(why(color("-1").unwrap_err()).contains("between 0 and 1e12"));
        assert!(why(color("1e13").unwrap_err()).contains("between 0 and 1e12"));
        assert!(color("1e39").is_err() && color("nan").is_err());
    }
}
