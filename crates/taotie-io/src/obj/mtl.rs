//! The statements of an MTL file, as stored.

use super::super::text::lines;
use std::path::{Path, PathBuf};
use taotie_engine::error::Warnings;
use taotie_engine::scene::UvTransform;

/// One material of an MTL file, or of another format in its terms. Absent values are `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Mtl {
    /// The name after `newmtl`; may contain spaces, may be empty.
    pub name: String,
    /// The folder of the MTL file.
    pub folder: PathBuf,
    /// The ambient colour, Ka.
    pub ambient: Option<[f32; 3]>,
    /// The diffuse colour, Kd.
    pub diffuse: Option<[f32; 3]>,
    /// The specular colour, Ks.
    pub specular: Option<[f32; 3]>,
    /// The emissive colour, Ke.
    pub emissive: Option<[f32; 3]>,
    /// The shininess, Ns.
    pub shininess: Option<f32>,
    /// The opacity, d: 1 is opaque.
    pub dissolve: Option<f32>,
    /// The transparency, Tr: 0 is opaque.
    pub transparency: Option<f32>,
    /// The roughness, Pr.
    pub roughness: Option<f32>,
    /// The metalness, Pm.
    pub metallic: Option<f32>,
    /// The diffuse texture, map_Kd.
    pub diffuse_map: Option<Map>,
    /// The emissive texture, map_Ke.
    pub emissive_map: Option<Map>,
    /// The opacity texture, map_d.
    pub dissolve_map: Option<Map>,
    /// The texture of map_Bump or bump: heights, though often normals.
    pub bump_map: Option<Map>,
    /// The normal map, norm.
    pub normal_map: Option<Map>,
    /// The roughness texture, map_Pr.
    pub roughness_map: Option<Map>,
    /// The metalness texture, map_Pm.
    pub metallic_map: Option<Map>,
    /// In files by Blender, the shininess of roughness 0: that of roughness r is (1 − r)² of it.
    pub blender_shininess: Option<f32>,
}

/// A texture statement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Map {
    /// The name as written, with either kind of slash.
    pub file: String,
    /// The scale, -s, first two numbers.
    pub scale: [f32; 2],
    /// The offset, -o, first two numbers.
    pub offset: [f32; 2],
    /// `true` if -clamp is on.
    pub clamp: bool,
    /// The factor of -bm.
    pub bump: f32,
    /// The channel of -imfchan.
    pub channel: Option<Channel>,
    /// `true` if -colorspace is linear.
    pub linear: bool,
    /// The uv set; always 0 in MTL files.
    pub uv_set: usize,
}

/// The channel of an image that is read as a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Channel {
    /// The red, green, blue or alpha channel, as 0 to 3.
    Stored(usize),
    /// The mean of red, green and blue.
    Mean,
}

/// Reads the statements of `text` from the file `path`. Unusable statements are noted and skipped.
pub(super) fn parse(path: &Path, text: &str, warnings: &mut Warnings) -> Vec<Mtl> {
    let mut materials: Vec<Mtl> = Vec::new();
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let blender_shininess = blender_shininess(text);
    for (_, statement) in lines(text) {
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((&statement, ""));
        let rest = rest.trim();
        if keyword == "newmtl" {
            let (name, folder) = (rest.to_owned(), folder.clone());
            materials.push(Mtl { name, folder, blender_shininess, ..Mtl::default() });
        } else if let Some(material) = materials.last_mut() {
            let keyword = keyword.to_ascii_lowercase();
            if material.statement(&keyword, rest, warnings).is_none() {
                warnings.note(format!("skipped MTL statement '{keyword}' without a usable value"), 1);
            }
        }
    }
    materials
}

/// Returns the shininess of roughness 0 in a file that starts as Blender's do; up to 2.9, they state no version.
fn blender_shininess(text: &str) -> Option<f32> {
    let rest = text.trim_start().strip_prefix("# Blender ")?;
    Some(if rest.starts_with("MTL") { 900.0 } else { 1000.0 })
}

