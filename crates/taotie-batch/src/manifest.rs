//! The manifest: an append-only file with one record per line. It is the only state kept about a collection's work.

use crate::record::Record;
use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result, Warnings};
use taotie_io::read_bytes;

/// The part of a collection that one call works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// The shard's number, from 1.
    pub number: u32,
    /// The number of shards.
    pub count: u32,
}

/// A manifest opened for writing, exclusively.
#[derive(Debug)]
pub struct Manifest {
    path: PathBuf,
    file: File,
}

/// The content of all manifests of a collection.
#[derive(Debug, Default)]
pub struct History {
    /// The latest record of each asset.
    pub last: BTreeMap<String, Record>,
    /// Malformed lines, such as the last line of a driver that was killed while writing it.
    pub warnings: Warnings,
}

impl std::str::FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::invalid(format!("`{text}`"), "write the shard and their number, e.g. 3/8");
        let (number, count) = text.split_once('/').ok_or_else(wrong)?;
        let [number, count] = [number, count].map(|part| part.trim().parse().map_err(|_| wrong()));
        let (number, count) = (number?, count?);
        if number == 0 || number > count {
            return Err(Error::invalid(
                format!("`{text}`"),
                format!("shards are numbered from 1 to {count}"),
            ));
        }
        Ok(Self { number, count })
    }
}

impl Shard {
    /// Returns true if an asset belongs to this shard, which depends only on its id.
    pub fn covers(self, id: &str) -> bool {
        let hash = crate::store::hash_of(&id);
        let start = u64::from_str_radix(&hash[..16], 16).unwrap_or_default();
        start % u64::from(self.count) == u64::from(self.number - 1)
    }
}

impl Manifest {
    /// Returns the file that a call writes to: each shard has a separate one, so that it can be on any file system.
    pub fn path_of(root: &Path, shard: Option<Shard>) -> PathBuf {
        root.join(match shard {
            None => "manifest.jsonl".to_owned(),
            Some(Shard { number, count }) => format!("manifest.{number}-of-{count}.jsonl"),
        })
    }

    /// Opens a manifest, creating it if necessary.
    ///
    /// # Errors
    /// [`Error::Invalid`] if another process is writing to it; [`Error::Io`] if the system refuses.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |e| Error::io(path, e);
        let mut file = File::options().read(true).append(true).create(true).open(path).map_err(failed)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let why = "another `taotie batch` is working on this collection; wait for it, or use --shard";
                return Err(Error::invalid(path.display().to_string(), why));
            }
            // If the file system has no locks, other writers cannot be detected.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        if is_torn(&mut file).map_err(failed)? {
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self { path: path.to_path_buf(), file })
    }

    /// Appends a record; it is on disk when this returns.
    ///
    /// # Errors
    /// [`Error::Io`] if the system refuses; [`Error::Invalid`] for a path that is not UTF-8.
    pub fn add(&mut self, record: &Record) -> Result<()> {
        let line = serde_json::to_string(record);
        let mut line = line.map_err(|error| Error::invalid(&record.id, error.to_string()))?;
        line.push('\n');
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|e| Error::io(&self.path, e))
    }
}

/// Returns true if a file ends in the middle of a line.
fn is_torn(file: &mut File) -> std::io::Result<bool> {
    if file.seek(SeekFrom::End(0))? == 0 {
        return Ok(false);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last != *b"\n")
}

impl History {
    /// Reads all manifests in a collection's folder, including those of shards.
    ///
    /// # Errors
    /// [`Error::Io`] if one cannot be read.
    pub fn read(root: &Path) -> Result<Self> {
        let mut history = Self::default();
        for path in manifests(root)? {
            history.read_file(&path)?;
        }
        Ok(history)
    }

