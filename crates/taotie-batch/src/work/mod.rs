//! The process of one object: scan, bake, proof, files, pictures, page; or photographs and their estimate.

mod outputs;
mod photographs;

use crate::job::{Go, Job, Message, Outcome, bound_process, own_peak};
use crate::record::{
    EstimateFigures, InputFile, Part, ShortFigures, Stage, State, read_input, read_photographs,
};
use crate::settings::{AssetSettings, PhotometricSettings, Task};
use crate::store::{
    AssetObject, DerivedObject, EstimateObject, Object, Store, address_of, address_of_derived,
};
use outputs::Work;
use photographs::Photographs;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;
use taotie::asset::{Baker, Requirement, RequirementOutcome, ScanFile};
use taotie::{Bytes, Warning};
use taotie_engine::{Error, Progress, Result, Warnings};
use taotie_io::FileSet;
use taotie_photometric::{PhotographSet, Samples};

pub use outputs::{Host, Order};

/// Does a job, reporting progress to the driver; returns the outcome. Paths are relative to the current folder.
pub fn run(job: &Job, host: Host<'_>) -> Outcome {
    let clock = Clock::new(host.send);
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
        estimated: made.estimated,
        required: made.required,
        warnings: made.warnings,
        parts: made.parts,
        peak_bytes: own_peak(),
    }
}

/// The results of a job so far.
#[derive(Default)]
struct Made {
    input: Vec<InputFile>,
    figures: Option<ShortFigures>,
    estimated: Option<EstimateFigures>,
    required: Vec<RequirementOutcome>,
    warnings: Vec<Warning>,
    parts: Vec<Part>,
}

impl Work<'_> {
    fn make(&self, made: &mut Made) -> Result<()> {
        match &self.job.settings.task {
            Task::Bake(settings) => self.bake(settings, made),
            Task::Photometric(settings) => self.estimate(settings, made),
        }
    }

    fn bake(&self, settings: &AssetSettings, made: &mut Made) -> Result<()> {
        let (job, require) = (self.job, &self.job.settings.require);
        let most = pool(job.threads)?;
        let file = most.install(|| ScanFile::read(&job.scan, &job.limits, self.progress))?;
        let file = file.with_options(settings.scan);
        Requirement::check_unit(require, file.unit())?;
        self.progress.begin("hash")?;
        made.input = read_input(file.files(), settings, &job.limits)?;
        let at = address_of(&job.settings.task, &made.input);
        // They are not in the address: a missing file has no content.
        made.input.extend(file.missing_files().iter().map(|path| InputFile::missing(path)));
        (self.host.send)(Message::Address { address: at.clone() });
        let known = self.store.object::<AssetObject>(&at).filter(|_| job.reuse);
        let reused = known.is_some();
        let (object, threads) = match known {
            Some(object) => (object, most),
            None => {
                let triangles = file.size().triangles;
                let need = most.install(|| self.need(settings, &file));
                let threads = self.admitted(format!("a bake of {triangles} triangles"), need, triangles)?;
                (threads.install(|| outputs::asset(self, settings, file, &at))?, threads)
            }
        };
        made.required = object.figures.evaluate(require);
        made.figures = Some(object.short());
        made.warnings.clone_from(&object.warnings);
        let model = self.store.path(&at).join(&object.files[0].name);
        made.parts.push(object.into_part(at.clone(), reused));
        threads.install(|| self.derive(&Shown { model, normals: None }, &at, made))
    }

    /// Estimates normals from photographs, unless the same estimate exists.
    fn estimate(&self, settings: &PhotometricSettings, made: &mut Made) -> Result<()> {
        let job = self.job;
        self.progress.begin("hash")?;
        made.input = read_photographs(&job.scan, &self.name(), settings)?;
        let at = address_of(&job.settings.task, &made.input);
        (self.host.send)(Message::Address { address: at.clone() });
        let known = self.store.object::<EstimateObject>(&at).filter(|_| job.reuse);
        let reused = known.is_some();
        let most = pool(job.threads)?;
        let (object, threads) = match known {
            Some(object) => (object, most),
            None => {
                let mut warnings = Warnings::default();
                let setup = settings.options.setup(job.limits);
                let open = || PhotographSet::open_with(&job.scan, &setup, &mut warnings, self.progress);
                let set = most.install(open)?;
                let (need, samples) = Samples::need(&set, &settings.options.reading(job.limits))?;
                let what = format!("an estimate from {} photographs", set.photographs.len());
                let threads = self.admitted(what, with_derived(need), samples)?;
                let input = &made.input;
                let photographs = Photographs { set: &set, settings, input, warnings };
                (threads.install(|| photographs::estimate(self, photographs, &at))?, threads)
            }
        };
        made.estimated = Some(object.estimated.clone());
        made.warnings.clone_from(&object.warnings);
        made.parts.push(object.into_part(at.clone(), reused));
        let [model, normals] = ["relief.glb", "normals.png"].map(|name| self.store.path(&at).join(name));
        threads.install(|| self.derive(&Shown { model, normals: Some(normals) }, &at, made))
    }

    /// Waits until `need` is free for work on `what`, of `size` triangles or samples; returns a pool of the threads that it
    /// may use.
    fn admitted(&self, what: String, need: Bytes, size: u64) -> Result<ThreadPool> {
        self.job.limits.check(what, need)?;
        (self.host.send)(Message::Forecast { bytes: need.0, size });
        let Go { threads } = (self.host.go)();
        bound_process(need).map_err(|error| Error::invalid("the memory limit", error.to_string()))?;
        pool(threads)
    }

    /// Estimates the memory of the bake with its proof, and of everything derived from it: pages and pictures.
    fn need(&self, settings: &AssetSettings, file: &ScanFile) -> Bytes {
        let baker = Baker::new(settings.bake.clone());
        let proved = baker.need(file.size()).with_packing(&settings.packing).with_proof();
        let shown = self.job.settings.viewer.is_some();
        let need = if shown { proved.with_viewer(taotie_report::viewer::MOST_TEXTURE_SIDE) } else { proved };
        with_derived(need.bytes())
    }

    /// Makes the files that present the result: pictures and a page.
    fn derive(&self, shown: &Shown, main: &str, made: &mut Made) -> Result<()> {
        let settings = &self.job.settings;
        let model = shown.model.as_path();
        if let Some(thumbnail) = &settings.thumbnail {
            let of = Derived { kind: "thumbnail", main, ending: "webp" };
            made.parts.push(self.derived(of, thumbnail, |path, files| match &shown.normals {
                Some(normals) => photographs::thumbnail(normals, (path, files), *thumbnail, self),
                None => outputs::thumbnail(model, (path, files), *thumbnail, self),
            })?);
        }
        if let Some(turntable) = &settings.turntable {
            let of = Derived { kind: "turntable", main, ending: "turn.png" };
            made.parts.push(self.derived(of, turntable, |path, files| {
                outputs::turntable(model, (path, files), *turntable, self)
            })?);
        }
        if let Some(page) = &settings.viewer {
            let of = Derived { kind: "viewer", main, ending: "html" };
            made.parts.push(
                self.derived(of, page, |path, files| outputs::viewer_page(model, (path, files), self))?,
            );
        }
        Ok(())
    }

    /// Makes one derived file, unless it already exists.
    fn derived(
        &self,
        of: Derived<'_>,
        settings: &impl Serialize,
        write: impl FnOnce(&Path, &FileSet) -> Result<()>,
    ) -> Result<Part> {
        let at = address_of_derived(of.kind, settings, of.main);
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
        self.store.complete(&at, &object, &(self.host.files)())?;
        Ok(object.into_part(at, false))
    }
}