impl Mtl {
    /// Reads one statement; returns `None` if its value cannot be used.
    fn statement(&mut self, keyword: &str, rest: &str, warnings: &mut Warnings) -> Option<()> {
        match keyword {
            "ka" => self.ambient = Some(color(rest)?),
            "kd" => self.diffuse = Some(color(rest)?),
            "ks" => self.specular = Some(color(rest)?),
            "ke" => self.emissive = Some(color(rest)?),
            "ns" => self.shininess = Some(number(rest)?),
            "d" => {
                let (halo, rest) = rest.strip_prefix("-halo").map_or((0, rest), |rest| (1, rest));
                warnings.note(unused_option("-halo"), halo);
                self.dissolve = Some(number(rest)?);
            }
            "tr" => self.transparency = Some(number(rest)?),
            "pr" => self.roughness = Some(number(rest)?),
            "pm" => self.metallic = Some(number(rest)?),
            "map_kd" => self.diffuse_map = Some(map(rest, warnings)?),
            "map_ke" => self.emissive_map = Some(map(rest, warnings)?),
            "map_d" => self.dissolve_map = Some(map(rest, warnings)?),
            "map_bump" | "bump" => self.bump_map = Some(map(rest, warnings)?),
            "norm" | "map_norm" | "map_kn" => self.normal_map = Some(map(rest, warnings)?),
            "map_pr" => self.roughness_map = Some(map(rest, warnings)?),
            "map_pm" => self.metallic_map = Some(map(rest, warnings)?),
            "tf" => warnings.note(unused(keyword), usize::from(color(rest)? != [1.0; 3])),
            "illum" | "ni" | "km" | "kt" | "sharpness" => {}
            _ => warnings.note(unused(keyword), 1),
        }
        Some(())
    }
}

/// Returns the note for an ignored statement; unknown ones share one, since there may be any number of them.
fn unused(keyword: &str) -> String {
    const KNOWN: [&str; 16] = [
        "map_ka", "map_ks", "map_ns", "map_ps", "map_refl", "refl", "disp", "map_disp", "decal", "map_aat",
        "ps", "pc", "pcr", "aniso", "anisor", "tf",
    ];
    if KNOWN.contains(&keyword) {
        format!("ignored MTL statement '{keyword}'")
    } else {
        "ignored unknown MTL statements".to_owned()
    }
}

/// Returns the note for an ignored option of a statement.
fn unused_option(option: &str) -> String {
    format!("ignored MTL option '{option}'")
}

/// Reads one or three numbers; negative ones become 0.
fn color(rest: &str) -> Option<[f32; 3]> {
    let mut words = rest.split_ascii_whitespace();
    let r = number(words.next()?)?;
    let g = words.next().map_or(Some(r), number)?;
    let b = words.next().map_or(Some(r), number)?;
    Some([r, g, b].map(|v| v.max(0.0)))
}

/// Reads the first word as a finite number.
fn number(rest: &str) -> Option<f32> {
    rest.split_ascii_whitespace().next()?.parse().ok().filter(|value: &f32| value.is_finite())
}

/// Reads options and a file name, which may contain spaces; options may also follow the name. Ignored options are
/// noted.
fn map(rest: &str, warnings: &mut Warnings) -> Option<Map> {
    let mut map = Map::new(String::new());
    let mut rest = rest.trim();
    while let Some(after) = map.option(rest, warnings) {
        rest = after;
    }
    let name_end = trailing_options(rest);
    let mut tail = rest[name_end..].trim();
    while let Some(after) = map.option(tail, warnings) {
        tail = after;
    }
    map.file = rest[..name_end].trim().trim_matches('"').to_owned();
    (!map.file.is_empty()).then_some(map)
}

/// Returns the minimum and maximum number of words that may follow an option.
fn option_words(option: &str) -> Option<(usize, usize)> {
    match option {
        "-s" | "-o" | "-t" => Some((1, 3)),
        "-mm" => Some((2, 2)),
        "-bm" | "-boost" | "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-texres" | "-type"
        | "-colorspace" => Some((1, 1)),
        _ => None,
    }
}

/// Returns the position at which the name ends and known options follow it.
fn trailing_options(rest: &str) -> usize {
    let starts = rest.match_indices(" -").filter(|(i, _)| {
        let word = rest[i + 1..].split_ascii_whitespace().next().unwrap_or("");
        option_words(word).is_some()
    });
    starts.map(|(i, _)| i).next().unwrap_or(rest.len())
}

