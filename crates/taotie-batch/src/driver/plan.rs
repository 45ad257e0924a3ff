//! The plan of the work on a collection: its options, the known state with its records, and the assets to be made.

use crate::collection::{Collection, Kind, Scan};
use crate::job::Outcome;
use crate::manifest::{History, Manifest, Shard};
use crate::record::{InputFile, Record, SCHEMA, State, points_to_decide};
use crate::settings::{Settings, Task};
use crate::store::{MainObject, Store, VERSION, hash_of};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use taotie::asset::{Requirement, RequirementOutcome};
use taotie::{Bytes, Warning};
use taotie_engine::{Error, Result, Warnings};
use taotie_photometric::input_files;

/// How to run the work on a collection. `None` means: as the collection's file states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DriveOptions {
    /// The largest number of concurrent processes; defaults to the number of hardware threads.
    pub jobs: Option<usize>,
    /// The most memory for all processes together; defaults to the free memory.
    pub memory: Option<Bytes>,
    /// The longest time per asset; defaults to a limit that depends on the scan's size.
    pub time_limit: Option<Duration>,
    /// The part of the collection to work on; `None` for all.
    pub shard: Option<Shard>,
    /// `true` to retry assets that failed or were refused.
    pub retry_failed: bool,
    /// `true` to allow reading files outside the folders of models.
    pub allow_outside: bool,
}

/// An asset to be made.
#[derive(Debug, Clone)]
pub struct Todo {
    /// The scan.
    pub scan: Scan,
    /// Its settings.
    pub settings: Settings,
    /// The SHA-256 of the settings, except for requirements.
    pub settings_hash: String,
    /// The scan's own file, or all files of photographs, not read yet; empty if there is none.
    pub input: Vec<InputFile>,
    /// Its size in bytes.
    pub bytes: u64,
    /// Points of the proof, if the requirements need more than the collection states.
    pub points: Option<usize>,
}

impl Todo {
    /// Returns the work with more points of the proof, likely enough to decide the undecided requirements; `None` if
    /// all are decided, or more points would not decide them.
    pub fn to_decide(&self, required: &[RequirementOutcome]) -> Option<Self> {
        let Task::Bake(asset) = &self.settings.task else { return None };
        let points = points_to_decide(required, asset.verify.points)?;
        Some(self.clone().with_points(Some(points)))
    }

    fn with_points(mut self, points: Option<usize>) -> Self {
        self.settings.task.take_points(points);
        Self { points, ..self }
    }

    /// Returns the relative cost of the work: a fixed part per asset, plus a part for its size.
    pub fn cost(&self) -> f64 {
        const EACH: u64 = 1 << 18;
        (EACH + self.bytes) as f64
    }

    /// Returns the bytes that are read before the memory is estimated: a whole scan; photographs one after the other.
    pub fn bytes_at_once(&self) -> u64 {
        self.input.iter().map(|file| file.bytes).max().unwrap_or(0)
    }
}

/// The outstanding work, and the assets that need none.
pub struct Plan {
    /// Assets to be made, the largest first.
    pub todo: Vec<Todo>,
    /// New records that need no process: of existing assets whose requirements or record version have changed, and of
    /// files that cannot be opened.
    pub settled: Vec<Record>,
    /// The records that stay as they are, of assets that are not done.
    pub kept: Vec<Record>,
    /// The number of assets that stay as they are.
    pub known: usize,
    /// All assets of the shard.
    pub ids: Vec<String>,
}

/// The action due for one asset.
enum Due<'a> {
    Making(Box<Todo>),
    Recording(Box<Record>),
    /// Recording a verdict that leaves a requirement undecided, and proving the asset with more points.
    Deciding(Box<Record>, Box<Todo>),
    Nothing(&'a Record),
}

impl Plan {
    /// Compares a collection with its known state.
    ///
    /// # Errors
    /// Settings that contradict one another.
    pub fn of(
        collection: &Collection,
        scans: &[Scan],
        books: &Books,
        options: &DriveOptions,
    ) -> Result<Self> {
        let mut plan =
            Self { todo: Vec::new(), settled: Vec::new(), kept: Vec::new(), known: 0, ids: Vec::new() };
        let is_ours = |scan: &&Scan| options.shard.is_none_or(|shard| shard.covers(&scan.id));
        for scan in scans.iter().filter(is_ours) {
            plan.ids.push(scan.id.clone());
            let todo = todo(collection, scan)?;
            match due(todo, (collection.folder(), books), options.retry_failed) {
                Due::Making(todo) => plan.todo.push(*todo),
                Due::Recording(record) => plan.settled.push(*record),
                Due::Deciding(record, todo) => {
                    plan.settled.push(*record);
                    plan.todo.push(*todo);
                }
                Due::Nothing(record) => plan.keep(record),
            }
        }
        plan.todo.sort_by_key(|todo| std::cmp::Reverse(todo.bytes));
        Ok(plan)
    }

