//! A collection whose processes others start, on other machines too: its plan, and its books.

use super::books::{Books, Took};
use super::plan::{Plan, Todo};
use super::{DriveOptions, Summary, ended, ledger, nonempty};
use crate::collection::Collection;
use crate::job::{Job, Outcome};
use crate::record::Record;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;
use taotie::asset::Limits;
use taotie::{Error, Result};

/// A collection whose processes others start. Nobody else writes to its manifest meanwhile.
pub struct Remote {
    books: Books,
    todo: BTreeMap<String, Todo>,
    /// The jobs to be done, the largest first.
    pub planned: Vec<Planned>,
    summary: Summary,
    ids: Vec<String>,
}

/// A job that others start.
#[derive(Debug, Clone, Serialize)]
pub struct Planned {
    /// The job, to be written to the process as a line of JSON.
    pub job: Job,
    /// The folder that its process runs in.
    pub folder: PathBuf,
    /// The memory of reading its scan, until its forecast is known.
    pub reading: u64,
}

/// What became of a job that others started.
#[derive(Debug, Clone, Deserialize)]
pub struct Told {
    /// The asset.
    pub id: String,
    /// What its process said at its end; nothing where it did not come to that.
    pub outcome: Option<Outcome>,
    /// Why it did not.
    pub error: Option<String>,
    /// The time it took.
    pub seconds: f64,
    /// The memory that it foresaw.
    pub forecast: Option<u64>,
}

impl Remote {
    /// Opens the books of a collection, and plans what is to be done. `threads` is the most that a job will get.
    ///
    /// # Errors
    /// As [`super::drive`].
    pub fn open(collection: &Collection, options: &DriveOptions, threads: usize) -> Result<Self> {
        let found = collection.scans()?;
        let mut books = Books::open(collection.output(), options.shard)?;
        let plan = Plan::of(collection, &found.scans, &books, options)?;
        let mut summary = Summary { known: plan.known, warnings: found.warnings, ..Summary::default() };
        for record in &plan.judged {
            books.add(record)?;
            summary.attempts += 1;
        }
        let limits =
            Limits { memory: options.memory, allow_outside: options.allow_outside, ..Limits::default() };
        let folder = nonempty(collection.folder());
        let folder = folder.canonicalize().map_err(|e| Error::io(&folder, e))?;
        let planned = |todo: &Todo| Planned {
            job: Job {
                id: todo.scan.id.clone(),
                scan: todo.scan.path.clone(),
                output: collection.relative_output().to_path_buf(),
                settings: todo.settings.clone(),
                limits,
                threads,
                reuse: true,
            },
            folder: folder.clone(),
            reading: ledger::reading(todo.bytes),
        };
        let planned = plan.todo.iter().map(planned).collect();
        let todo = plan.todo.into_iter().map(|todo| (todo.scan.id.clone(), todo)).collect();
        Ok(Self { books, todo, planned, summary, ids: plan.ids })
    }

    /// Writes down what became of a job; returns the record.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a job that was not planned, or was told of before; those of writing.
    pub fn add(&mut self, told: Told) -> Result<Record> {
        let Told { id, outcome, error, seconds, forecast } = told;
        let todo = self.todo.remove(&id);
        let todo = todo.ok_or_else(|| Error::invalid(id, "no such job is waited for"))?;
        let lost = || ended::failed(error.unwrap_or_else(|| "its process ended without a word".into()));
        let outcome = outcome.unwrap_or_else(lost);
        let record = self.books.record(todo, outcome, Took { seconds, forecast });
        self.books.add(&record)?;
        self.summary.attempts += 1;
        Ok(record)
    }

    /// Returns what became of the collection.
    pub fn summary(&self) -> Summary {
        let mut summary = Summary { states: self.books.states(&self.ids), ..self.summary.clone() };
        summary.warnings.absorb(self.books.warnings.clone());
        summary
    }
}
