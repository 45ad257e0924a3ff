//! The known state of a collection, and where it is recorded.

use super::todo::Todo;
use crate::address::VERSION;
use crate::job::Outcome;
use crate::manifest::{History, Manifest, Shard};
use crate::record::{Record, SCHEMA, State};
use crate::store::Store;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};
use taotie_engine::{Result, Warnings};

/// The known state of a collection, and where it is recorded.
pub struct Books {
    /// The files.
    pub store: Store,
    manifest: Manifest,
    /// The content of all manifests.
    pub history: History,
    /// Malformed manifest lines, and links that could not be created.
    pub warnings: Warnings,
}

/// The resources that a process used.
#[derive(Debug, Clone, Copy, Default)]
pub struct Took {
    /// Time, in seconds.
    pub seconds: f64,
    /// Memory, as estimated beforehand.
    pub forecast: Option<u64>,
}

impl Books {
    /// Opens the manifest, and reads all manifests.
    ///
    /// # Errors
    /// As [`Manifest::open`] and [`History::read`].
    pub fn open(root: PathBuf, shard: Option<Shard>) -> Result<Self> {
        let store = Store::new(root);
        store.make()?;
        let manifest = Manifest::open(&Manifest::path_of(store.root(), shard))?;
        let history = History::read(store.root())?;
        let warnings = history.warnings.clone();
        Ok(Self { store, manifest, history, warnings })
    }

    /// Returns the record of an attempt that has ended.
    pub fn record(&self, todo: Todo, outcome: Outcome, took: Took) -> Record {
        let input = if outcome.input.is_empty() { todo.input } else { outcome.input };
        Record {
            schema: SCHEMA,
            attempt: 1 + self.history.last.get(&todo.scan.id).map_or(0, |last| last.attempt),
            id: todo.scan.id,
            ended: now(),
            version: VERSION.into(),
            settings: todo.settings_hash,
            state: outcome.state,
            error: outcome.error,
            title: todo.scan.title,
            input,
            seconds: took.seconds,
            stages: outcome.stages,
            peak_bytes: outcome.peak_bytes,
            forecast_bytes: took.forecast,
            figures: outcome.figures,
            require: todo.settings.require,
            required: outcome.required,
            warnings: outcome.warnings,
            parts: outcome.parts,
        }
    }

    /// Appends a record to the manifest, and creates links to the files it names. On a file system without links that
    /// is only a warning: the objects exist.
    ///
    /// # Errors
    /// Write errors.
    pub fn add(&mut self, record: &Record) -> Result<()> {
        if record.state.is_made()
            && let Err(error) = self.store.link(&record.id, &record.parts)
        {
            self.warnings.note(format!("could not create a link: {error}"), 1);
        }
        self.manifest.add(record)?;
        self.history.add(record.clone());
        Ok(())
    }

    /// Counts the latest states of these assets.
    pub fn states(&self, ids: &[String]) -> BTreeMap<State, usize> {
        let mut states = BTreeMap::new();
        for record in ids.iter().filter_map(|id| self.history.last.get(id)) {
            *states.entry(record.state).or_default() += 1;
        }
        states
    }
}

/// Returns the seconds since 1970.
pub fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
