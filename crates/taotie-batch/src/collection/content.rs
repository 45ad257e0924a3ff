//! The content of a collection's file, as written, and its lines, for error messages.

use glob::{MatchOptions, Pattern};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;
use taotie::Bytes;
use taotie_engine::{Error, Result};
use toml::{Spanned, Table, Value};

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(from = "Whole")]
pub struct Content {
    /// The collection's name.
    pub title: Option<String>,
    /// The URL it is published at.
    pub address: Option<String>,
    /// The folder for all output.
    pub output: PathBuf,
    /// Where to look for objects.
    pub source: Vec<Spanned<Source>>,
    /// Options for all objects.
    pub made: Made,
    /// How to run the work.
    pub run: Run,
    /// Options for some objects.
    pub overrides: Vec<Override>,
}

/// The file's keys.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Whole {
    title: Option<String>,
    address: Option<String>,
    #[serde(default = "default_output")]
    output: PathBuf,
    source: Vec<Spanned<Source>>,
    scan: Option<Keys>,
    bake: Option<Keys>,
    packing: Option<Keys>,
    verify: Option<Keys>,
    photometric: Option<Keys>,
    report: Option<bool>,
    thumbnail: Option<Spanned<Switch>>,
    turntable: Option<Spanned<Switch>>,
    viewer: Option<Spanned<Switch>>,
    require: Option<Vec<Spanned<String>>>,
    #[serde(default)]
    run: Run,
    #[serde(default, rename = "override")]
    overrides: Vec<Spanned<OneOverride>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OneOverride {
    id: Spanned<String>,
    scan: Option<Keys>,
    bake: Option<Keys>,
    packing: Option<Keys>,
    verify: Option<Keys>,
    photometric: Option<Keys>,
    report: Option<bool>,
    thumbnail: Option<Spanned<Switch>>,
    turntable: Option<Spanned<Switch>>,
    viewer: Option<Spanned<Switch>>,
    require: Option<Vec<Spanned<String>>>,
}

/// A table whose keys carry their positions.
pub type Keys = BTreeMap<Spanned<String>, Value>;

/// A table, or a switch: `false` for none, `true` for the defaults.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub enum Switch {
    /// Not made, or made with the defaults.
    Is(bool),
    /// Made with these options.
    With(Table),
}

/// Options of what to make from objects.
#[derive(Debug, Default)]
pub struct Made {
    pub scan: Option<Keys>,
    pub bake: Option<Keys>,
    pub packing: Option<Keys>,
    pub verify: Option<Keys>,
    pub photometric: Option<Keys>,
    pub report: Option<bool>,
    pub thumbnail: Option<Spanned<Switch>>,
    pub turntable: Option<Spanned<Switch>>,
    pub viewer: Option<Spanned<Switch>>,
    pub require: Option<Vec<Spanned<String>>>,
}

/// A place to look for objects: exactly one of the fields is set.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// A folder: every model in it, and every folder with a file of lights, at any depth.
    pub folder: Option<PathBuf>,
    /// A folder: every folder in it with photographs, at any depth, however their lights are known.
    pub photographs: Option<PathBuf>,
    /// A path pattern.
    pub glob: Option<String>,
    /// A CSV or JSONL file that lists models, and folders or files of photographs.
    pub list: Option<PathBuf>,
}

/// How to run the work.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Run {
    jobs: Option<Spanned<usize>>,
    memory: Option<Spanned<String>>,
    time_limit: Option<Spanned<String>>,
}

/// How to run the work on a collection, as far as its file states it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunSettings {
    /// The largest number of concurrent processes.
    pub jobs: Option<usize>,
    /// The most memory for all processes together.
    pub memory: Option<Bytes>,
    /// The longest time per asset.
    pub time_limit: Option<Duration>,
}

/// Options for the objects whose ids match a pattern.
#[derive(Debug)]
pub struct Override {
    id: Spanned<String>,
    /// The options.
    pub made: Spanned<Made>,
}

fn default_output() -> PathBuf {
    "assets".into()
}

impl From<Whole> for Content {
    fn from(whole: Whole) -> Self {
        let Whole { title, address, output, source, run, overrides, .. } = whole;
        let Whole { scan, bake, packing, verify, photometric, report, .. } = whole;
        let Whole { thumbnail, turntable, viewer, require, .. } = whole;
        let made =
            Made { scan, bake, packing, verify, photometric, report, thumbnail, turntable, viewer, require };
        let overrides = overrides.into_iter().map(Override::of).collect();
        Self { title, address, output, source, made, run, overrides }
    }
}

impl Content {
    /// Checks everything that deserialising cannot.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Parse`] with the line.
    pub fn check(&self, lines: Lines<'_>) -> Result<()> {
        if self.source.is_empty() {
            return Err(
                lines.parse(0..0, "name at least one [[source]]: a folder, photographs, a glob or a list")
            );
        }
        for source in &self.source {
            let Source { folder, photographs, glob, list } = source.get_ref();
            let keys = [folder.is_some(), photographs.is_some(), glob.is_some(), list.is_some()];
            if keys.iter().filter(|is_set| **is_set).count() != 1 {
                let what = "a source must be one of `folder`, `photographs`, `glob` and `list`";
                return Err(lines.parse(source.span(), what));
            }
            if let Some(Err(error)) = glob.as_deref().map(Pattern::new) {
                return Err(lines.parse(source.span(), &format!("glob: {error}")));
            }
        }
        self.run.check(lines)
    }

