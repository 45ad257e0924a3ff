//! The memory of processes: limit and peak.

use taotie::asset::Bytes;

/// Bytes that a process may use beyond twice its estimate: its program, the stacks of its threads, and the reserves
/// that the system's allocator keeps for each.
const RESERVE: u64 = 512 << 20;

/// Limits the memory of this process to twice its estimate plus [`RESERVE`], so that a far too low estimate ends the
/// process rather than the machine. On systems other than Linux there is no limit.
///
/// # Errors
/// System errors.
#[cfg(target_os = "linux")]
pub fn bound_process(forecast: Bytes) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let wanted = forecast.0.saturating_mul(2).saturating_add(RESERVE);
    // A limit that was already set still applies.
    let hard = getrlimit(Resource::Data).maximum;
    let most = Some(hard.map_or(wanted, |hard| hard.min(wanted)));
    Ok(setrlimit(Resource::Data, Rlimit { current: most, maximum: hard })?)
}

/// Limits the memory of this process, if the system supports it.
///
/// # Errors
/// Never fails here.
#[cfg(not(target_os = "linux"))]
pub fn bound_process(_: Bytes) -> std::io::Result<()> {
    let _ = RESERVE;
    Ok(())
}

/// Returns the peak memory of a process so far; `None` if the system does not report it.
pub fn peak_of(process: u32) -> Option<u64> {
    peak_in(&std::fs::read_to_string(format!("/proc/{process}/status")).ok()?)
}

/// Returns the peak memory of this process so far; `None` if the system does not report it.
pub fn own_peak() -> Option<u64> {
    peak_of(std::process::id())
}

fn peak_in(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kilobytes << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_of_what_the_system_says() {
        assert_eq!(peak_in("Name:\tx\nVmHWM:\t    2048 kB\nVmRSS:\t 1 kB\n"), Some(2 << 20));
        assert_eq!(peak_in("Name:\tx\n"), None);
        if cfg!(target_os = "linux") {
            assert!(own_peak().is_some_and(|bytes| bytes > 1 << 20));
        }
    }
}
