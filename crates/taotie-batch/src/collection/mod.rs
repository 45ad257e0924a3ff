//! `collection.toml`: where the scans of a collection lie, and what is made of them.

mod content;
mod list;
mod sources;
mod tables;

use crate::settings::Settings;
use content::{Content, Override};
use glob::Pattern;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tables::Choices;
use taotie::asset::Bytes;
use taotie::io::read_bytes;
use taotie::{Error, Result, Warnings};

pub use content::duration;
pub use sources::Scan;

/// A collection as its file describes it, checked.
#[derive(Debug)]
pub struct Collection {
    path: PathBuf,
    content: Content,
    choices: Choices,
    overrides: Vec<(Pattern, Choices)>,
}

/// How a collection is worked through, where its file says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunSettings {
    /// The most processes at once.
    pub jobs: Option<usize>,
    /// The most memory of all processes.
    pub memory: Option<Bytes>,
    /// The longest time for an asset.
    pub time_limit: Option<Duration>,
}

/// The scans of a collection, and what was wrong with its lists.
#[derive(Debug, Default)]
pub struct Found {
    /// The scans, by id.
    pub scans: Vec<Scan>,
    /// What is not read of lists.
    pub warnings: Warnings,
}

impl Collection {
    /// Reads a collection's file, and checks all of it.
    ///
    /// # Errors
    /// [`Error::Parse`] with the line; [`Error::Io`] where a file is not there.
    pub fn read(path: &Path) -> Result<Self> {
        let text = String::from_utf8(read_bytes(path)?).map_err(|error| {
            let at = format!("byte {}", error.utf8_error().valid_up_to());
            Error::parse(path, at, "it is not text in UTF-8")
        })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a collection's file, whose paths are relative to the folder of `path`.
    ///
    /// # Errors
    /// As [`Collection::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let lines = tables::Lines { text, path };
        let content: Content = lines.read()?;
        let choices = Choices::of(&content.made, lines)?;
        let mut overrides = Vec::with_capacity(content.overrides.len());
        for one in &content.overrides {
            overrides.push((one.pattern(lines)?, Choices::of(one.made.get_ref(), lines)?));
        }
        let read = Self { path: path.to_path_buf(), content, choices, overrides };
        read.check(lines)?;
        Ok(read)
    }

    /// Checks every set of settings that may come to be.
    fn check(&self, lines: tables::Lines<'_>) -> Result<()> {
        self.content.check(lines)?;
        let checked = |settings: Result<Settings>| self.checked(settings?).map(drop);
        checked(self.combined(&[])).map_err(|error| lines.within(self.content.span_of_choices(), error))?;
        for (one, (_, choices)) in self.content.overrides.iter().zip(&self.overrides) {
            checked(self.combined(&[choices])).map_err(|error| lines.within(one.made.span(), error))?;
        }
        Ok(())
    }

    /// Returns the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the folder of the file, from which all paths start.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Returns the folder that everything is written to.
    pub fn output(&self) -> PathBuf {
        self.folder().join(self.relative_output())
    }

    /// Returns the same folder as the collection's file says it.
    pub fn relative_output(&self) -> &Path {
        &self.content.output
    }

    /// Returns the collection's name, as its page shows it.
    pub fn title(&self) -> String {
        let own = || self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.content.title.clone().unwrap_or_else(own)
    }

    /// Returns where the collection is published, an address of the web; `None` where that is not said.
    pub fn address(&self) -> Option<&str> {
        self.content.address.as_deref()
    }

    /// Returns how the collection is worked through.
    pub fn run(&self) -> RunSettings {
        self.content.run.settings()
    }

    /// Looks for the scans.
    ///
    /// # Errors
    /// [`Error::Io`] where a folder or a list is not there; [`Error::Invalid`] where two scans have one id, or there is
    /// none at all.
    pub fn scans(&self) -> Result<Found> {
        sources::find(&self.content.source, self.folder(), &self.output())
    }

    /// Returns what is made of the asset with this id: later overrides go before earlier ones. Paths in it are relative
    /// to the collection's folder.
    ///
    /// # Errors
    /// [`Error::Invalid`] where overrides contradict one another.
    pub fn settings(&self, id: &str) -> Result<Settings> {
        let chosen = self.overrides.iter().filter(|(pattern, _)| Override::covers(pattern, id));
        let chosen: Vec<_> = chosen.map(|(_, choices)| choices).collect();
        let settings = self.combined(&chosen)?;
        if chosen.len() < 2 {
            return Ok(settings);
        }
        self.checked(settings).map_err(|error| error.within(id))
    }

    /// Returns the patterns of overrides that cover none of these ids.
    pub fn unused_overrides(&self, scans: &[Scan]) -> Vec<&str> {
        let covers_none = |pattern: &&Pattern| !scans.iter().any(|scan| Override::covers(pattern, &scan.id));
        self.overrides.iter().map(|(pattern, _)| pattern).filter(covers_none).map(Pattern::as_str).collect()
    }

    fn checked(&self, settings: Settings) -> Result<Settings> {
        settings.clone().in_folder(self.folder()).check().map(|()| settings)
    }

    fn combined(&self, further: &[&Choices]) -> Result<Settings> {
        tables::settings(std::iter::once(&self.choices).chain(further.iter().copied()))
    }
}