impl Map {
    /// Creates a map of a file without options.
    pub fn new(file: String) -> Self {
        Self {
            file,
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamp: false,
            bump: 1.0,
            channel: None,
            linear: false,
            uv_set: 0,
        }
    }

    /// Reads one option from the start of `rest` and returns the words that follow it, or `None` if there is none.
    fn option<'a>(&mut self, rest: &'a str, warnings: &mut Warnings) -> Option<&'a str> {
        let (option, mut rest) = next_word(rest)?;
        let (least, most) = option_words(option)?;
        let mut words = Vec::with_capacity(most);
        while words.len() < most {
            let Some((word, after)) = next_word(rest) else { break };
            if words.len() >= least && word.parse::<f32>().is_err() {
                break;
            }
            words.push(word);
            rest = after;
        }
        self.apply(option, &words);
        warnings.note(unused_option(option), usize::from(is_ignored(option, &words)));
        Some(rest)
    }

    fn apply(&mut self, option: &str, words: &[&str]) {
        let value = |i: usize, absent: f32| words.get(i).and_then(|word| value(word)).unwrap_or(absent);
        let first = words.first().copied().unwrap_or("");
        match option {
            "-s" => self.scale = [value(0, 1.0), value(1, 1.0)],
            "-o" => self.offset = [value(0, 0.0), value(1, 0.0)],
            "-bm" => self.bump = value(0, 1.0),
            "-clamp" => self.clamp = first == "on",
            "-colorspace" => self.linear = first.eq_ignore_ascii_case("linear"),
            "-imfchan" => self.channel = channel(first),
            _ => {}
        }
    }
}

/// Reads the number of an option; `None` if it cannot be used. A transform adds up to three such values.
fn value(word: &str) -> Option<f32> {
    word.parse().ok().filter(|value: &f32| value.abs() <= UvTransform::MOST / 4.0)
}

/// Returns `true` for an option with an unusable value, and for one that is not read, unless it has its default.
fn is_ignored(option: &str, words: &[&str]) -> bool {
    let first = words.first().copied().unwrap_or("");
    match option {
        "-s" | "-o" | "-bm" => words.iter().any(|word| value(word).is_none()),
        "-clamp" => !["on", "off"].contains(&first),
        "-colorspace" => !["linear", "srgb"].contains(&first.to_ascii_lowercase().as_str()),
        "-imfchan" => channel(first).is_none(),
        "-mm" => !words.iter().map(|word| value(word)).eq([Some(0.0), Some(1.0)]),
        "-t" | "-boost" => words.iter().any(|word| value(word) != Some(0.0)),
        "-blendu" | "-blendv" => first != "on",
        "-cc" => first != "off",
        _ => true,
    }
}

fn channel(name: &str) -> Option<Channel> {
    match name {
        "r" => Some(Channel::Stored(0)),
        "g" => Some(Channel::Stored(1)),
        "b" => Some(Channel::Stored(2)),
        "m" => Some(Channel::Stored(3)),
        "l" => Some(Channel::Mean),
        _ => None,
    }
}

