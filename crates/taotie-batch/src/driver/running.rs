//! Assets with running processes: how long each may take, how it ended, and the memory that all may use together.

use super::plan::Todo;
use super::process::Process;
use crate::job::{Message, Outcome, peak_of};
use crate::settings::Task;
use std::process::ExitStatus;
use std::time::{Duration, Instant};
use taotie::Bytes;
use taotie::asset::{BakeOptions, ScanSize};

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
    peak: Option<u64>,
    /// The content address of what it makes.
    pub address: Option<String>,
    /// Its current stage.
    stage: String,
    /// Its final message.
    outcome: Option<Outcome>,
    /// The time limit that it has exceeded.
    exceeded: Option<Duration>,
    /// Triangles of the scan, or samples of the photographs.
    size: u64,
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
            size: 0,
            spent: Duration::ZERO,
            since: start,
            patience,
        }
    }

    /// Records the memory estimate; the time spent waiting for memory does not count.
    pub fn wait_for_memory(&mut self, forecast: u64, size: u64) {
        self.spent += self.since.elapsed();
        self.phase = Phase::Waiting;
        self.forecast = Some(forecast);
        self.size = size;
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

    /// Returns a generous time limit for its work, from its size.
    pub fn patience_to_work(&self) -> Duration {
        match &self.todo.settings.task {
            Task::Bake(asset) => patience_to_bake(&asset.bake, self.size),
            Task::Photometric(_) => patience_to_estimate(self.size),
        }
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

/// A bake of a million triangles takes about ten seconds on one core.
fn patience_to_bake(bake: &BakeOptions, triangles: u64) -> Duration {
    let searching = if bake.searches() { 16 } else { 1 };
    let largest = ScanSize { detail_side: u32::MAX, ..ScanSize::default() };
    let texels = u64::from(bake.sized(largest).size).pow(2) >> 20;
    let rays = u64::from(bake.ao_rays.max(64)) / 64;
    Duration::from_secs(searching * (1200 + 180 * (triangles >> 20) + 60 * texels * rays))
}

/// An estimate from a million samples takes about a second on one core.
fn patience_to_estimate(samples: u64) -> Duration {
    Duration::from_secs(1200 + 20 * (samples >> 20))
}

/// Waits for the end of a process that has closed its stdout; returns the outcome of its job.
pub fn outcome(ended: &mut Running) -> Outcome {
    let waited = ended.process.wait();
    let peak = ended.peak;
    let outcome = match (waited, ended.outcome.take()) {
        (Ok((status, _)), Some(outcome)) if status.success() => outcome,
        (Ok((status, said)), _) => Outcome::failed(sentence(ended, status, &said)),
        (Err(error), _) => Outcome::failed(format!("lost its process: {error}")),
    };
    Outcome { peak_bytes: outcome.peak_bytes.max(peak), ..outcome }
}

/// Returns the outcome of a job whose process could not be started.
pub fn without_process(error: &std::io::Error, todo: &Todo) -> Outcome {
    Outcome::failed(format!("{}: could not start its process: {error}", todo.scan.id))
}

/// Describes how a process ended before its job was done.
fn sentence(ended: &Running, status: ExitStatus, said: &str) -> String {
    let stage = &ended.stage;
    if let Some(limit) = ended.exceeded {
        let seconds = limit.as_secs_f64();
        return format!(
            "took longer than {seconds:.0} s, stopped in stage `{stage}`; raise --time-limit, or ask for less"
        );
    }
    if said.contains("memory allocation of") {
        let estimate = ended.forecast.map_or("not known yet".into(), |bytes| Bytes(bytes).to_string());
        return format!(
            "ran out of memory in stage `{stage}` (estimate: {estimate}); allow more memory, or ask for less"
        );
    }
    let how = match signal(status) {
        Some(9) => "was killed (signal 9), often a sign of low memory".to_owned(),
        Some(number) => format!("was killed by signal {number}"),
        None => match status.code() {
            Some(code) => format!("crashed with code {code}"),
            None => "crashed".to_owned(),
        },
    };
    let words = last_words(said);
    format!("its process {how} in stage `{stage}`{words}")
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}

/// Returns the last line of a process's stderr, without control characters.
fn last_words(said: &str) -> String {
    const MOST: usize = 300;
    let line = said.lines().rev().find(|line| !line.trim().is_empty() && !line.starts_with("note: "));
    let plain = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    line.map_or(String::new(), |line| {
        format!(": {}", line.trim().chars().take(MOST).map(plain).collect::<String>())
    })
}

/// The memory promised to processes, out of the total.
#[derive(Debug)]
pub struct Ledger {
    budget: u64,
    taken: u64,
}

/// Returns the memory for reading a scan until its estimate is known: that of a file of `bytes` bytes, unpacked, plus
/// the program itself.
pub fn memory_to_read(bytes: u64) -> u64 {
    const PROGRAM: u64 = 64 << 20;
    const UNPACKED: u64 = 6;
    bytes.saturating_mul(UNPACKED).saturating_add(PROGRAM)
}

impl Ledger {
    /// Creates a ledger; without a budget there is always room.
    pub fn new(budget: Option<Bytes>) -> Self {
        Self { budget: budget.map_or(u64::MAX, |bytes| bytes.0), taken: 0 }
    }

    /// Returns true if there is room for `want` bytes in place of the `held` bytes already promised.
    pub fn has_room(&self, want: u64, held: u64) -> bool {
        self.taken.saturating_sub(held).saturating_add(want) <= self.budget
    }

    /// Reserves memory.
    pub fn take(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_add(bytes);
    }

    /// Releases reserved memory.
    pub fn give_back(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_sub(bytes);
    }

    /// Returns how many processes of `each` bytes fit, at least one.
    pub fn holds(&self, each: u64) -> usize {
        usize::try_from(self.budget / each.max(1)).unwrap_or(usize::MAX).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_what_others_leave() {
        let mut ledger = Ledger::new(Some(Bytes(100)));
        ledger.take(60);
        assert!(ledger.has_room(40, 0) && !ledger.has_room(41, 0));
        assert!(ledger.has_room(70, 30), "a process's own share does not count against it");
        ledger.give_back(60);
        assert!(ledger.has_room(100, 0) && !ledger.has_room(101, 0));
        assert_eq!((ledger.holds(30), ledger.holds(1000), ledger.holds(0)), (3, 1, 100));
        assert!(Ledger::new(None).has_room(u64::MAX, 0));
    }
}
