//! Values of options that several subcommands share: their parsers, and the choice of an item of a file.

use anyhow::anyhow;
use std::fmt::Display;
use taotie::Bytes;
use taotie::asset::BakeOptions;
use taotie_engine::Error;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_io::parse;

/// Parses a value by its name, ignoring spaces around it in a list; the error lists the names.
pub fn named<T: Named>(value: &str) -> Result<T, String> {
    T::from_name(value.trim()).map_err(|error| error.to_string())
}

/// Parses a word of a list, without the spaces around it.
pub fn word(value: &str) -> Result<String, String> {
    Ok(value.trim().to_owned())
}

/// Parses `WIDTHxHEIGHT`, or one number for both.
pub fn size(value: &str) -> Result<[u32; 2], String> {
    let wrong = || "expected WIDTHxHEIGHT, such as 1920x1080, or one number for both".to_string();
    let (width, height) = value.split_once(['x', 'X', '×']).unwrap_or((value, value));
    let side = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let (width, height) = (side(width)?, side(height)?);
    taotie_engine::image::Image::check_size(width, height).map_err(|error| error.to_string())?;
    Ok([width, height])
}

/// Parses the side of a square, `LEAST` to 2048 pixels: one number, or the same twice, as in 512x512.
pub fn square<const LEAST: u32>(value: &str) -> Result<u32, String> {
    match size(value)? {
        [side, other] if side != other => Err(format!("{value} is not a square; give one number")),
        [side, _] if !(LEAST..=2048).contains(&side) => Err(format!("{side} is not in {LEAST}..=2048")),
        [side, _] => Ok(side),
    }
}

/// Parses the size of maps: like [`size`], 16 to 16384 texels a side, or `auto`.
pub fn map_size(value: &str) -> Result<[u32; 2], String> {
    if value == "auto" {
        return Ok([BakeOptions::AUTO_SIZE; 2]);
    }
    let size = size(value)?;
    match size.iter().find(|side| !(16..=16_384).contains(*side)) {
        Some(side) => Err(format!("{side} is not in 16..=16384")),
        None => Ok(size),
    }
}

/// Parses an amount of memory.
pub fn memory(text: &str) -> Result<Bytes, String> {
    text.parse()
        .map_err(|_| format!("invalid memory size `{text}`: use a number with a unit, e.g. 4G or 800M"))
}

/// Parses `on` or `off`.
pub fn switch(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("expected on or off".into()),
    }
}

/// Parses a finite number.
pub fn number(value: &str) -> Result<f64, String> {
    parse::number(value).map_err(reason)
}

/// Parses a number in [0, 1].
pub fn fraction(value: &str) -> Result<f64, String> {
    let number = number(value)?;
    if (0.0..=1.0).contains(&number) { Ok(number) } else { Err(format!("{value} is not in [0, 1]")) }
}

/// Parses a number above 0.
pub fn positive(value: &str) -> Result<f64, String> {
    let number = number(value)?;
    if number > 0.0 { Ok(number) } else { Err(format!("{value} is not above 0")) }
}

/// Parses a number of 0 or more.
pub fn at_least_0(value: &str) -> Result<f64, String> {
    let number = number(value)?;
    if number >= 0.0 { Ok(number) } else { Err(format!("{value} is below 0")) }
}

/// Parses finite numbers separated by commas.
pub fn numbers(value: &str) -> Result<Vec<f64>, String> {
    parse::numbers(value).map_err(reason)
}

/// Parses exactly three numbers separated by commas.
pub fn vector(value: &str) -> Result<Vec3<f64>, String> {
    parse::vector(value).map_err(reason)
}

/// Parses a colour in CSS notation, or one number for grey; returns linear RGB.
pub fn color(value: &str) -> Result<Vec3, String> {
    parse::color(value).map_err(reason)
}

/// Returns why a value is invalid, without its name: the caller adds the option.
fn reason(error: Error) -> String {
    match error {
        Error::Invalid { why, .. } => why,
        other => other.to_string(),
    }
}

/// Returns the error of an invalid value, naming its option.
pub fn under(option: impl Display, error: Error) -> anyhow::Error {
    match error {
        Error::Invalid { why, .. } => anyhow!("{option}: {why}"),
        other => other.into(),
    }
}

/// Returns the index of the requested item of a file, by name, or by number from 0 only if no name matches; `one` and
/// `many` are the words for it. The error lists all items.
pub fn chosen(asked: &str, [one, many]: [&str; 2], names: &[&str]) -> Result<usize, String> {
    let named: Vec<usize> = (0..names.len()).filter(|i| names[*i] == asked).collect();
    let number = asked.parse().ok().filter(|i| *i < names.len());
    match (named.as_slice(), number) {
        ([i], _) => Ok(*i),
        ([], Some(i)) => Ok(i),
        ([], None) => Err(format!("unknown {one} `{asked}`; expected one of: {}", listed(names))),
        _ => Err(format!("several {many} are named `{asked}`; use the number: {}", listed(names))),
    }
}

/// Lists each name after its number.
pub fn listed(names: &[&str]) -> String {
    let each = |(i, name): (usize, &&str)| format!("{i} {name}").trim_end().to_owned();
    names.iter().enumerate().map(each).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        let written = ["640x480", "640 X 480", "640×480", " 640 "].map(size);
        assert_eq!(written, [Ok([640, 480]), Ok([640, 480]), Ok([640, 480]), Ok([640, 640])]);
        for wrong in ["", "0", "0x1", "1x99999", "-1x2", "640x", "640x480x2"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!((map_size("64"), map_size("64x16")), (Ok([64, 64]), Ok([64, 16])));
        assert_eq!((square::<64>("64"), square::<16>("20x20")), (Ok(64), Ok(20)));
        assert!(square::<64>("63").unwrap_err().contains("64..=2048"));
        assert!(square::<64>("64x65").unwrap_err().contains("not a square"));
        assert!(map_size("8").unwrap_err().contains("16..=16384") && map_size("64x8").is_err());
    }

    #[test]
    fn spaces_around_the_words_of_a_list_do_not_matter() {
        assert_eq!(named(" ggx "), Ok(taotie_engine::shade::Shading::Ggx));
        assert_eq!(word(" depth").as_deref(), Ok("depth"));
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
        assert!(named::<taotie_engine::shade::Shading>("gxx").unwrap_err().contains("ggx"));
        assert_eq!(named(" ggx"), Ok(taotie_engine::shade::Shading::Ggx));
    }

    #[test]
    fn names_go_before_numbers() {
        let choose = |asked: &str| chosen(asked, ["mesh", "meshes"], &["lid", "0", "", "leg", "leg"]);
        assert_eq!((choose("lid"), choose("0"), choose("2")), (Ok(0), Ok(1), Ok(2)));
        let list = "0 lid, 1 0, 2, 3 leg, 4 leg";
        assert_eq!(choose("arm"), Err(format!("unknown mesh `arm`; expected one of: {list}")));
        assert_eq!(choose("9"), Err(format!("unknown mesh `9`; expected one of: {list}")));
        assert_eq!(choose("leg"), Err(format!("several meshes are named `leg`; use the number: {list}")));
    }
}
