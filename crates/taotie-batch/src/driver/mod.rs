//! The driver: starts a process for each asset to be made, and records the outcome. It never loads an asset itself.

mod plan;
mod process;
mod remote;
mod running;

use crate::collection::Collection;
use crate::job::{Job, Message, Outcome};
use crate::record::{Record, State};
use plan::{Books, Plan, Todo, Took};
use process::{Heard, POLL, Start};
use running::{Ledger, Phase, Running};
use std::collections::{BTreeMap, VecDeque};
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::{Duration, Instant};
use taotie::{Bytes, Limits};
use taotie_engine::{Error, Result, Warnings};
use taotie_io::free_memory;

pub use plan::DriveOptions;
pub use process::{Worker, nonempty, remake};
pub use remote::{Planned, Remote, Told};

/// A progress event for the caller.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// The work is planned: the number of assets to be made, and of those already known.
    Planned {
        /// Assets to be made.
        todo: usize,
        /// Assets already known.
        known: usize,
    },
    /// An asset is not done, and stays so: the record of an earlier attempt.
    Kept(&'a Record),
    /// An attempt has ended.
    Ended(&'a Record),
    /// The work is in progress.
    Running {
        /// The fraction done, [0, 1].
        fraction: f64,
        /// The time left, if it can be estimated.
        left: Option<Duration>,
        /// Processes running.
        processes: usize,
    },
}

/// The outcome of the work on a collection or a shard of it.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    /// The number of assets in each final state.
    pub states: BTreeMap<State, usize>,
    /// Attempts made by this call.
    pub attempts: usize,
    /// Assets that were already known.
    pub known: usize,
    /// Warnings about lists, manifests and overrides.
    pub warnings: Warnings,
}

/// Makes all outstanding assets of a collection. `hear` is called every 50 ms and returns true to go on.
///
/// # Errors
/// [`Error::Cancelled`] if `hear` returns false: all processes have ended by then. Errors of the collection, and
/// write errors of the manifest. A problem with an asset is recorded, not returned.
pub fn drive(
    collection: &Collection,
    options: &DriveOptions,
    worker: &Worker,
    hear: &mut dyn FnMut(Event<'_>) -> bool,
) -> Result<Summary> {
    let found = collection.scans()?;
    let books = Books::open(collection.output(), options.shard)?;
    let plan = Plan::of(collection, &found.scans, &books, options)?;
    let mut summary = Summary { known: plan.known, warnings: found.warnings, ..Summary::default() };
    summary.warnings.absorb(collection.unused_options(&found.scans));
    let ids = plan.ids.clone();
    let mut driver = Driver::new(collection, options, worker, books);
    driver.books.relink(&ids);
    driver.all = plan.todo.iter().map(Todo::cost).sum();
    hear(Event::Planned { todo: plan.todo.len() + plan.settled.len(), known: plan.known });
    for record in &plan.kept {
        hear(Event::Kept(record));
    }
    for record in plan.settled {
        driver.add(record, hear)?;
    }
    driver.queue = plan.todo.into();
    let done = driver.run(hear);
    summary.attempts = driver.attempts;
    summary.states = driver.books.states(&ids);
    summary.warnings.absorb(driver.books.warnings);
    done.map(|()| summary)
}

/// The work on a collection.
struct Driver<'a> {
    collection: &'a Collection,
    worker: &'a Worker,
    books: Books,
    ledger: Ledger,
    limits: Limits,
    time_limit: Option<Duration>,
    jobs: usize,
    threads: usize,
    queue: VecDeque<Todo>,
    running: Vec<Running>,
    heard: (Sender<Heard>, Receiver<Heard>),
    start: Instant,
    begun: u64,
    attempts: usize,
    /// The cost of all the work, and of the part that is done.
    all: f64,
    done: f64,
}

impl<'a> Driver<'a> {
    fn new(collection: &'a Collection, options: &DriveOptions, worker: &'a Worker, books: Books) -> Self {
        let run = collection.run();
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let memory = options.memory.or(run.memory).or_else(|| free_memory().map(Bytes));
        Self {
            collection,
            worker,
            books,
            ledger: Ledger::new(memory),
            limits: Limits { memory, allow_outside: options.allow_outside, ..Limits::default() },
            time_limit: options.time_limit.or(run.time_limit),
            jobs: options.jobs.or(run.jobs).unwrap_or(threads).max(1),
            threads,
            queue: VecDeque::new(),
            running: Vec::new(),
            heard: mpsc::channel(),
            start: Instant::now(),
            begun: 0,
            attempts: 0,
            all: 0.0,
            done: 0.0,
        }
    }

