//! The manifest: an append-only file with a record a line. It is the only memory of a collection's work.

use crate::record::Record;
use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use taotie::io::read_bytes;
use taotie::{Error, Result, Warnings};

/// The part of a collection that one call does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 1.
    pub number: u32,
    /// How many there are.
    pub count: u32,
}

/// A manifest that is written to. Nobody else writes to it meanwhile.
#[derive(Debug)]
pub struct Manifest {
    path: PathBuf,
    file: File,
}

/// What all manifests of a collection say.
#[derive(Debug, Default)]
pub struct History {
    /// The last record of each asset.
    pub last: BTreeMap<String, Record>,
    /// Lines that are no records: the last of a driver that was killed amid it.
    pub warnings: Warnings,
}

impl std::str::FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::invalid(format!("`{text}`"), "write the shard and their number, such as 3/8");
        let (number, count) = text.split_once('/').ok_or_else(wrong)?;
        let [number, count] = [number, count].map(|part| part.trim().parse().map_err(|_| wrong()));
        let (number, count) = (number?, count?);
        if number == 0 || number > count {
            return Err(Error::invalid(format!("`{text}`"), format!("shards are counted from 1 to {count}")));
        }
        Ok(Self { number, count })
    }
}

impl Shard {
    /// Says whether an asset is of this shard. Which one it is depends on its id alone.
    pub fn covers(self, id: &str) -> bool {
        let hash = crate::address::of(&id);
        let start = u64::from_str_radix(&hash[..16], 16).unwrap_or_default();
        start % u64::from(self.count) == u64::from(self.number - 1)
    }
}

impl Manifest {
    /// Returns the file that a call writes to: shards have one each, so that they may lie on any file system.
    pub fn path_of(root: &Path, shard: Option<Shard>) -> PathBuf {
        root.join(match shard {
            None => "manifest.jsonl".to_owned(),
            Some(Shard { number, count }) => format!("manifest.{number}-of-{count}.jsonl"),
        })
    }

    /// Opens a manifest, or begins it.
    ///
    /// # Errors
    /// [`Error::Invalid`] where another process writes to it; [`Error::Io`] where the system refuses.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |e| Error::io(path, e);
        let mut file = File::options().read(true).append(true).create(true).open(path).map_err(failed)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let why = "another `taotie batch` works on this collection; wait for it, or use --shard";
                return Err(Error::invalid(path.display().to_string(), why));
            }
            // Where the file system has no locks, nobody else is known of.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        if is_torn(&mut file).map_err(failed)? {
            file.write_all(b"\n").map_err(failed)?;
        }
        Ok(Self { path: path.to_path_buf(), file })
    }

    /// Adds a record; it is on the disk when this returns.
    ///
    /// # Errors
    /// [`Error::Io`] where the system refuses.
    pub fn add(&mut self, record: &Record) -> Result<()> {
        let mut line = serde_json::to_string(record).expect("all keys are text");
        line.push('\n');
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|e| Error::io(&self.path, e))
    }
}

/// Says whether a file ends amid a line.
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
    /// Reads all manifests in a collection's folder: those of all shards too.
    ///
    /// # Errors
    /// [`Error::Io`] where one cannot be read.
    pub fn read(root: &Path) -> Result<Self> {
        let mut history = Self::default();
        for path in manifests(root)? {
            history.read_file(&path)?;
        }
        Ok(history)
    }

    fn read_file(&mut self, path: &Path) -> Result<()> {
        let bytes = read_bytes(path)?;
        for line in bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
            match serde_json::from_slice::<Record>(line) {
                Ok(record) => self.add(record),
                Err(_) => self
                    .warnings
                    .note(format!("{}: a line that is no record is passed over", path.display()), 1),
            }
        }
        Ok(())
    }

    /// Takes a record, unless a later one is known.
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
