//! Making an asset again, to compare it with the existing one.

use super::process::{Heard, Start, Worker};
use super::{POLL, nonempty};
use crate::collection::Collection;
use crate::job::{Job, Message, Outcome};
use crate::record::Record;
use std::sync::mpsc::{self, RecvTimeoutError};
use taotie::asset::Limits;
use taotie_engine::{Error, Result};

/// Makes an asset again in a temporary folder. `hear` returns true to go on.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Io`] if the folder or the process cannot be created.
pub fn remake(
    record: &Record,
    collection: &Collection,
    worker: &Worker,
    hear: &mut dyn FnMut(f64) -> bool,
) -> Result<Outcome> {
    let root = collection.output();
    let place = tempfile::Builder::new().prefix(".taotie-proof-").tempdir_in(&root);
    let place = place.map_err(|e| Error::io(&root, e))?;
    let output = place.path().canonicalize().map_err(|e| Error::io(place.path(), e))?;
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let scan = record.input.first().map(|file| file.path.clone()).unwrap_or_default();
    let job = Job {
        id: record.id.clone(),
        scan,
        output,
        settings: collection.settings(&record.id)?,
        limits: Limits::default().or_free(),
        threads,
        reuse: false,
    };
    let (sender, heard) = mpsc::channel();
    let folder = nonempty(collection.folder());
    let started = Start { worker, folder: &folder, number: 0 }.process(&job, &sender);
    let mut process = started.map_err(|e| Error::io(&worker.program, e))?;
    let mut outcome = None;
    loop {
        match heard.recv_timeout(POLL) {
            Ok(Heard { said: Some(Message::Forecast { .. }), .. }) => process.go(threads),
            Ok(Heard { said: Some(Message::Ended(ended)), .. }) => outcome = Some(*ended),
            Ok(Heard { said: Some(_), .. }) | Err(RecvTimeoutError::Timeout) => {}
            Ok(Heard { said: None, .. }) | Err(RecvTimeoutError::Disconnected) => break,
        }
        if !hear(1.0) {
            process.end();
            return Err(Error::Cancelled);
        }
    }
    let ended = process.wait().map_err(|e| Error::io(&worker.program, e))?;
    let lost = || Error::invalid(&record.id, format!("its process ended without a result: {}", ended.1));
    outcome.ok_or_else(lost)
}