    /// Returns the position of the options for all scans.
    pub fn span_of_choices(&self) -> Range<usize> {
        let Made { scan, bake, packing, verify, photometric, .. } = &self.made;
        let tables = [scan, bake, packing, verify, photometric];
        let keys = tables.into_iter().flatten().flat_map(|keys| keys.keys()).map(Spanned::span);
        keys.min_by_key(|span| span.start).unwrap_or(0..0)
    }
}

impl Override {
    fn of(read: Spanned<OneOverride>) -> Self {
        let span = read.span();
        let read = read.into_inner();
        let OneOverride { id, scan, bake, packing, verify, photometric, report, .. } = read;
        let OneOverride { thumbnail, turntable, viewer, require, .. } = read;
        let made =
            Made { scan, bake, packing, verify, photometric, report, thumbnail, turntable, viewer, require };
        Self { id, made: Spanned::new(span, made) }
    }

    /// Returns the id pattern.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Parse`] with the line.
    pub fn pattern(&self, lines: Lines<'_>) -> Result<Pattern> {
        Pattern::new(self.id.get_ref()).map_err(|error| lines.parse(self.id.span(), &format!("id: {error}")))
    }

    /// Returns true if a pattern covers an id: `*` stays within a folder, `**` does not.
    pub fn covers(pattern: &Pattern, id: &str) -> bool {
        let options = MatchOptions { require_literal_separator: true, ..MatchOptions::default() };
        pattern.matches_with(id, options)
    }
}

impl Run {
    fn check(&self, lines: Lines<'_>) -> Result<()> {
        if let Some(jobs) = self.jobs.as_ref().filter(|jobs| *jobs.get_ref() == 0) {
            return Err(lines.parse(jobs.span(), "jobs: use at least one process"));
        }
        if let Some(memory) = &self.memory {
            let read = memory.get_ref().parse::<Bytes>();
            read.map_err(|error| lines.parse(memory.span(), &format!("memory: {error}")))?;
        }
        if let Some(time) = &self.time_limit {
            duration(time.get_ref())
                .map_err(|why| lines.parse(time.span(), &format!("time_limit: {why}")))?;
        }
        Ok(())
    }

    /// Returns the checked settings.
    pub fn settings(&self) -> RunSettings {
        RunSettings {
            jobs: self.jobs.as_ref().map(|jobs| *jobs.get_ref()),
            memory: self.memory.as_ref().and_then(|memory| memory.get_ref().parse().ok()),
            time_limit: self.time_limit.as_ref().and_then(|time| duration(time.get_ref()).ok()),
        }
    }
}

/// Reads a time such as `90s`, `15m`, `2h` or `1h30m`; a bare number is seconds.
///
/// # Errors
/// A message.
pub fn duration(text: &str) -> std::result::Result<Duration, String> {
    let wrong = || format!("invalid time `{text}`: use e.g. 90s, 15m, 2h or 1h30m");
    let (mut seconds, mut number) = (0.0, String::new());
    for letter in text.trim().chars() {
        let unit = match letter {
            '0'..='9' | '.' => {
                number.push(letter);
                continue;
            }
            's' => 1.0,
            'm' => 60.0,
            'h' => 3600.0,
            'd' => 86_400.0,
            _ => return Err(wrong()),
        };
        seconds += std::mem::take(&mut number).parse::<f64>().map_err(|_| wrong())? * unit;
    }
    if !number.is_empty() {
        seconds += number.parse::<f64>().map_err(|_| wrong())?;
    }
    let known = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    known.ok_or_else(wrong)
}

/// The text of a file, for converting positions to lines.
#[derive(Debug, Clone, Copy)]
pub struct Lines<'a> {
    /// The whole text.
    pub text: &'a str,
    /// Its file.
    pub path: &'a Path,
}

impl Lines<'_> {
    /// Reads the file's text.
    ///
    /// # Errors
    /// [`Error::Parse`] with the line.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T> {
        toml::from_str(self.text).map_err(|error| self.of(&error))
    }

    fn of(&self, error: &toml::de::Error) -> Error {
        self.parse(error.span().unwrap_or(0..0), error.message())
    }

    /// Returns an error at a position in the text.
    pub fn parse(&self, span: Range<usize>, what: &str) -> Error {
        let before = self.text.get(..span.start).unwrap_or_default();
        Error::parse(self.path, format!("line {}", before.matches('\n').count() + 1), what.replace('\n', " "))
    }

    /// Returns an error about values at a position in the text.
    pub fn within(&self, span: Range<usize>, error: Error) -> Error {
        self.parse(span, &error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_people_write_them() {
        let seconds = |text: &str| duration(text).ok().map(|time| time.as_secs_f64());
        assert_eq!((seconds("90"), seconds(" 90s"), seconds("1.5m")), (Some(90.0), Some(90.0), Some(90.0)));
        assert_eq!((seconds("1h30m"), seconds("2d")), (Some(5400.0), Some(172_800.0)));
        for wrong in ["", "0", "m", "5x", "-1", "1h soon", "1e999", "999999999999999999999d"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_star_stays_within_a_folder() {
        let covers = |pattern: &str, id: &str| Override::covers(&Pattern::new(pattern).unwrap(), id);
        assert!(covers("a/*", "a/b.ply") && !covers("a/*", "a/b/c.ply") && covers("a/**", "a/b/c.ply"));
        assert!(covers("**/*.obj", "x.obj") && !covers("*.obj", "x.ply"));
    }
}
