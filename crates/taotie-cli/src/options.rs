//! Readers of option values that several subcommands share.

use taotie::math::Vec3;
use taotie::names::Named;

/// A value by its name; the error lists the names.
pub fn named<T: Named>(value: &str) -> Result<T, String> {
    T::from_name(value).map_err(|error| error.to_string())
}

/// `WIDTHxHEIGHT`.
pub fn size(value: &str) -> Result<[u32; 2], String> {
    let wrong = || "write WIDTHxHEIGHT in pixels, such as 1920x1080".to_string();
    let (width, height) = value.split_once(['x', 'X']).ok_or_else(wrong)?;
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
    value
        .trim()
        .parse::<f64>()
        .ok()
        .filter(|v| v.is_finite())
        .ok_or_else(|| format!("`{value}` is not a number"))
}

/// Finite numbers parted by commas.
pub fn numbers(value: &str) -> Result<Vec<f64>, String> {
    value.split(',').map(number).collect()
}

/// Exactly three numbers parted by commas.
pub fn vector(value: &str) -> Result<Vec3<f64>, String> {
    match numbers(value)?.as_slice() {
        [x, y, z] => Ok(Vec3::new(*x, *y, *z)),
        other => Err(format!("three numbers are needed, such as 0,1,0, not {}", other.len())),
    }
}

/// A colour as CSS writes it, or one number for grey, as linear RGB.
pub fn color(value: &str) -> Result<Vec3, String> {
    if let Ok(grey) = number(value) {
        return Ok(Vec3::splat(grey as f32));
    }
    let css = csscolorparser::parse(value).map_err(|_| {
        format!("`{value}` is no colour; write a CSS colour such as #d0c8b0 or a linear grey such as 0.5")
    })?;
    let linear = |v: f32| taotie::math::srgb::linear_from_srgb(f64::from(v)) as f32;
    Ok(Vec3::new(linear(css.r), linear(css.g), linear(css.b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert!(
            size("640").is_err() && size("0x1").is_err() && size("1x99999").is_err() && size("-1x2").is_err()
        );
    }

    #[test]
    fn colors_are_linear() {
        let grey = color("#808080").unwrap();
        assert!((grey.x - 0.2158).abs() < 1e-3);
        assert_eq!(color("0.25").unwrap(), Vec3::splat(0.25));
        assert!(color("mauve-ish").is_err());
    }

    #[test]
    fn unknown_names_are_answered_with_the_list() {
        assert!(named::<taotie::shade::Shading>("gxx").unwrap_err().contains("ggx"));
    }
}
