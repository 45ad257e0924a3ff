//! The process of one asset: scan, bake, proof, files, pictures, page.

mod asset;
mod clock;
mod pictures;
mod viewer;

use crate::job::{Go, Job, Message, Outcome};
use crate::memory;
use crate::objects::{AssetObject, DerivedObject, Object};
use crate::record::{Part, ShortFigures, State};
use crate::store::Store;
use crate::{address, input};
use clock::Clock;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie::asset::{Baker, Bytes, Met, Requirement, ScanFile, Warning};
use taotie::io::FileSet;
use taotie::{Error, Progress, Result};

/// What a process has beside its job: a way to its driver, and to signals.
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// Makes a set of files that signals stop.
    pub files: &'a (dyn Fn() -> FileSet + Sync),
    /// Tells the driver something.
    pub tell: &'a (dyn Fn(Message) + Sync),
    /// Waits for the driver's word that the work may begin.
    pub go: &'a (dyn Fn() -> Go + Sync),
}

/// Does a job; tells the driver of it, and returns how it ended. Paths are relative to the current folder.
pub fn run(job: &Job, host: Host<'_>) -> Outcome {
    let clock = Clock::new(host.tell);
    let mut made = Made::default();
    let listener = |stage: &'static str, _: f64| clock.hear(stage);
    let work = Work { job, host, store: Store::new(&job.output), progress: Progress::new(&listener) };
    let ended = work.make(&mut made);
    let state = match &ended {
        Ok(()) => State::of(&made.required),
        Err(Error::Limit { .. }) => State::Refused,
        Err(_) => State::Failed,
    };
    Outcome {
        state,
        error: ended.err().map(|error| error.to_string()),
        input: made.input,
        stages: clock.done(),
        figures: made.figures,
        required: made.required,
        warnings: made.warnings,
        parts: made.parts,
        peak_bytes: memory::own_peak(),
    }
}

/// What is done of a job.
#[derive(Default)]
struct Made {
    input: Vec<input::InputFile>,
    figures: Option<ShortFigures>,
    required: Vec<Met>,
    warnings: Vec<Warning>,
    parts: Vec<Part>,
}

/// A job at work.
struct Work<'a> {
    job: &'a Job,
    host: Host<'a>,
    store: Store,
    progress: Progress<'a>,
}

