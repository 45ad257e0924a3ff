//! `collection.toml`: where the objects of a collection are, and what to make from them.

mod content;
mod sources;
mod tables;

use crate::settings::Settings;
use content::{Content, Lines, Override};
use glob::Pattern;
use std::path::{Path, PathBuf};
use tables::{Choices, Unused};
use taotie_engine::{Error, Result, Warnings};
use taotie_io::read_bytes;

pub use content::{RunSettings, duration};
pub use sources::{Found, Kind, Scan};

/// A collection as described by its file, checked.
#[derive(Debug)]
pub struct Collection {
    path: PathBuf,
    content: Content,
    choices: Choices,
    overrides: Vec<(Pattern, Choices)>,
}

impl Collection {
    /// Reads a collection's file and checks all of it.
    ///
    /// # Errors
    /// [`Error::Parse`] with the line; [`Error::Io`] if a file does not exist.
    pub fn read(path: &Path) -> Result<Self> {
        let text = String::from_utf8(read_bytes(path)?).map_err(|error| {
            let at = format!("byte {}", error.utf8_error().valid_up_to());
            Error::parse(path, at, "not valid UTF-8")
        })?;
        Self::parse(&text, path)
    }

    /// Parses the text of a collection's file; paths are relative to the folder of `path`.
    ///
    /// # Errors
    /// As [`Collection::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let lines = Lines { text, path };
        let content: Content = lines.read()?;
        tables::check(lines)?;
        let choices = Choices::of(&content.made, lines)?;
        let mut overrides = Vec::with_capacity(content.overrides.len());
        for one in &content.overrides {
            overrides.push((one.pattern(lines)?, Choices::of(one.made.get_ref(), lines)?));
        }
        let read = Self { path: path.to_path_buf(), content, choices, overrides };
        read.check(lines)?;
        Ok(read)
    }

    /// Checks every set of settings that can arise.
    fn check(&self, lines: Lines<'_>) -> Result<()> {
        self.content.check(lines)?;
        let checked = |settings: Result<Settings>| self.checked(settings?).map(drop);
        let both = [Kind::Scan, Kind::Photographs];
        for kind in both {
            let own = self.combined(&[], kind);
            checked(own).map_err(|error| lines.within(self.content.span_of_choices(), error))?;
        }
        for (one, (_, choices)) in self.content.overrides.iter().zip(&self.overrides) {
            for kind in both {
                let own = self.combined(&[choices], kind);
                checked(own).map_err(|error| lines.within(one.made.span(), error))?;
            }
        }
        Ok(())
    }

    /// Returns the collection's file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the folder of the file, which all paths are relative to.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Returns the output folder.
    pub fn output(&self) -> PathBuf {
        self.folder().join(self.relative_output())
    }

    /// Returns the output folder as written in the collection's file.
    pub fn relative_output(&self) -> &Path {
        &self.content.output
    }

    /// Returns the collection's title, as its page shows it.
    pub fn title(&self) -> String {
        let own = || self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.content.title.clone().unwrap_or_else(own)
    }

    /// Returns the URL that the collection is published at; `None` if unspecified.
    pub fn address(&self) -> Option<&str> {
        self.content.address.as_deref()
    }

    /// Returns how to run the work on the collection.
    pub fn run(&self) -> RunSettings {
        self.content.run.settings()
    }

    /// Finds the objects.
    ///
    /// # Errors
    /// [`Error::Io`] if a folder or a list does not exist; [`Error::Invalid`] if the ids of two objects are equal or
    /// differ only in case, or if there are none at all.
    pub fn scans(&self) -> Result<Found> {
        sources::find(&self.content.source, self.folder(), &self.output())
    }

    /// Returns the settings of an object: later overrides take precedence. Paths in it are relative to the collection's
    /// folder.
    ///
    /// # Errors
    /// [`Error::Invalid`] if overrides contradict one another.
    pub fn settings(&self, id: &str, kind: Kind) -> Result<Settings> {
        let chosen = self.overrides.iter().filter(|(pattern, _)| Override::covers(pattern, id));
        let chosen: Vec<_> = chosen.map(|(_, choices)| choices).collect();
        let settings = self.combined(&chosen, kind)?;
        if chosen.len() < 2 {
            return Ok(settings);
        }
        self.checked(settings).map_err(|error| error.within(id))
    }

    /// Returns warnings about options without effect: of overrides that cover no object, and of a kind of object that
    /// they do not cover.
    pub fn unused_options(&self, scans: &[Scan]) -> Warnings {
        let mut warnings = Warnings::default();
        note_unused(&self.choices, (&scans.iter().collect::<Vec<_>>(), ""), &mut warnings);
        for (pattern, choices) in &self.overrides {
            let covers = |scan: &&Scan| Override::covers(pattern, &scan.id);
            let covered: Vec<&Scan> = scans.iter().filter(covers).collect();
            if covered.is_empty() {
                warnings.note(format!("the override for `{pattern}` matches no asset"), 1);
            }
            note_unused(choices, (&covered, &format!(" of the override for `{pattern}`")), &mut warnings);
        }
        warnings
    }

    fn checked(&self, settings: Settings) -> Result<Settings> {
        settings.clone().in_folder(self.folder()).check().map(|()| settings)
    }

    fn combined(&self, further: &[&Choices], kind: Kind) -> Result<Settings> {
        tables::settings(std::iter::once(&self.choices).chain(further.iter().copied()), kind)
    }
}

/// Counts the objects on which choices have no effect. A table for one kind of object has one if any of this kind is
/// covered.
fn note_unused(choices: &Choices, (covered, place): (&[&Scan], &str), warnings: &mut Warnings) {
    for (kind, name) in [(Kind::Scan, "scans"), (Kind::Photographs, "photographs")] {
        let count = covered.iter().filter(|scan| scan.kind == kind).count();
        for Unused { key, is_table } in choices.unused_by(kind) {
            let is_meant = is_table && count < covered.len();
            warnings.note(format!("{key}{place} has no effect on {name}"), if is_meant { 0 } else { count });
        }
    }
}