    fn keep(&mut self, record: &Record) {
        self.known += 1;
        if record.state != State::Done {
            self.kept.push(record.clone());
        }
    }
}

fn todo(collection: &Collection, scan: &Scan) -> Result<Todo> {
    let settings = collection.settings(&scan.id, scan.kind)?;
    let Settings { task, thumbnail, turntable, viewer, .. } = &settings;
    let settings_hash = match task.with_names() {
        Task::Bake(asset) => hash_of(&(asset, thumbnail, turntable, viewer)),
        Task::Photometric(own) => hash_of(&(own, thumbnail, viewer)),
    };
    let input = input(collection.folder(), scan);
    let bytes = input.iter().map(|file| file.bytes).sum();
    Ok(Todo { scan: scan.clone(), settings, settings_hash, input, bytes, points: None })
}

/// Returns the object's own files, with paths relative to `folder`; none if one of them cannot be opened.
fn input(folder: &Path, scan: &Scan) -> Vec<InputFile> {
    if scan.path.to_str().is_none() {
        return Vec::new();
    }
    let path = folder.join(&scan.path);
    let files = match scan.kind {
        Kind::Scan => vec![path.clone()],
        Kind::Photographs => input_files(&path).unwrap_or_default(),
    };
    let is_folder = scan.kind == Kind::Photographs && path.is_dir();
    let relative = |name: &str| if is_folder { scan.path.join(name) } else { scan.path.with_file_name(name) };
    let known = |file: &PathBuf| {
        let file = InputFile::stat(file).ok()?;
        Some(InputFile { path: relative(&file.name), ..file })
    };
    files.iter().map(known).collect::<Option<Vec<_>>>().unwrap_or_default()
}

fn due<'a>(todo: Todo, (folder, books): (&Path, &'a Books), retry: bool) -> Due<'a> {
    let last = books.history.last.get(&todo.scan.id);
    if todo.input.is_empty() {
        let outcome = Outcome::failed(unreadable(folder, &todo.scan).to_string());
        let is_known = |last: &&Record| last.state == outcome.state && last.error == outcome.error;
        return match last.filter(is_known) {
            Some(last) => Due::Nothing(last),
            None => Due::Recording(Box::new(books.record(todo, outcome, Took::default()))),
        };
    }
    let is_same = |last: &&Record| {
        (&last.settings, last.version.as_str()) == (&todo.settings_hash, VERSION)
            && last.source() == Some(&todo.scan.path)
            && todo.input.iter().all(|file| last.input.iter().any(|known| known.path == file.path))
            && last.has_same_input(folder)
    };
    let Some(last) = last.filter(is_same) else { return Due::Making(Box::new(todo)) };
    if !last.state.is_made() {
        // A requirement may be the cause: a length, if the scan has no unit.
        let is_due = retry || !has_requirements(last, &todo.settings.require);
        return if is_due { Due::Making(Box::new(todo)) } else { Due::Nothing(last) };
    }
    if !last.parts.iter().all(|part| books.store.holds(part)) {
        return Due::Making(Box::new(todo));
    }
    let proved = todo.clone().with_points(last.points);
    let is_judged =
        last.is_current() && has_requirements(last, &todo.settings.require) && last.title == todo.scan.title;
    if is_judged {
        return proved
            .to_decide(&last.required)
            .map_or(Due::Nothing(last), |todo| Due::Making(Box::new(todo)));
    }
    let object = last.main().and_then(|part| books.store.object::<MainObject>(&part.address));
    let Some(object) = object else { return Due::Making(Box::new(todo)) };
    if let Err(error) = object.check_unit(&todo.settings.require) {
        let outcome = Outcome::failed(error.to_string());
        return Due::Recording(Box::new(books.record(todo, outcome, Took::default())));
    }
    let record = judged(last, &todo, &object);
    match proved.to_decide(&record.required) {
        Some(todo) => Due::Deciding(Box::new(record), Box::new(todo)),
        None => Due::Recording(Box::new(record)),
    }
}

/// Returns true if a record that was read has these requirements. Reading may round numbers, so they are read too.
fn has_requirements(read: &Record, require: &[Requirement]) -> bool {
    let text = serde_json::to_string(require).expect("all keys are text");
    serde_json::from_str::<Vec<Requirement>>(&text).is_ok_and(|require| require == read.require)
}

