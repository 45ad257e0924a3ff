//! The patience with a silent worker: it counts the worker's own work, not the load of the machine.

use std::fmt;
use std::time::{Duration, Instant};

/// The patience with a sleeping worker, as a multiple of that with a working one.
const SLEEP: u32 = 30;

/// How long a worker may stay silent.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// The processor time that it may use meanwhile; on systems that do not report it, wall-clock time.
    pub processor: Duration,
    /// Wall-clock time, which ends a sleeping worker.
    pub clock: Duration,
}

impl Patience {
    /// Returns a patience of `processor` in processor time, and thirty times as much in wall-clock time.
    pub fn of(processor: Duration) -> Self {
        Self { processor, clock: processor.saturating_mul(SLEEP) }
    }
}

impl fmt::Display for Patience {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of processor time, or {:?} of wall-clock time", self.processor, self.clock)
    }
}

/// A period of silence of a process.
#[derive(Debug)]
pub struct Silence {
    process: u32,
    begin: Instant,
    /// The processor time that the process had used when the silence began.
    used: Option<Duration>,
}

impl Silence {
    /// Starts a period of silence now.
    pub fn of(process: u32) -> Self {
        Self { process, begin: Instant::now(), used: processor_time(process) }
    }

    /// Returns true if it is longer than `patience`.
    pub fn outlasts(&self, patience: Patience) -> bool {
        let elapsed = self.begin.elapsed();
        let used = self.used.zip(processor_time(self.process));
        let worked = used.map_or(elapsed, |(before, now)| now.saturating_sub(before));
        worked >= patience.processor || elapsed >= patience.clock
    }
}

/// Returns the processor time that all threads of a process have used, if the system reports it.
#[cfg(target_os = "linux")]
fn processor_time(process: u32) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let milliseconds = ticks(&stat)?.saturating_mul(1000);
    milliseconds.checked_div(rustix::param::clock_ticks_per_second()).map(Duration::from_millis)
}

/// Returns the processor time that all threads of a process have used, if the system reports it.
#[cfg(not(target_os = "linux"))]
fn processor_time(_process: u32) -> Option<Duration> {
    None
}

/// Returns the sum of `utime` and `stime`: fields 14 and 15 of a line of `/proc/PID/stat`, in clock ticks.
#[cfg(target_os = "linux")]
fn ticks(stat: &str) -> Option<u64> {
    // The second field is a name in parentheses, which may itself contain spaces and parentheses.
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut times = after_name.split_ascii_whitespace().skip(11).map(|field| field.parse::<u64>().ok());
    Some(times.next()?? + times.next()??)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_found_behind_any_name() {
        assert_eq!(ticks("7 (a) b) 1) R 1 2 3 4 -1 6 7 8 9 10 250 31 12 13 20 0"), Some(281));
        assert_eq!([ticks("7 (a) R 1 2"), ticks("")], [None, None]);
    }

    #[test]
    fn work_ends_patience_and_sleep_does_not() {
        let silence = Silence::of(std::process::id());
        let short = Duration::from_millis(50);
        std::thread::sleep(short);
        let patience = Patience { processor: Duration::from_secs(3600), clock: short };
        assert!(silence.outlasts(patience), "the clock ends it");
        assert!(!silence.outlasts(Patience { clock: Duration::from_secs(3600), ..patience }));
        let until = processor_time(silence.process).unwrap() + short;
        while processor_time(silence.process).unwrap() < until {}
        assert!(silence.outlasts(Patience { processor: short, clock: Duration::from_secs(3600) }));
    }
}
