//! Packed textures as requested: which map each channel holds.

use std::fmt;
use std::str::FromStr;
use taotie_engine::bake::MapKind;
use taotie_engine::error::{Error, Result};
use taotie_engine::names::Named;

/// A texture that packs maps into its channels, next to the asset.
///
/// ```
/// use taotie::asset::Channels;
///
/// let mask: Channels = "unity-mask".parse()?;
/// assert_eq!(mask.to_string(), "unity-mask:R=metallic,G=ao,B=1,A=1-roughness");
/// let own: Channels = "dirt:R=ao,G=curvature,B=height".parse()?;
/// assert_eq!(own.name(), "dirt");
/// assert!("R=shine".parse::<Channels>().is_err());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Channels {
    name: String,
    sources: Vec<ChannelSource>,
}

/// The content of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::asset) enum ChannelSource {
    /// A code, [0, 1].
    Constant(f32),
    /// A channel of a map.
    Map(MapChannel),
}

/// A channel of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::asset) struct MapChannel {
    pub quantity: Quantity,
    /// `true` if black and white change places.
    pub is_inverted: bool,
}

/// Numbers that maps hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::asset) enum Quantity {
    /// A map of numbers.
    Map(MapKind),
    /// The scan's metalness, which shares a map with roughness.
    Metallic,
    /// Red, green or blue of a map of directions or colours.
    Component(MapKind, usize),
}

impl Quantity {
    /// Returns the map that holds it.
    pub fn map(self) -> MapKind {
        match self {
            Self::Map(map) | Self::Component(map, _) => map,
            Self::Metallic => MapKind::MetallicRoughness,
        }
    }

    /// Returns the component of vectors and colours that it is; `None` for numbers.
    pub fn component(self) -> Option<usize> {
        match self {
            Self::Component(_, component) => Some(component),
            Self::Map(_) | Self::Metallic => None,
        }
    }
}

/// The names of channels.
pub(in crate::asset) const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// Packed textures that other programs expect.
const RECIPES: [(&str, &str); 3] = [
    ("orm", "R=ao,G=roughness,B=metallic"),
    ("unreal", "R=ao,G=roughness,B=metallic"),
    ("unity-mask", "R=metallic,G=ao,B=1,A=1-roughness"),
];

/// Returns the channels of a recipe; empty for other names.
fn recipe(name: &str) -> &'static str {
    RECIPES.iter().find(|(known, _)| *known == name).map_or("", |(_, list)| list)
}

impl Channels {
    /// Returns its name, which the file is named after: `scan.orm.png`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the contents of red, green, blue and, if there are four, alpha.
    pub(in crate::asset) fn sources(&self) -> &[ChannelSource] {
        &self.sources
    }

    /// Checks all textures of an asset as [`Channels::check`], and that their names differ.
    ///
    /// # Errors
    /// Those of [`Channels::check`], and [`Error::Invalid`] with a name that two of them have.
    pub fn check_all(all: &[Self], maps: &[MapKind], carry: bool) -> Result<()> {
        for (i, channels) in all.iter().enumerate() {
            channels.check(maps, carry)?;
            if all[..i].iter().any(|other| other.name.eq_ignore_ascii_case(&channels.name)) {
                let what = format!("two textures of channels named {}", channels.name);
                return Err(Error::invalid(what, "give each a name, as in NAME:R=ao,G=height,B=0"));
            }
        }
        Ok(())
    }

    /// Refuses channels of maps that are not baked. With `carry`, what varies in the scan's materials is baked, and the
    /// rest is in factors of the asset's material.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the name of a missing map.
    pub fn check(&self, maps: &[MapKind], carry: bool) -> Result<()> {
        let has = |quantity: Quantity| match quantity.map() {
            MapKind::Roughness | MapKind::MetallicRoughness => {
                carry || maps.contains(&MapKind::Roughness) || maps.contains(&MapKind::MetallicRoughness)
            }
            map @ (MapKind::Albedo
            | MapKind::Alpha
            | MapKind::Emission
            | MapKind::OcclusionMap
            | MapKind::Normal) => carry || maps.contains(&map),
            map => maps.contains(&map),
        };
        let needed = self.sources.iter().filter_map(|source| match source {
            ChannelSource::Map(channel) => Some(channel.quantity),
            ChannelSource::Constant(_) => None,
        });
        match needed.into_iter().find(|quantity| !has(*quantity)) {
            None => Ok(()),
            Some(quantity) => {
                let what = format!("the channels `{}`", self.name);
                Err(Error::invalid(
                    what,
                    format!("{} is not baked; add it to the maps", quantity.map().name()),
                ))
            }
        }
    }
}

impl FromStr for Channels {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = RECIPES.iter().find(|(name, _)| *name == text.trim()).copied();
        let (name, list) = known.or_else(|| text.split_once(':')).unwrap_or(("channels", text));
        let wrong = |why: String| Error::invalid(format!("the channels `{text}`"), why);
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        let names: Vec<&str> = RECIPES.iter().map(|(name, _)| *name).collect();
        // Some systems ignore case in names of files.
        let lower = name.to_ascii_lowercase();
        let is_taken =
            MapKind::from_name(&lower).is_ok() || names.contains(&lower.as_str()) && list != recipe(&lower);
        if name.is_empty() || !name.chars().all(is_plain) || is_taken {
            return Err(wrong(format!(
                "`{name}` cannot name a file; use letters, digits and `-`, and neither a map's nor a recipe's name"
            )));
        }
        let form = format!("use {}, or a list such as R=ao,G=roughness,B=1-height", names.join(", "));
        let mut sources = Vec::new();
        for (part, channel) in list.split(',').zip(CHANNELS) {
            let (letter, source) = part.split_once('=').ok_or_else(|| wrong(form.clone()))?;
            if !letter.trim().eq_ignore_ascii_case(channel) {
                return Err(wrong(format!("`{part}`: channel {channel} comes here; {form}")));
            }
            sources.push(source.trim().parse().map_err(|why: String| wrong(format!("`{part}`: {why}")))?);
        }
        match list.split(',').count() {
            3 | 4 => Ok(Self { name: name.to_owned(), sources }),
            _ => Err(wrong(format!("a texture has three or four channels; {form}"))),
        }
    }
}

