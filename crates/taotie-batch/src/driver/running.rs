//! An asset that a process is at work on.

use super::plan::Todo;
use super::process::Process;
use crate::job::{Message, Outcome};
use crate::memory::peak_of;
use std::time::{Duration, Instant};
use taotie::asset::ScanSize;

/// How far a process is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// It reads the scan.
    Reading,
    /// It knows what memory it needs, and waits for it.
    Waiting,
    /// It bakes.
    Working,
}

/// An asset that a process is at work on.
pub struct Running {
    /// The asset.
    pub todo: Todo,
    /// The process.
    pub process: Process,
    /// How far it is.
    pub phase: Phase,
    /// The start.
    pub start: Instant,
    /// The memory promised to it.
    pub reserved: u64,
    /// The memory that it foresees.
    pub forecast: Option<u64>,
    /// The most memory that was seen.
    pub peak: Option<u64>,
    /// The address of what it makes.
    pub address: Option<String>,
    /// The stage that it is at.
    pub stage: String,
    /// What it said at its end.
    pub outcome: Option<Outcome>,
    /// The time limit that it has exceeded.
    pub exceeded: Option<Duration>,
    triangles: u64,
    /// The time that it has worked, but for the phase that runs.
    spent: Duration,
    since: Instant,
    patience: Duration,
}

/// Returns the time in which any scan of so many bytes can be read, many times over.
pub fn patience_to_read(bytes: u64) -> Duration {
    Duration::from_secs(600 + (bytes >> 20))
}

impl Running {
    /// Takes a process that has just begun.
    pub fn new(todo: Todo, process: Process, reserved: u64, patience: Duration) -> Self {
        let start = Instant::now();
        Self {
            todo,
            process,
            phase: Phase::Reading,
            start,
            reserved,
            forecast: None,
            peak: None,
            address: None,
            stage: "start".into(),
            outcome: None,
            exceeded: None,
            triangles: 0,
            spent: Duration::ZERO,
            since: start,
            patience,
        }
    }

    /// Takes the forecast; the time that it waits for memory does not count.
    pub fn wait_for_memory(&mut self, forecast: u64, triangles: u64) {
        self.spent += self.since.elapsed();
        self.phase = Phase::Waiting;
        self.forecast = Some(forecast);
        self.triangles = triangles;
    }

    /// Takes what the process tells.
    pub fn hear(&mut self, message: Message) {
        match message {
            Message::Address { address } => self.address = Some(address),
            Message::Stage { stage } => self.stage = stage,
            Message::Ended(outcome) => self.outcome = Some(*outcome),
            Message::Forecast { .. } => {}
        }
    }

    /// Returns the time in which any scan of its size can be baked, many times over: a bake of a million triangles takes
    /// about ten seconds on one core.
    pub fn patience_to_work(&self) -> Duration {
        let searching = if self.todo.settings.searches() { 16 } else { 1 };
        let largest = ScanSize { detail_side: u32::MAX, ..ScanSize::default() };
        let texels = u64::from(self.todo.settings.asset.bake.sized(largest).size).pow(2) >> 20;
        let rays = u64::from(self.todo.settings.asset.bake.ao_rays.max(64)) / 64;
        Duration::from_secs(searching * (1200 + 180 * (self.triangles >> 20) + 60 * texels * rays))
    }

    /// Returns what is left of a limit on the whole.
    pub fn left_of(&self, limit: Duration) -> Duration {
        limit.saturating_sub(self.spent)
    }

    /// Lets it begin its work.
    pub fn go(&mut self, threads: usize, reserved: u64, patience: Duration) {
        (self.phase, self.reserved, self.patience) = (Phase::Working, reserved, patience);
        self.since = Instant::now();
        self.process.go(threads);
    }

    /// Looks at its memory and its time; ends it where that is over.
    pub fn look(&mut self) {
        self.peak = self.peak.max(peak_of(self.process.id()));
        let is_late = self.phase != Phase::Waiting && self.since.elapsed() > self.patience;
        if is_late && self.exceeded.is_none() {
            self.exceeded = Some(self.spent + self.patience);
            self.process.kill();
        }
    }

    /// Ends it, and returns what is to be done again.
    pub fn give_up(self) -> Todo {
        let Self { todo, process, .. } = self;
        process.end();
        todo
    }

    /// Ends it.
    pub fn end(self) {
        self.process.end();
    }
}