    /// Reads all manifests like [`History::read`], of which there must be one.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is none; as [`History::read`].
    pub fn read_existing(root: &Path) -> Result<Self> {
        if manifests(root)?.is_empty() {
            let why = "no manifest in this folder; run `taotie batch` first, or correct `output` in the collection's file";
            return Err(Error::invalid(root.display().to_string(), why));
        }
        Self::read(root)
    }

    fn read_file(&mut self, path: &Path) -> Result<()> {
        let bytes = read_bytes(path)?;
        for line in bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
            match serde_json::from_slice::<Record>(line) {
                Ok(record) => self.add(record),
                Err(_) => self.warnings.note(format!("{}: skipped a malformed record", path.display()), 1),
            }
        }
        Ok(())
    }

    /// Adds a record, unless a later one is known.
    pub fn add(&mut self, record: Record) {
        let order = |record: &Record| (record.ended, record.attempt);
        match self.last.get(&record.id) {
            Some(known) if order(known) > order(&record) => {}
            _ => drop(self.last.insert(record.id.clone(), record)),
        }
    }
}

fn manifests(root: &Path) -> Result<Vec<PathBuf>> {
    if !root.exists() {
        return Ok(Vec::new());
    }
    let failed = |e| Error::io(root, e);
    let mut found = Vec::new();
    for entry in fs::read_dir(root).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with("manifest.") && name.ends_with("jsonl") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{SCHEMA, State};

    fn record(id: &str, attempt: u32, state: State) -> Record {
        Record {
            schema: SCHEMA,
            id: id.into(),
            attempt,
            ended: 7,
            version: String::new(),
            settings: String::new(),
            state,
            error: None,
            title: None,
            photographs: None,
            input: Vec::new(),
            seconds: 0.0,
            stages: Vec::new(),
            peak_bytes: None,
            forecast_bytes: None,
            figures: None,
            estimated: None,
            points: None,
            require: Vec::new(),
            required: Vec::new(),
            warnings: Vec::new(),
            parts: Vec::new(),
        }
    }

    #[test]
    fn each_asset_is_of_one_shard() {
        let ids: Vec<String> = (0..200).map(|index| format!("room/{index}.ply")).collect();
        let of = |number, count| ids.iter().filter(move |id| Shard { number, count }.covers(id)).count();
        assert_eq!((1..=7).map(|number| of(number, 7)).sum::<usize>(), ids.len());
        assert!((1..=7).all(|number| of(number, 7) > 10), "they are about the same size");
        assert_eq!("3/8".parse::<Shard>().unwrap(), Shard { number: 3, count: 8 });
        for wrong in ["", "3", "0/8", "9/8", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_last_attempt_counts_whatever_file_it_stands_in() {
        let place = tempfile::tempdir().unwrap();
        let shard = Some(Shard { number: 1, count: 2 });
        let open = |shard| Manifest::open(&Manifest::path_of(place.path(), shard)).unwrap();
        open(None).add(&record("a", 1, State::Failed)).unwrap();
        open(shard).add(&record("a", 2, State::Done)).unwrap();
        open(None).add(&record("b", 1, State::Refused)).unwrap();
        let history = History::read(place.path()).unwrap();
        let states: Vec<_> = history.last.iter().map(|(id, record)| (id.as_str(), record.state)).collect();
        assert_eq!(states, [("a", State::Done), ("b", State::Refused)]);
        assert!(history.warnings.iter().next().is_none());
    }

    #[test]
    fn one_process_writes_and_what_was_torn_does_not_spoil_what_follows() {
        let place = tempfile::tempdir().unwrap();
        let path = Manifest::path_of(place.path(), None);
        let mut first = Manifest::open(&path).unwrap();
        assert!(Manifest::open(&path).unwrap_err().to_string().contains("another `taotie batch`"));
        first.add(&record("a", 1, State::Done)).unwrap();
        drop(first);
        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            Manifest::open(&path).unwrap().add(&record("b", 1, State::Done)).unwrap();
            let history = History::read(place.path()).unwrap();
            assert!(history.last.contains_key("b"), "{length} bytes");
        }
    }
}