impl Work<'_> {
    fn make(&self, made: &mut Made) -> Result<()> {
        let (job, settings) = (self.job, &self.job.settings);
        let most = pool(job.threads)?;
        let file = most.install(|| ScanFile::read(&job.scan, &job.limits, self.progress))?;
        let file = file.with_options(settings.asset.scan);
        Requirement::check_unit(&settings.require, file.unit())?;
        self.progress.begin("hash")?;
        made.input = input::read(file.files(), &settings.asset, &job.limits)?;
        let at = address::of_asset(&settings.asset, &made.input);
        (self.host.tell)(Message::Address { address: at.clone() });
        let known = self.store.object::<AssetObject>(&at).filter(|_| job.reuse);
        let reused = known.is_some();
        let (object, threads) = match known {
            Some(object) => (object, most),
            None => {
                let threads = self.admitted(&most, &file)?;
                (threads.install(|| asset::make(self, file, &at))?, threads)
            }
        };
        made.required = object.figures.require(&settings.require);
        made.figures = Some(object.short());
        made.warnings.clone_from(&object.warnings);
        let model = self.store.path(&at).join(&object.files[0].name);
        made.parts.push(object.into_part(at.clone(), reused));
        threads.install(|| self.derive(&model, &at, made))
    }

    /// Foresees the memory of the work, and waits until there is so much; returns the threads that it may have.
    fn admitted(&self, most: &ThreadPool, file: &ScanFile) -> Result<ThreadPool> {
        let triangles = file.size().triangles;
        let need = most.install(|| self.need(file));
        self.job.limits.check(format!("a bake of {triangles} triangles"), need)?;
        (self.host.tell)(Message::Forecast { bytes: need.0, triangles });
        let Go { threads } = (self.host.go)();
        memory::bound_process(need)
            .map_err(|error| Error::invalid("the limit of memory", error.to_string()))?;
        pool(threads)
    }

    /// Foresees the memory of the bake with its proof, and what is made of it beside: pages and pictures.
    fn need(&self, file: &ScanFile) -> Bytes {
        /// The part of the whole that these, and what the allocator keeps between stages, take.
        const BESIDE: u64 = 6;
        let settings = &self.job.settings.asset;
        let baker = Baker::new(settings.bake.clone());
        let proved = baker.need(file.size()).with_packing(&settings.packing).with_proof();
        let shown = self.job.settings.viewer.is_some();
        let Bytes(bytes) =
            if shown { proved.with_viewer(taotie_report::viewer::MOST_TEXTURE_SIDE) } else { proved }.bytes();
        Bytes(bytes.saturating_add(bytes / BESIDE))
    }

    /// Makes what an asset's file is shown by.
    fn derive(&self, model: &Path, asset: &str, made: &mut Made) -> Result<()> {
        let settings = &self.job.settings;
        if let Some(thumbnail) = &settings.thumbnail {
            let of = Derived { kind: "thumbnail", asset, ending: "webp" };
            made.parts.push(self.derived(of, thumbnail, |path, files| {
                pictures::thumbnail(model, (path, files), *thumbnail, self)
            })?);
        }
        if let Some(turntable) = &settings.turntable {
            let of = Derived { kind: "turntable", asset, ending: "turn.png" };
            made.parts.push(self.derived(of, turntable, |path, files| {
                pictures::turntable(model, (path, files), *turntable, self)
            })?);
        }
        if let Some(page) = &settings.viewer {
            let of = Derived { kind: "viewer", asset, ending: "html" };
            made.parts.push(self.derived(of, page, |path, files| viewer::page(model, (path, files), self))?);
        }
        Ok(())
    }

    /// Makes one file of an asset's, unless it is there.
    fn derived(
        &self,
        of: Derived<'_>,
        settings: &impl Serialize,
        write: impl FnOnce(&Path, &FileSet) -> Result<()>,
    ) -> Result<Part> {
        let at = address::of_derived(of.kind, settings, of.asset);
        if let Some(known) = self.store.object::<DerivedObject>(&at).filter(|_| self.job.reuse) {
            return Ok(known.into_part(at, true));
        }
        self.progress.begin(of.kind)?;
        let files = (self.host.files)();
        let name = format!("{}.{}", self.stem(), of.ending);
        let path = self.store.claim(&at, &files)?.join(&name);
        write(&path, &files)?;
        files.commit()?;
        let object = DerivedObject::of(of.kind, vec![(name, path)])?;
        self.store.tell(&at, &object, &(self.host.files)())?;
        Ok(object.into_part(at, false))
    }

    /// Returns the name of the scan's file without its extension, after which files are named.
    fn stem(&self) -> String {
        let stem = self.job.scan.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if stem.is_empty() { "asset".into() } else { stem }
    }

    /// Returns the most memory that showing an asset may take.
    fn limit(&self) -> Option<Bytes> {
        self.job.limits.memory
    }
}

/// A file that is made of an asset's own.
#[derive(Clone, Copy)]
struct Derived<'a> {
    kind: &'static str,
    /// The asset's address.
    asset: &'a str,
    /// The end of its name.
    ending: &'static str,
}

fn pool(threads: usize) -> Result<ThreadPool> {
    let built = ThreadPoolBuilder::new().num_threads(threads.max(1)).build();
    built.map_err(|error| Error::limit(format!("{threads} threads"), format!("{error}; use fewer")))
}

/// A file to be written, in a set.
type Target<'a> = (&'a Path, &'a FileSet);

/// Returns names with paths in a folder.
fn named(files: &[PathBuf]) -> Vec<(String, PathBuf)> {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), path.clone())).collect()
}