/// The files that pictures and pages are made from.
struct Shown {
    /// The asset, or the relief of photographs.
    model: PathBuf,
    /// The normals of photographs as a picture.
    normals: Option<PathBuf>,
}

/// A file derived from the result of a task.
#[derive(Clone, Copy)]
struct Derived<'a> {
    kind: &'static str,
    /// The address of the result.
    main: &'a str,
    /// The suffix of its name.
    ending: &'static str,
}

/// Adds the memory of derived files, and of what the allocator keeps between stages.
fn with_derived(Bytes(bytes): Bytes) -> Bytes {
    /// Their fraction is one in …
    const BESIDE: u64 = 6;
    Bytes(bytes.saturating_add(bytes / BESIDE))
}

fn pool(threads: usize) -> Result<ThreadPool> {
    let built = ThreadPoolBuilder::new().num_threads(threads.max(1)).build();
    built.map_err(|error| Error::limit(format!("{threads} threads"), format!("{error}; use fewer")))
}

/// Receives stages, reports them to the driver, and times them.
struct Clock<'a> {
    send: &'a (dyn Fn(Message) + Sync),
    heard: Mutex<Heard>,
}

#[derive(Default)]
struct Heard {
    done: Vec<Stage>,
    running: Option<(&'static str, Instant)>,
}

impl<'a> Clock<'a> {
    /// Creates a clock without any stages.
    fn new(send: &'a (dyn Fn(Message) + Sync)) -> Self {
        Self { send, heard: Mutex::default() }
    }

    /// Starts a stage; always returns true, so that the work goes on.
    fn hear(&self, stage: &'static str) -> bool {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if !stage.is_empty() && heard.running.is_none_or(|(running, _)| running != stage) {
            heard.end();
            heard.running = Some((stage, Instant::now()));
            (self.send)(Message::Stage { stage: stage.into() });
        }
        true
    }

    /// Ends the current stage; returns all of them.
    fn done(&self) -> Vec<Stage> {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        heard.end();
        std::mem::take(&mut heard.done)
    }
}

impl Heard {
    fn end(&mut self) {
        if let Some((stage, start)) = self.running.take() {
            let milliseconds = start.elapsed().as_secs_f64() * 1e3;
            self.done.push(Stage { stage: stage.into(), milliseconds });
        }
    }
}
