//! A collection whose processes are started by others, possibly on other machines: its plan and its books.

use super::Summary;
use super::plan::{Books, DriveOptions, Plan, Todo, Took};
use super::process::nonempty;
use super::running::memory_to_read;
use crate::collection::Collection;
use crate::job::{Job, Outcome};
use crate::record::Record;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;
use taotie::Limits;
use taotie_engine::{Error, Result};

/// A collection whose processes are started by others. It has exclusive write access to its manifest.
pub struct Remote {
    books: Books,
    todo: BTreeMap<String, Todo>,
    /// The jobs to be done, largest first.
    pub planned: Vec<Planned>,
    /// The records that stay as they are, of assets that are not done.
    pub kept: Vec<Record>,
    summary: Summary,
    ids: Vec<String>,
}

/// A job to be started by others.
#[derive(Debug, Clone, Serialize)]
pub struct Planned {
    /// The job, to be sent to the process as a line of JSON.
    pub job: Job,
    /// The working folder of its process.
    pub folder: PathBuf,
    /// The memory for reading its scan, until its estimate is known.
    pub reading: u64,
}

/// The outcome of a job that was started by others.
#[derive(Debug, Clone, Deserialize)]
pub struct Told {
    /// The asset.
    pub id: String,
    /// The final message of its process; `None` if it did not get that far.
    pub outcome: Option<Outcome>,
    /// Why it did not get that far.
    pub error: Option<String>,
    /// The time it took.
    pub seconds: f64,
    /// Its memory, as it estimated it.
    pub forecast: Option<u64>,
}

impl Remote {
    /// Opens the books of a collection and plans the outstanding work. `threads` is the most that a job will get.
    ///
    /// # Errors
    /// As [`super::drive`].
    pub fn open(collection: &Collection, options: &DriveOptions, threads: usize) -> Result<Self> {
        let found = collection.scans()?;
        let mut books = Books::open(collection.output(), options.shard)?;
        let plan = Plan::of(collection, &found.scans, &books, options)?;
        let mut summary = Summary { known: plan.known, warnings: found.warnings, ..Summary::default() };
        summary.warnings.absorb(collection.unused_options(&found.scans));
        for record in &plan.settled {
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
            reading: memory_to_read(todo.bytes_at_once()),
        };
        let planned = plan.todo.iter().map(planned).collect();
        let todo = plan.todo.into_iter().map(|todo| (todo.scan.id.clone(), todo)).collect();
        Ok(Self { books, todo, planned, kept: plan.kept, summary, ids: plan.ids })
    }

    /// Records the outcome of a job; returns the record.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a job that was not planned, or has been reported before; write errors.
    pub fn add(&mut self, report: Told) -> Result<Record> {
        let Told { id, outcome, error, seconds, forecast } = report;
        let todo = self.todo.remove(&id);
        let todo = todo.ok_or_else(|| Error::invalid(id, "not a pending job"))?;
        let lost = || Outcome::failed(error.unwrap_or_else(|| "its process ended without a result".into()));
        let outcome = outcome.unwrap_or_else(lost);
        let record = self.books.record(todo, outcome, Took { seconds, forecast });
        self.books.add(&record)?;
        self.summary.attempts += 1;
        Ok(record)
    }

    /// Returns the outcome of the work on the collection.
    pub fn summary(&self) -> Summary {
        let mut summary = Summary { states: self.books.states(&self.ids), ..self.summary.clone() };
        summary.warnings.absorb(self.books.warnings.clone());
        summary
    }
}