/// Returns the reason why a scan's file cannot be opened.
fn unreadable(folder: &Path, scan: &Scan) -> Error {
    if scan.path.to_str().is_none() {
        return Error::invalid(&scan.id, "its path is not UTF-8; rename the file or its folder");
    }
    let path = folder.join(&scan.path);
    if scan.kind == Kind::Photographs && path.is_dir() {
        return match input_files(&path) {
            Err(error) => error,
            Ok(files) if files.is_empty() => Error::invalid(
                scan.path.display().to_string(),
                "no photographs in the folder; add them, or remove its line from the list",
            ),
            Ok(files) => match files.iter().find_map(|file| InputFile::stat(file).err()) {
                Some(error) => error,
                None => {
                    Error::invalid(scan.path.display().to_string(), "its files could not be opened at first")
                }
            },
        };
    }
    let cause = std::fs::metadata(&path).err().unwrap_or_else(|| ErrorKind::Other.into());
    if cause.kind() == ErrorKind::NotFound && path.is_symlink() {
        let link = format!("the link {}", scan.path.display());
        return Error::invalid(link, "its target does not exist; restore the target, or remove the link");
    }
    Error::io(&scan.path, cause)
}

/// Returns the record of an asset that is judged again: its requirements, its title or the record version have
/// changed.
fn judged(last: &Record, todo: &Todo, object: &MainObject) -> Record {
    let required = object.evaluate(&todo.settings.require);
    Record {
        schema: SCHEMA,
        attempt: last.attempt + 1,
        ended: now(),
        title: todo.scan.title.clone(),
        state: State::of(&required),
        require: todo.settings.require.clone(),
        required,
        figures: object.figures(),
        estimated: object.estimated(),
        seconds: 0.0,
        stages: Vec::new(),
        ..last.clone()
    }
}

/// Returns the record of an asset that could not be proved with more points: its earlier proof, with a warning.
fn undecided(earlier: &Record, points: usize, outcome: &Outcome) -> Record {
    let cause = outcome.error.as_deref().unwrap_or("unknown cause");
    let what = format!("not proved with {points} points, so a requirement is undecided: {cause}");
    let mut warnings: Vec<_> =
        earlier.warnings.iter().filter(|warning| warning.what != what).cloned().collect();
    warnings.push(Warning { count: 1, what });
    Record { attempt: earlier.attempt + 1, ended: now(), warnings, ..earlier.clone() }
}

/// The known state of a collection, and where it is recorded.
pub struct Books {
    /// The files.
    pub store: Store,
    manifest: Manifest,
    /// The content of all manifests.
    pub history: History,
    /// Malformed manifest lines, and links that could not be created or removed.
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

    /// Returns the record of an attempt that has ended. An asset that failed to be proved with more points keeps its
    /// earlier proof.
    pub fn record(&self, todo: Todo, outcome: Outcome, took: Took) -> Record {
        let last = self.history.last.get(&todo.scan.id);
        if let (Some(points), Some(last), false) = (todo.points, last, outcome.state.is_made()) {
            return undecided(last, points, &outcome);
        }
        let is_photographs = todo.scan.kind == Kind::Photographs;
        let input = if outcome.input.is_empty() { todo.input } else { outcome.input };
        Record {
            schema: SCHEMA,
            attempt: 1 + last.map_or(0, |last| last.attempt),
            id: todo.scan.id,
            ended: now(),
            version: VERSION.into(),
            settings: todo.settings_hash,
            state: outcome.state,
            error: outcome.error,
            title: todo.scan.title,
            photographs: is_photographs.then_some(todo.scan.path),
            input,
            seconds: took.seconds,
            stages: outcome.stages,
            peak_bytes: outcome.peak_bytes,
            forecast_bytes: took.forecast,
            figures: outcome.figures,
            estimated: outcome.estimated,
            points: todo.points,
            require: todo.settings.require,
            required: outcome.required,
            warnings: outcome.warnings,
            parts: outcome.parts,
        }
    }

    /// Appends a record to the manifest, and links exactly the files it names. On a file system without links, there is
    /// only a warning: the objects exist.
    ///
    /// # Errors
    /// Write errors.
    pub fn add(&mut self, record: &Record) -> Result<()> {
        if record.state.is_made()
            && let Err(error) = self.store.link(&record.id, &record.parts)
        {
            self.warnings.note(format!("could not update the links: {error}"), 1);
        }
        self.manifest.add(record)?;
        self.history.add(record.clone());
        Ok(())
    }

    /// Links the files of these assets, as far as they were made, where links were deleted.
    pub fn relink(&mut self, ids: &[String]) {
        let made = ids.iter().filter_map(|id| self.history.last.get(id)).filter(|last| last.state.is_made());
        for error in made.filter_map(|last| self.store.link(&last.id, &last.parts).err()) {
            self.warnings.note(format!("could not update the links: {error}"), 1);
        }
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
fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