fn next_word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (end > 0).then(|| text.split_at(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> (Mtl, Warnings) {
        let mut warnings = Warnings::default();
        let materials = parse(Path::new("m/a.mtl"), &format!("newmtl m\n{text}"), &mut warnings);
        (materials.into_iter().next().unwrap_or_default(), warnings)
    }

    #[test]
    fn reads_numbers_and_notes_what_is_none() {
        let (m, warnings) =
            one("Kd .5\n Ks 1 2 3\nKa -1 0 0\nNs 20\nd -halo .5\nTr .25\nPr 0.2\nPm x\nKe 1 nan 0");
        assert_eq!(
            (m.diffuse, m.specular, m.ambient),
            (Some([0.5; 3]), Some([1.0, 2.0, 3.0]), Some([0.0; 3]))
        );
        assert_eq!((m.shininess, m.dissolve, m.transparency), (Some(20.0), Some(0.5), Some(0.25)));
        assert_eq!((m.roughness, m.metallic, m.emissive), (Some(0.2), None, None));
        let notes: Vec<&str> = warnings.iter().map(|(w, _)| w).collect();
        let unusable =
            ["pm", "ke"].map(|keyword| format!("skipped MTL statement '{keyword}' without a usable value"));
        assert_eq!(notes, ["ignored MTL option '-halo'", &unusable[0], &unusable[1]]);
    }

    #[test]
    fn options_stand_before_or_behind_names_with_spaces() {
        let (m, warnings) =
            one("bump -imfchan b  -bm 2 my bump -x 01.png -bm 1.5\nmap_Kd -s 2 -o .1 .2 a.png");
        let bump = m.bump_map.unwrap();
        assert_eq!((bump.file.as_str(), bump.bump), ("my bump -x 01.png", 1.5));
        assert_eq!(bump.channel, Some(Channel::Stored(2)));
        let diffuse = m.diffuse_map.unwrap();
        assert_eq!((diffuse.scale, diffuse.offset, diffuse.file.as_str()), ([2.0, 1.0], [0.1, 0.2], "a.png"));
        assert!(warnings.is_empty());
        let (m, _) = one("map_Kd -s 1e39 2e38 -o 1e11 0 a.png");
        let huge = m.diffuse_map.unwrap();
        assert_eq!((huge.scale, huge.offset), ([1.0, 1.0], [1e11, 0.0]));
        let (m, _) = one("map_Kd -s 1 2 3 4.png\nmap_Ke -clamp on -texres 512 \"a b.png\"\nnorm -bm");
        assert_eq!(m.diffuse_map.unwrap().file, "4.png");
        let emissive = m.emissive_map.unwrap();
        assert_eq!((emissive.file.as_str(), emissive.clamp), ("a b.png", true));
        assert!(m.normal_map.is_none());
    }

    #[test]
    fn options_that_are_not_read_are_noted_unless_they_have_their_defaults() {
        let defaults = "-mm 0 1 -t 0 0 0 -boost 0 -blendu on -blendv on -cc off -clamp off -o 0 0 0 -s 1 1 1";
        let (m, warnings) = one(&format!(
            "map_Kd {defaults} -colorspace sRGB a.png
d .5
map_d -imfchan l b.png"
        ));
        assert_eq!(m.diffuse_map, Some(Map::new("a.png".into())));
        assert!(warnings.is_empty(), "{warnings:?}");
        let (m, warnings) = one("map_Kd -mm 0 2 -t .1 -boost 1 -blendu off a.png -blendv off -texres 64
map_Ks -mm 0 2 b.png\nTf .5 1 1\nTf 1
             map_Pr -mm 0.2 1 -cc on -type sphere -imfchan z c.png -s 1e39
norm -clamp 1 -colorspace raw d.png
             d -halo .5");
        assert_eq!((m.diffuse_map.unwrap().file, m.dissolve), ("a.png".into(), Some(0.5)));
        let mut notes: Vec<String> = warnings.iter().map(|(what, count)| format!("{count} {what}")).collect();
        notes.sort();
        let options = ["blendu", "blendv", "boost", "cc", "clamp", "colorspace", "halo", "imfchan"];
        let mut expected: Vec<String> = options.map(|o| format!("1 ignored MTL option '-{o}'")).into();
        expected.extend(["s", "t", "texres", "type"].map(|o| format!("1 ignored MTL option '-{o}'")));
        expected.extend(
            [
                "1 ignored MTL statement 'map_ks'",
                "1 ignored MTL statement 'tf'",
                "2 ignored MTL option '-mm'",
            ]
            .map(String::from),
        );
        assert_eq!(notes, expected);
    }

    #[test]
    fn names_may_be_empty_or_hold_spaces() {
        let mut warnings = Warnings::default();
        let materials =
            parse(Path::new("a.mtl"), "Kd 1 1 1\nnewmtl \n  newmtl a  b \nrefl x.png", &mut warnings);
        let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["", "a  b"]);
        assert_eq!(warnings.iter().next(), Some(("ignored MTL statement 'refl'", 1)));
    }
}
