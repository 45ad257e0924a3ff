//! Tables of options. They are read twice: into the library's own structs, whose errors carry the line, and as raw
//! tables, to be merged.

use super::content::{Keys, Lines, Made, Switch};
use super::sources::Kind;
use crate::settings::{AssetSettings, PhotometricSettings, Settings, Task, Thumbnail, Turntable, ViewerPage};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use taotie::asset::{BakeOptions, Packing, Requirement, ScanOptions, VerifyOptions};
use taotie_engine::{Error, Result};
use taotie_photometric::PhotometricOptions;
use toml::{Spanned, Table, Value};

/// The options that one part of a collection's file sets.
#[derive(Debug, Clone, Default)]
pub struct Choices {
    scan: Table,
    bake: Table,
    packing: Table,
    verify: Table,
    photometric: Table,
    report: Option<bool>,
    thumbnail: Option<Switch>,
    turntable: Option<Switch>,
    viewer: Option<Switch>,
    require: Option<Vec<Requirement>>,
}

/// The same file as the library's own structs: their errors carry the line.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Typed {
    #[serde(rename = "scan")]
    _scan: ScanOptions,
    #[serde(rename = "bake")]
    _bake: BakeOptions,
    #[serde(rename = "packing")]
    _packing: Packing,
    #[serde(rename = "verify")]
    _verify: VerifyOptions,
    #[serde(rename = "photometric")]
    _photometric: PhotometricOptions,
    #[serde(rename = "override")]
    _overrides: Vec<Self>,
}

/// Checks that the library's own structs accept the values.
///
/// # Errors
/// [`Error::Parse`] with the line.
pub fn check(lines: Lines<'_>) -> Result<()> {
    lines.read::<Typed>().map(drop)
}

impl Choices {
    /// Reads the options that one part of the file sets.
    ///
    /// # Errors
    /// [`Error::Parse`] with the line.
    pub fn of(made: &Made, lines: Lines<'_>) -> Result<Self> {
        let requirement = |text: &Spanned<String>| {
            let read = Requirement::read(text.get_ref());
            read.map_err(|error| lines.parse(text.span(), &error.to_string()))
        };
        let require = made.require.as_ref().map(|list| {
            let read = list.iter().map(requirement).collect::<Result<Vec<_>>>()?;
            Ok::<_, Error>(read.concat())
        });
        let choices = Self {
            scan: known::<ScanOptions>(lines, ("scan", &made.scan))?,
            bake: known::<BakeOptions>(lines, ("bake", &made.bake))?,
            packing: known::<Packing>(lines, ("packing", &made.packing))?,
            verify: known::<VerifyOptions>(lines, ("verify", &made.verify))?,
            photometric: known::<PhotometricOptions>(lines, ("photometric", &made.photometric))?,
            report: made.report,
            thumbnail: made.thumbnail.as_ref().map(|switch| switch.get_ref().clone()),
            turntable: made.turntable.as_ref().map(|switch| switch.get_ref().clone()),
            viewer: made.viewer.as_ref().map(|switch| switch.get_ref().clone()),
            require: require.transpose()?,
        };
        let spans = [&made.thumbnail, &made.turntable, &made.viewer];
        let parts = [
            part::<Thumbnail>(&[&choices.thumbnail]).map(drop),
            part::<Turntable>(&[&choices.turntable]).map(drop),
            part::<ViewerPage>(&[&choices.viewer]).map(drop),
        ];
        for (read, at) in parts.into_iter().zip(spans) {
            let span = at.as_ref().map_or(0..0, Spanned::span);
            read.map_err(|error| lines.parse(span, error.message()))?;
        }
        Ok(choices)
    }

    /// Returns the keys that are set but have no effect on objects of a kind.
    pub fn unused_by(&self, kind: Kind) -> Vec<Unused> {
        let table = |key, table: &Table| (!table.is_empty()).then_some(Unused { key, is_table: true });
        let other = |key, is_set: bool| is_set.then_some(Unused { key, is_table: false });
        let is_on = |switch: &Option<Switch>| !matches!(switch, None | Some(Switch::Is(false)));
        let keys = match kind {
            Kind::Scan => vec![table("[photometric]", &self.photometric)],
            Kind::Photographs => vec![
                table("[scan]", &self.scan),
                table("[bake]", &self.bake),
                table("[packing]", &self.packing),
                table("[verify]", &self.verify),
                other("turntable", is_on(&self.turntable)),
                other("require", self.require.as_ref().is_some_and(|list| !list.is_empty())),
            ],
        };
        keys.into_iter().flatten().collect()
    }
}

/// A key that has no effect on a kind of object.
pub struct Unused {
    /// The key as the file has it.
    pub key: &'static str,
    /// True for a table that is meant for the other kind.
    pub is_table: bool,
}

