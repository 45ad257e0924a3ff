//! Coarser levels of detail as requested, and the screen for which they are switched.

use serde_json::Value;
use std::fmt;
use std::str::FromStr;
use taotie_engine::error::{Error, Result};

/// A requested coarser level of detail: by its triangles, or by the size of the object on the screen while it is
/// shown.
///
/// ```
/// use taotie::asset::Lod;
///
/// assert_eq!("5000".parse::<Lod>()?, Lod::Triangles(5000));
/// assert_eq!("128px".parse::<Lod>()?, Lod::Pixels(128));
/// assert!("12.5%".parse::<Lod>().is_err());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lod {
    /// This number of triangles. It is shown once the object fills few enough pixels for it to meet the limits of the
    /// finest level.
    Triangles(u32),
    /// The lightest level that meets the limits of the finest when the object fills this many pixels, squared; 32 to
    /// 511.
    Pixels(u32),
}

/// The minimum number of triangles of a level.
const FEWEST: u32 = 4;
/// The suffix of a number of pixels.
const PIXELS: &str = "px";

impl Lod {
    /// The pixels across an object for which the finest level is made.
    pub(in crate::asset) const FINEST: u32 = 512;
    /// The minimum number of pixels across for which a level is made.
    pub(in crate::asset) const LEAST: u32 = 32;

    /// Returns its form in files: a number of triangles, or text.
    pub(in crate::asset) fn json(self) -> Value {
        match self {
            Self::Triangles(count) => count.into(),
            Self::Pixels(_) => self.to_string().into(),
        }
    }

    /// Refuses levels that cannot follow a finest one with this number of triangles, if known.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a level that is not coarser than the one before it, and for pixels out of range.
    pub(super) fn check(levels: &[Self], finest: Option<u32>) -> Result<()> {
        let (mut triangles, mut pixels) = (finest, Self::FINEST);
        for level in levels {
            let (before, is_coarser) = match *level {
                Self::Triangles(count) => {
                    let before = triangles.replace(count);
                    (
                        before.map(Self::Triangles),
                        before.is_none_or(|before| count < before) && count >= FEWEST,
                    )
                }
                Self::Pixels(across) => {
                    let before = std::mem::replace(&mut pixels, across);
                    (Some(Self::Pixels(before)), (Self::LEAST..before).contains(&across))
                }
            };
            if !is_coarser {
                let after = before.map_or_else(String::new, |before| format!(" after one of {before}"));
                let why = "each must have fewer triangles, or be for fewer pixels, than the one before; at least 4 triangles or 32 pixels";
                return Err(Error::invalid(format!("the level of detail {level}{after}"), why));
            }
        }
        Ok(())
    }
}

impl fmt::Display for Lod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangles(count) => write!(f, "{count}"),
            Self::Pixels(across) => write!(f, "{across}{PIXELS}"),
        }
    }
}

impl FromStr for Lod {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let number = |digits: &str| digits.trim_end().parse::<u32>().ok();
        let read = match text.strip_suffix(PIXELS) {
            Some(digits) => number(digits).map(Self::Pixels),
            None => number(text).map(Self::Triangles),
        };
        let why =
            "use a number of triangles, such as 5000, or the pixels that the object fills, such as 128px";
        read.ok_or_else(|| Error::invalid(format!("the level of detail `{text}`"), why))
    }
}

impl serde::Serialize for Lod {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        self.json().serialize(serializer)
    }
}

impl<'de> serde::Deserialize<'de> for Lod {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// The pixels of the screen used to define visually lossless, 3840 × 2160.
const SCREEN_PIXELS: f64 = 3840.0 * 2160.0;
/// An object that fills fewer pixels across shows almost nothing.
const LEAST_ACROSS: f64 = 8.0;

/// Returns the fraction of the screen covered by an object that fills this many pixels, squared, in [0, 1].
pub(in crate::asset) fn screen_coverage(across: u32) -> f32 {
    (f64::from(across) * f64::from(across) / SCREEN_PIXELS).min(1.0) as f32
}

/// Returns the pixels across an object that covers this fraction of the screen, at least 8, and at most those of the
/// finest.
pub(in crate::asset) fn pixels_across(coverage: f32) -> f32 {
    let across = (f64::from(coverage).max(0.0) * SCREEN_PIXELS).sqrt();
    across.clamp(LEAST_ACROSS, f64::from(Lod::FINEST)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(levels: &[&str], finest: Option<u32>) -> bool {
        let levels: Vec<Lod> = levels.iter().map(|level| level.parse().unwrap()).collect();
        Lod::check(&levels, finest).is_ok()
    }

    #[test]
    fn levels_get_coarser() {
        assert!(check(&["5000", "256px", "100", "64px"], Some(10_000)) && check(&["256px"], None));
        assert!(!check(&["5000"], Some(5000)) && !check(&["300", "300"], None) && !check(&["3"], None));
        assert!(!check(&["64px", "128px"], None) && !check(&["512px"], None) && !check(&["31px"], None));
    }

    #[test]
    fn text_is_read_as_it_is_written() {
        for text in ["7", "64px"] {
            assert_eq!(text.parse::<Lod>().unwrap().to_string(), text);
        }
        for wrong in ["", "px", "-3", "1.5", "64 pixels"] {
            assert!(wrong.parse::<Lod>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn pixels_follow_from_what_is_covered() {
        for pixels in [32, 64, 256, 512] {
            assert!((pixels_across(screen_coverage(pixels)) - pixels as f32).abs() < 1e-3);
        }
        assert_eq!((pixels_across(1.0), pixels_across(0.0)), (512.0, 8.0));
    }
}