    fn run(&mut self, hear: &mut dyn FnMut(Event<'_>) -> bool) -> Result<()> {
        let mut looked = Instant::now();
        while !(self.queue.is_empty() && self.running.is_empty()) {
            self.start_more(hear)?;
            if let Ok(heard) = self.heard.1.recv_timeout(POLL) {
                self.hear(heard, hear)?;
            }
            self.let_go();
            if looked.elapsed() >= POLL {
                looked = Instant::now();
                self.running.iter_mut().for_each(Running::look);
                if !hear(self.progress()) {
                    self.running.drain(..).for_each(Running::end);
                    return Err(Error::Cancelled);
                }
            }
        }
        Ok(())
    }

    /// Starts processes while there is room. None starts while another waits for memory, so that large ones get their
    /// turn.
    fn start_more(&mut self, hear: &mut dyn FnMut(Event<'_>) -> bool) -> Result<()> {
        while self.running.len() < self.jobs && self.running.iter().all(|one| one.phase != Phase::Waiting) {
            let Some(next) = self.queue.front() else { return Ok(()) };
            let want = running::memory_to_read(next.bytes_at_once());
            if !self.ledger.has_room(want, 0) && !self.running.is_empty() {
                return Ok(());
            }
            let Some(todo) = self.queue.pop_front() else { return Ok(()) };
            self.begun += 1;
            let job = self.job(&todo);
            let folder = nonempty(self.collection.folder());
            let start = Start { worker: self.worker, folder: &folder, number: self.begun };
            match start.process(&job, &self.heard.0) {
                Ok(process) => {
                    self.ledger.take(want);
                    let patience = self.time_limit.unwrap_or_else(|| running::patience_to_read(todo.bytes));
                    self.running.push(Running::new(todo, process, want, patience));
                }
                Err(error) => {
                    let outcome = running::without_process(&error, &todo);
                    self.finish(todo, outcome, Took::default(), hear)?;
                }
            }
        }
        Ok(())
    }

    fn job(&self, todo: &Todo) -> Job {
        Job {
            id: todo.scan.id.clone(),
            scan: todo.scan.path.clone(),
            output: self.collection.relative_output().to_path_buf(),
            settings: todo.settings.clone(),
            limits: self.limits,
            threads: self.threads,
            reuse: true,
        }
    }

    fn hear(&mut self, heard: Heard, hear: &mut dyn FnMut(Event<'_>) -> bool) -> Result<()> {
        let Heard { number, said } = heard;
        let Some(at) = self.running.iter().position(|one| one.process.number == number) else {
            return Ok(());
        };
        match said {
            Some(Message::Forecast { bytes, size }) => {
                self.running[at].wait_for_memory(bytes, size);
                Ok(())
            }
            Some(message) => {
                self.running[at].hear(message);
                Ok(())
            }
            None => {
                let mut ended = self.running.remove(at);
                self.ledger.give_back(ended.reserved);
                let took = Took { seconds: ended.start.elapsed().as_secs_f64(), forecast: ended.forecast };
                let outcome = running::outcome(&mut ended);
                if let Some(address) = ended.address.as_ref().filter(|_| !outcome.state.is_made()) {
                    self.books.store.sweep(address);
                }
                self.finish(ended.todo, outcome, took, hear)
            }
        }
    }

    /// Lets processes begin baking while there is memory; always at least one.
    fn let_go(&mut self) {
        while let Some(at) = self.next_to_go() {
            let forecast = self.running[at].forecast.unwrap_or(0);
            let threads = self.threads / self.side_by_side(forecast).max(1);
            let one = &mut self.running[at];
            self.ledger.give_back(one.reserved);
            self.ledger.take(forecast);
            let patience = self.time_limit.map_or_else(|| one.patience_to_work(), |limit| one.left_of(limit));
            one.go(threads.max(1), forecast, patience);
        }
    }

    fn next_to_go(&mut self) -> Option<usize> {
        let waiting = |one: &Running| one.phase == Phase::Waiting;
        let fits = |one: &Running| self.ledger.has_room(one.forecast.unwrap_or(0), one.reserved);
        if let Some(at) = self.running.iter().position(|one| waiting(one) && fits(one)) {
            return Some(at);
        }
        if self.running.is_empty() || !self.running.iter().all(waiting) {
            return None;
        }
        // All are waiting for one another's memory: the first proceeds, the others start over after it.
        for one in self.running.drain(1..).rev() {
            self.ledger.give_back(one.reserved);
            self.queue.push_front(one.give_up());
        }
        Some(0)
    }

    /// Returns how many processes with such an estimate will run concurrently.
    fn side_by_side(&self, forecast: u64) -> usize {
        let left = self.queue.len() + self.running.len();
        self.jobs.min(left).min(self.ledger.holds(forecast))
    }

    fn finish(
        &mut self,
        todo: Todo,
        outcome: Outcome,
        took: Took,
        hear: &mut dyn FnMut(Event<'_>) -> bool,
    ) -> Result<()> {
        self.done += todo.cost();
        if let Some(again) = todo.to_decide(&outcome.required) {
            self.all += again.cost();
            self.queue.push_back(again);
        }
        let record = self.books.record(todo, outcome, took);
        self.add(record, hear)
    }

    fn add(&mut self, record: Record, hear: &mut dyn FnMut(Event<'_>) -> bool) -> Result<()> {
        self.books.add(&record)?;
        self.attempts += 1;
        hear(Event::Ended(&record));
        Ok(())
    }

    fn progress(&self) -> Event<'static> {
        let fraction = if self.all > 0.0 { (self.done / self.all).min(1.0) } else { 1.0 };
        let left = (fraction > 0.01).then(|| self.start.elapsed().mul_f64((1.0 - fraction) / fraction));
        Event::Running { fraction, left, processes: self.running.len() }
    }
}
