//! Readers of option values that several subcommands share.

use anyhow::anyhow;
use std::fmt::Display;
use taotie::Error;
use taotie::math::Vec3;
use taotie::names::Named;
use taotie::studio::parse;

/// A value by its name, which may have spaces around it in a list; the error lists the names.
pub fn named<T: Named>(value: &str) -> Result<T, String> {
    T::from_name(value.trim()).map_err(|error| error.to_string())
}

/// `WIDTHxHEIGHT`, or one number for both.
pub fn size(value: &str) -> Result<[u32; 2], String> {
    let wrong = || "write WIDTHxHEIGHT in pixels, such as 1920x1080, or one number for both".to_string();
    let (width, height) = value.split_once(['x', 'X']).unwrap_or((value, value));
    let side = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let (width, height) = (side(width)?, side(height)?);
    taotie::image::Image::check_size(width, height).map_err(|error| error.to_string())?;
    Ok([width, height])
}

/// `on` or `off`.
pub fn switch(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("write on or off".into()),
    }
}

/// A finite number.
pub fn number(value: &str) -> Result<f64, String> {
    parse::number(value).map_err(reason)
}

/// A number in [0, 1].
pub fn fraction(value: &str) -> Result<f64, String> {
    let number = number(value)?;
    if (0.0..=1.0).contains(&number) { Ok(number) } else { Err(format!("{value} is not in [0, 1]")) }
}

/// A number above 0.
pub fn positive(value: &str) -> Result<f64, String> {
    let number = number(value)?;
    if number > 0.0 { Ok(number) } else { Err(format!("{value} is not above 0")) }
}

/// A number of 0 or more.
pub fn at_least_0(value: &str) -> Result<f64, String> {
    let number = number(value)?;
    if number >= 0.0 { Ok(number) } else { Err(format!("{value} is below 0")) }
}

/// Finite numbers separated by commas.
pub fn numbers(value: &str) -> Result<Vec<f64>, String> {
    parse::numbers(value).map_err(reason)
}

/// Exactly three numbers separated by commas.
pub fn vector(value: &str) -> Result<Vec3<f64>, String> {
    parse::vector(value).map_err(reason)
}

/// A colour as CSS writes it, or one number for grey, as linear RGB.
pub fn color(value: &str) -> Result<Vec3, String> {
    parse::color(value).map_err(reason)
}

/// Why a value cannot be used, without its name: who asked says which option it is.
fn reason(error: Error) -> String {
    match error {
        Error::Invalid { why, .. } => why,
        other => other.to_string(),
    }
}

/// The error of a value that cannot be used, by the option that gave it.
pub fn under(option: impl Display, error: Error) -> anyhow::Error {
    match error {
        Error::Invalid { why, .. } => anyhow!("{option}: {why}"),
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!((size("640x480"), size("64")), (Ok([640, 480]), Ok([64, 64])));
        assert!(
            size("640x").is_err()
                && size("0x1").is_err()
                && size("1x99999").is_err()
                && size("-1x2").is_err()
        );
    }

    #[test]
    fn ranges() {
        assert_eq!((fraction("1"), positive("0.5"), at_least_0("0")), (Ok(1.0), Ok(0.5), Ok(0.0)));
        assert!(fraction("1.1").is_err() && positive("0").is_err() && at_least_0("-1").is_err());
    }

    #[test]
    fn why_a_value_is_refused_is_told_without_its_name() {
        assert_eq!(number("a"), Err("`a` is not a number".into()));
        let error = Error::invalid("vector", "three numbers are needed");
        assert_eq!(under("--target", error).to_string(), "--target: three numbers are needed");
    }

    #[test]
    fn unknown_names_are_answered_with_the_list() {
        assert!(named::<taotie::shade::Shading>("gxx").unwrap_err().contains("ggx"));
        assert_eq!(named(" ggx"), Ok(taotie::shade::Shading::Ggx));
    }
}
