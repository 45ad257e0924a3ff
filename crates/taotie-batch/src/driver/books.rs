//! What is known of a collection, and where that is written down.

use super::plan::Todo;
use crate::address::VERSION;
use crate::job::Outcome;
use crate::manifest::{History, Manifest, Shard};
use crate::record::{Record, SCHEMA, State};
use crate::store::Store;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};
use taotie::{Result, Warnings};

/// What is known of a collection, and where that is written down.
pub struct Books {
    /// The files.
    pub store: Store,
    manifest: Manifest,
    /// What all manifests say.
    pub history: History,
    /// What was wrong with manifests, and links that could not be made.
    pub warnings: Warnings,
}

/// What a process took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Took {
    /// Time.
    pub seconds: f64,
    /// Memory that was foreseen.
    pub forecast: Option<u64>,
}

impl Books {
    /// Opens the manifest, and reads what all of them say.
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

    /// Writes a record down, and makes the links of what it names. Where a file system has no links, that is a warning:
    /// the objects are there.
    ///
    /// # Errors
    /// Where the system refuses.
    pub fn add(&mut self, record: &Record) -> Result<()> {
        if record.state.is_made()
            && let Err(error) = self.store.link(&record.id, &record.parts)
        {
            self.warnings.note(format!("a link cannot be made: {error}"), 1);
        }
        self.manifest.add(record)?;
        self.history.add(record.clone());
        Ok(())
    }

    /// Returns the last states of these assets, counted.
    pub fn states(&self, ids: &[String]) -> BTreeMap<State, usize> {
        let mut states = BTreeMap::new();
        for record in ids.iter().filter_map(|id| self.history.last.get(id)) {
            *states.entry(record.state).or_default() += 1;
        }
        states
    }
}

/// Returns seconds since 1970.
pub fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
