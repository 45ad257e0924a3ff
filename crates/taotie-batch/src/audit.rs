//! The audit: checks the written files against the manifest.

use crate::collection::Collection;
use crate::driver::{Worker, nonempty, remake};
use crate::manifest::History;
use crate::record::{EstimateFigures, FileEntry, OUTDATED, Part, Record, ShortFigures, State};
use crate::store::{MainObject, Object, Store};
use serde::Serialize;
use serde_json::Value;
use taotie::Warning;
use taotie::asset::RequirementOutcome;
use taotie_engine::Result;
use taotie_io::sha256;

/// How thorough an audit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AuditOptions {
    /// The number of assets to make again, and to compare with the existing files byte by byte.
    pub proofs: usize,
}

/// Something that differs from the manifest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// The asset.
    pub id: String,
    /// A sentence.
    pub what: String,
}

/// The result of an audit.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Audit {
    /// Assets checked.
    pub assets: usize,
    /// Files whose bytes were read.
    pub files: usize,
    /// Assets that were made again.
    pub proofs: usize,
    /// The faults found.
    pub faults: Vec<Fault>,
}

/// Reads every file that the manifest names, and makes some assets again. `hear` receives the fraction done, and
/// returns true to go on.
///
/// # Errors
/// [`taotie_engine::Error::Cancelled`]; as [`History::read_existing`].
pub fn audit(
    collection: &Collection,
    options: &AuditOptions,
    worker: &Worker,
    hear: &mut dyn FnMut(f64) -> bool,
) -> Result<Audit> {
    let store = Store::new(collection.output());
    let history = History::read_existing(store.root())?;
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
        audit.compare(record, &store);
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

/// The findings about an asset, as recorded or as stored with it.
#[derive(Serialize)]
struct Findings<'a> {
    files: &'a [FileEntry],
    figures: Option<&'a ShortFigures>,
    estimated: Option<&'a EstimateFigures>,
    warnings: &'a [Warning],
    state: State,
    required: &'a [RequirementOutcome],
}

fn json(value: &impl Serialize) -> Value {
    serde_json::to_value(value).unwrap_or_default()
}

/// Returns the first difference between two values below `place`; numbers may differ by the rounding of a parser.
fn difference(place: &str, recorded: &Value, other: &Value) -> Option<String> {
    const ROUNDING: f64 = 1e-12;
    match (recorded, other) {
        (Value::Object(a), Value::Object(b)) if a.len() == b.len() => a.iter().find_map(|(key, value)| {
            let place = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
            difference(&place, value, b.get(key).unwrap_or(&Value::Null))
        }),
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(i, (a, b))| difference(&format!("{place}[{i}]"), a, b))
        }
        (Value::Number(a), Value::Number(b)) => {
            let [x, y] = [a, b].map(|number| number.as_f64().unwrap_or(f64::NAN));
            let is_close = (x - y).abs() <= ROUNDING * x.abs().max(y.abs());
            (!is_close).then(|| format!("{place} is {a} in the manifest instead of {b}"))
        }
        (Value::String(a), Value::String(b)) if a != b => {
            Some(format!("{place} is `{a}` in the manifest instead of `{b}`"))
        }
        (a, b) => (a != b).then(|| format!("other {place} in the manifest")),
    }
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

    /// Compares the figures, warnings and verdict of a record with what is stored with its asset.
    fn compare(&mut self, record: &Record, store: &Store) {
        if !record.is_current() {
            return;
        }
        let Some(part) = record.main() else {
            return self.note(record, "its record lists no asset".into());
        };
        let Some(object) = store.description::<MainObject>(&part.address) else {
            let why = "the description of its asset is missing, or not valid JSON; run `taotie batch`";
            return self.note(record, why.into());
        };
        let required = object.evaluate(&record.require);
        let (figures, estimated) = (object.figures(), object.estimated());
        let recorded = Findings {
            files: &part.files,
            figures: record.figures.as_ref(),
            estimated: record.estimated.as_ref(),
            warnings: &record.warnings,
            state: record.state,
            required: &record.required,
        };
        let stored = Findings {
            files: object.files(),
            figures: figures.as_ref(),
            estimated: estimated.as_ref(),
            warnings: object.warnings(),
            state: State::of(&required),
            required: &required,
        };
        if let Some(what) = difference("", &json(&recorded), &json(&stored)) {
            self.note(record, format!("its record and the description of its asset differ: {what}"));
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
            self.note(
                record,
                "the scan or a photograph has changed since; the proof cannot be repeated".into(),
            );
            return Ok(());
        }
        let remade = remake(record, collection, worker, hear)?;
        if let Some(error) = remade.error {
            self.note(record, format!("making it again failed: {error}"));
            return Ok(());
        }
        for part in &record.parts {
            let other = remade.parts.iter().find(|other| other.kind == part.kind);
            match other {
                Some(other) if other.address != part.address => {
                    self.note(
                        record,
                        format!("{}: made from different files, or with different settings", part.kind),
                    );
                }
                Some(other) if other.files != part.files => {
                    self.note(record, format!("{}: the bytes differ when made again", part.kind));
                }
                _ => {}
            }
        }
        let differences = [
            difference("figures", &json(&record.figures), &json(&remade.figures)),
            difference("estimated", &json(&record.estimated), &json(&remade.estimated)),
        ];
        for what in differences.into_iter().flatten() {
            self.note(record, format!("making it again gives other figures: {what}"));
        }
        Ok(())
    }

    fn note(&mut self, record: &Record, what: String) {
        self.faults.push(Fault { id: record.id.clone(), what });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn differences_name_their_place_and_ignore_rounding() {
        let stored = json!({ "figures": { "mean": 1.25, "triangles": [100, 20] }, "state": "done" });
        let differs = |pointer: &str, value: Value| {
            let mut forged = stored.clone();
            *forged.pointer_mut(pointer).unwrap() = value;
            difference("", &forged, &stored)
        };
        assert_eq!(differs("/figures/mean", json!(1.250_000_000_000_000_2)), None);
        let is = |found: Option<String>, text: &str| assert_eq!(found.as_deref(), Some(text));
        is(
            differs("/figures/triangles/1", json!(10)),
            "figures.triangles[1] is 10 in the manifest instead of 20",
        );
        is(differs("/state", json!("failed")), "state is `failed` in the manifest instead of `done`");
        is(differs("/figures", Value::Null), "other figures in the manifest");
    }
}
