//! An asset with a running process.

use super::process::Process;
use super::todo::Todo;
use crate::job::{Message, Outcome};
use crate::memory::peak_of;
use std::time::{Duration, Instant};
use taotie::asset::ScanSize;

/// The phase of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// It is reading the scan.
    Reading,
    /// It has estimated its memory, and is waiting for it.
    Waiting,
    /// It is baking.
    Working,
}

/// An asset with a running process.
pub struct Running {
    /// The asset.
    pub todo: Todo,
    /// The process.
    pub process: Process,
    /// Its phase.
    pub phase: Phase,
    /// When it started.
    pub start: Instant,
    /// The memory reserved for it.
    pub reserved: u64,
    /// Its own estimate of the memory it needs.
    pub forecast: Option<u64>,
    /// The highest memory use observed.
    pub peak: Option<u64>,
    /// The content address of what it makes.
    pub address: Option<String>,
    /// Its current stage.
    pub stage: String,
    /// Its final message.
    pub outcome: Option<Outcome>,
    /// The time limit that it has exceeded.
    pub exceeded: Option<Duration>,
    triangles: u64,
    /// The time it has worked, excluding the current phase.
    spent: Duration,
    since: Instant,
    patience: Duration,
}

/// Returns a generous time limit for reading a scan of `bytes` bytes.
pub fn patience_to_read(bytes: u64) -> Duration {
    Duration::from_secs(600 + (bytes >> 20))
}

impl Running {
    /// Creates the entry of a process that has just started.
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

    /// Records the memory estimate; the time spent waiting for memory does not count.
    pub fn wait_for_memory(&mut self, forecast: u64, triangles: u64) {
        self.spent += self.since.elapsed();
        self.phase = Phase::Waiting;
        self.forecast = Some(forecast);
        self.triangles = triangles;
    }

    /// Handles a message of the process.
    pub fn hear(&mut self, message: Message) {
        match message {
            Message::Address { address } => self.address = Some(address),
            Message::Stage { stage } => self.stage = stage,
            Message::Ended(outcome) => self.outcome = Some(*outcome),
            Message::Forecast { .. } => {}
        }
    }

    /// Returns a generous time limit for baking a scan of its size: a bake of a million triangles takes about ten
    /// seconds on one core.
    pub fn patience_to_work(&self) -> Duration {
        let searching = if self.todo.settings.searches() { 16 } else { 1 };
        let largest = ScanSize { detail_side: u32::MAX, ..ScanSize::default() };
        let texels = u64::from(self.todo.settings.asset.bake.sized(largest).size).pow(2) >> 20;
        let rays = u64::from(self.todo.settings.asset.bake.ao_rays.max(64)) / 64;
        Duration::from_secs(searching * (1200 + 180 * (self.triangles >> 20) + 60 * texels * rays))
    }

    /// Returns the time left of a limit on the whole work.
    pub fn left_of(&self, limit: Duration) -> Duration {
        limit.saturating_sub(self.spent)
    }

    /// Lets it begin baking.
    pub fn go(&mut self, threads: usize, reserved: u64, patience: Duration) {
        (self.phase, self.reserved, self.patience) = (Phase::Working, reserved, patience);
        self.since = Instant::now();
        self.process.go(threads);
    }

    /// Checks its memory and its time; kills it when the time is up.
    pub fn look(&mut self) {
        self.peak = self.peak.max(peak_of(self.process.id()));
        let is_late = self.phase != Phase::Waiting && self.since.elapsed() > self.patience;
        if is_late && self.exceeded.is_none() {
            self.exceeded = Some(self.spent + self.patience);
            self.process.kill();
        }
    }

    /// Ends it; returns the asset so that it can be made again.
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
