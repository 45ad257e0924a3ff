//! The audit: checks the written files against the manifest.

use crate::collection::Collection;
use crate::driver::{Worker, nonempty, remake};
use crate::manifest::History;
use crate::record::{OUTDATED, Part, Record};
use crate::store::Store;
use taotie_engine::Result;
use taotie_io::sha256;

/// How thorough an audit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AuditOptions {
    /// The number of assets to bake and prove again, and to compare with the existing files byte by byte.
    pub proofs: usize,
}

/// Something that differs from the manifest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The asset.
    pub id: String,
    /// A sentence.
    pub what: String,
}

/// The result of an audit.
#[derive(Debug, Clone, Default)]
pub struct Audit {
    /// Assets checked.
    pub assets: usize,
    /// Files whose bytes were read.
    pub files: usize,
    /// Assets that were baked again.
    pub proofs: usize,
    /// The faults found.
    pub faults: Vec<Fault>,
}

/// Reads every file that the manifest names, and bakes some assets again. `hear` receives the fraction done, and
/// returns true to go on.
///
/// # Errors
/// [`taotie_engine::Error::Cancelled`]; those of the manifest.
pub fn audit(
    collection: &Collection,
    options: &AuditOptions,
    worker: &Worker,
    hear: &mut dyn FnMut(f64) -> bool,
) -> Result<Audit> {
    let store = Store::new(collection.output());
    let history = History::read(store.root())?;
    let made: Vec<_> = history.last.values().filter(|record| record.state.is_made()).collect();
    let mut audit = Audit { assets: made.len(), ..Audit::default() };
    for (index, record) in made.iter().enumerate() {
        if !hear(index as f64 / made.len() as f64) {
            return Err(taotie_engine::Error::Cancelled);
        }
        if !record.is_current() {
            audit.note(record, OUTDATED.into());
        }
        record.parts.iter().for_each(|part| audit.read(record, part, &store));
    }
    for record in samples(&made, options.proofs) {
        audit.proofs += 1;
        audit.prove(record, collection, worker, hear)?;
    }
    Ok(audit)
}

/// Picks `count` records, spread evenly.
fn samples<'a>(made: &[&'a Record], count: usize) -> impl Iterator<Item = &'a Record> {
    let count = count.min(made.len());
    let picked: Vec<&Record> = (0..count).map(|i| made[i * made.len() / count]).collect();
    picked.into_iter()
}

impl Audit {
    /// Checks the bytes of a part against its hashes.
    fn read(&mut self, record: &Record, part: &Part, store: &Store) {
        for file in &part.files {
            self.files += 1;
            let path = store.path(&part.address).join(&file.name);
            match sha256(&path) {
                Ok(hash) if hash == file.sha256 => {}
                Ok(_) => {
                    self.note(record, format!("{}: contents differ from what was written", path.display()))
                }
                Err(error) => self.note(record, error.to_string()),
            }
        }
    }

    /// Makes an asset again, and compares it with the existing one.
    fn prove(
        &mut self,
        record: &Record,
        collection: &Collection,
        worker: &Worker,
        hear: &mut dyn FnMut(f64) -> bool,
    ) -> Result<()> {
        if !record.has_same_input(&nonempty(collection.folder())) {
            self.note(record, "the scan has changed since; the proof cannot be repeated".into());
            return Ok(());
        }
        let remade = remake(record, collection, worker, hear)?;
        if let Some(error) = remade.error {
            self.note(record, format!("re-baking it failed: {error}"));
            return Ok(());
        }
        for part in &record.parts {
            let other = remade.parts.iter().find(|other| other.kind == part.kind);
            match other {
                Some(other) if other.address != part.address => {
                    self.note(
                        record,
                        format!("{}: made from a different scan, or with different settings", part.kind),
                    );
                }
                Some(other) if other.files != part.files => {
                    self.note(record, format!("{}: the re-baked bytes differ", part.kind));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn note(&mut self, record: &Record, what: String) {
        self.faults.push(Fault { id: record.id.clone(), what });
    }
}