/// Refuses keys that a struct does not have; returns the table.
fn known<T: Default + Serialize>(lines: Lines<'_>, (name, table): (&str, &Option<Keys>)) -> Result<Table> {
    let known = serde_json::to_value(T::default()).unwrap_or_default();
    let known: Vec<&String> = known.as_object().map(|map| map.keys().collect()).unwrap_or_default();
    let keys = table.iter().flatten();
    let read = |(key, value): (&Spanned<String>, &Value)| match known.contains(&key.get_ref()) {
        true => Ok((key.get_ref().clone(), value.clone())),
        false => {
            let known = known.iter().map(|key| key.as_str()).collect::<Vec<_>>().join(", ");
            let what = format!("unknown key `{}` in [{name}]; expected one of {known}", key.get_ref());
            Err(lines.parse(key.span(), &what))
        }
    };
    keys.map(read).collect()
}

/// Merges choices for an object of a kind; later ones take precedence. Photographs have no turntable and no requirements.
///
/// # Errors
/// [`Error::Invalid`] if they contradict one another.
pub fn settings<'a>(choices: impl Iterator<Item = &'a Choices>, kind: Kind) -> Result<Settings> {
    let choices: Vec<_> = choices.collect();
    let wrong = |error: toml::de::Error| Error::invalid("options", error.message().replace('\n', " "));
    let report = choices.iter().rev().find_map(|choices| choices.report).unwrap_or(true);
    let require = choices.iter().rev().find_map(|choices| choices.require.clone());
    let task = match kind {
        Kind::Scan => Task::Bake(Box::new(AssetSettings {
            scan: table(choices.iter().map(|choices| &choices.scan)).map_err(wrong)?,
            bake: bake_options(&choices).map_err(wrong)?,
            packing: table(choices.iter().map(|choices| &choices.packing)).map_err(wrong)?,
            verify: table(choices.iter().map(|choices| &choices.verify)).map_err(wrong)?,
            report,
        })),
        Kind::Photographs => Task::Photometric(PhotometricSettings {
            options: table(choices.iter().map(|choices| &choices.photometric)).map_err(wrong)?,
            report,
        }),
    };
    let is_scan = kind == Kind::Scan;
    Ok(Settings {
        task,
        thumbnail: part_or(&choices, |choices| &choices.thumbnail, true).map_err(wrong)?,
        turntable: part_or(&choices, |choices| &choices.turntable, false).map_err(wrong)?.filter(|_| is_scan),
        viewer: part_or(&choices, |choices| &choices.viewer, false).map_err(wrong)?,
        require: require.filter(|_| is_scan).unwrap_or_default(),
    })
}

/// Merges the options of a bake. As with `taotie bake`, the default is a search for the smallest asset that is visually
/// lossless, unless the asset's size or packing is set, or no search can judge it.
fn bake_options(choices: &[&Choices]) -> std::result::Result<BakeOptions, toml::de::Error> {
    /// The keys of `[bake]` that set a search or the asset's size.
    const SIZED: [&str; 7] = ["goal", "bytes", "triangles", "size", "height", "sizes", "bits"];
    let is_sized = |choices: &&Choices| {
        let packs = choices.packing.keys().any(|key| key != "provenance");
        packs || SIZED.iter().any(|key| choices.bake.contains_key(*key))
    };
    let mut options: BakeOptions = table(choices.iter().map(|choices| &choices.bake))?;
    if options.may_search() && !choices.iter().any(is_sized) {
        options.goal = Some(Requirement::visually_lossless());
    }
    Ok(options)
}

fn table<'a, T: DeserializeOwned>(
    tables: impl Iterator<Item = &'a Table>,
) -> std::result::Result<T, toml::de::Error> {
    tables.flatten().map(|(key, value)| (key.clone(), value.clone())).collect::<Table>().try_into()
}

fn part_or<T: DeserializeOwned + Default>(
    choices: &[&Choices],
    of: fn(&Choices) -> &Option<Switch>,
    by_default: bool,
) -> std::result::Result<Option<T>, toml::de::Error> {
    let base = Some(Switch::Is(by_default));
    let all: Vec<_> = std::iter::once(&base).chain(choices.iter().map(|choices| of(choices))).collect();
    part(&all)
}

/// Merges the switches of an optional part.
fn part<T: DeserializeOwned + Default>(
    switches: &[&Option<Switch>],
) -> std::result::Result<Option<T>, toml::de::Error> {
    let mut made = None;
    for switch in switches.iter().filter_map(|switch| switch.as_ref()) {
        made = match switch {
            Switch::Is(false) => None,
            Switch::Is(true) => Some(made.unwrap_or_default()),
            Switch::With(table) => {
                let mut below: Table = made.unwrap_or_default();
                below.extend(table.clone());
                Some(below)
            }
        };
    }
    made.map(Table::try_into).transpose()
}