impl FromStr for ChannelSource {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if let Ok(code) = text.parse::<f32>() {
            let is_code = (0.0..=1.0).contains(&code);
            return is_code.then_some(Self::Constant(code)).ok_or_else(|| "numbers are 0 to 1".to_owned());
        }
        let (is_inverted, name) = text.strip_prefix("1-").map_or((false, text), |name| (true, name));
        Ok(Self::Map(MapChannel { quantity: name.parse()?, is_inverted }))
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(name: &str) -> std::result::Result<Self, String> {
        if name == METALLIC {
            return Ok(Self::Metallic);
        }
        let (map, component) = match name.rsplit_once('.') {
            Some((map, component)) => (map, COMPONENTS.iter().position(|known| *known == component)),
            None => (name, None),
        };
        let kind = MapKind::from_name(map).map_err(|error| error.to_string())?;
        match (kind, kind.planes()[0].channels(), component) {
            (MapKind::MetallicRoughness, ..) => {
                Err("it holds two numbers: use metallic or roughness".to_owned())
            }
            (MapKind::MaterialId | MapKind::ObjectId, ..) => {
                Err("its texture cannot share channels".to_owned())
            }
            (_, 1, None) if name == map => Ok(Self::Map(kind)),
            (_, 3, Some(component)) => Ok(Self::Component(kind, component)),
            (_, 1, _) => Err(format!("it has one channel: use {map}")),
            _ => Err(format!("it has three channels: use {map}.r, {map}.g or {map}.b")),
        }
    }
}

const METALLIC: &str = "metallic";
const COMPONENTS: [&str; 3] = ["r", "g", "b"];

impl fmt::Display for Channels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.name)?;
        for (i, (channel, source)) in CHANNELS.iter().zip(&self.sources).enumerate() {
            let comma = if i == 0 { "" } else { "," };
            match source {
                ChannelSource::Constant(code) => write!(f, "{comma}{channel}={code}")?,
                ChannelSource::Map(map) => write!(f, "{comma}{channel}={map}")?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for MapChannel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_inverted { "1-" } else { "" })?;
        match self.quantity {
            Quantity::Metallic => f.write_str(METALLIC),
            Quantity::Map(map) => f.write_str(map.name()),
            Quantity::Component(map, k) => write!(f, "{}.{}", map.name(), COMPONENTS[k]),
        }
    }
}

impl From<Channels> for String {
    fn from(channels: Channels) -> Self {
        channels.to_string()
    }
}

impl TryFrom<String> for Channels {
    type Error = Error;

    fn try_from(text: String) -> Result<Self> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recipes_are_read_as_they_are_written() {
        for (name, _) in RECIPES {
            let recipe: Channels = name.parse().unwrap();
            assert_eq!(
                (recipe.name(), recipe.to_string().parse::<Channels>().unwrap()),
                (name, recipe.clone())
            );
        }
        let own: Channels = "R=albedo.g, g=1-height,B=0.5,A=metallic".parse().unwrap();
        assert_eq!(own.to_string(), "channels:R=albedo.g,G=1-height,B=0.5,A=metallic");
        let missing = |maps: &[MapKind], carry| own.check(maps, carry).err().map(|error| error.to_string());
        let text = missing(&[MapKind::Albedo], true).unwrap();
        assert!(text.contains("height is not baked; add it to the maps"), "{text}");
        assert_eq!(missing(&[MapKind::Height], true), None, "metalness and colour may be factors");
        assert!(missing(&[MapKind::Height, MapKind::Albedo], false).unwrap().contains("metallic-roughness"));
    }

    #[test]
    fn what_no_texture_can_hold_is_refused() {
        let cases = [
            ("R=ao", "three or four channels"),
            ("R=ao,G=ao,B=ao,A=ao,A=ao", "three or four channels"),
            ("R=ao,B=ao,G=ao", "channel G comes here"),
            ("R=shine,G=ao,B=ao", "unknown map `shine`"),
            ("R=normal,G=ao,B=ao", "use normal.r, normal.g or normal.b"),
            ("R=ao.r,G=ao,B=ao", "one channel: use ao"),
            ("R=metallic-roughness,G=0,B=0", "use metallic or roughness"),
            ("R=2,G=0,B=0", "0 to 1"),
            ("../x:R=0,G=0,B=0", "cannot name a file"),
            ("Height:R=0,G=0,B=0", "neither a map's nor a recipe's name"),
            ("orm:R=0,G=0,B=0", "neither a map's nor a recipe's name"),
            ("unity", "use orm, unreal, unity-mask, or a list"),
        ];
        for (text, why) in cases {
            let error = text.parse::<Channels>().unwrap_err().to_string();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
