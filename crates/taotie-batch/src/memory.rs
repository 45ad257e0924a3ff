//! The memory of processes: their limit and their peak.

use taotie::asset::Bytes;

/// Bytes that a process may take beyond twice its forecast: its program, the stacks of its threads, and what the system's
/// allocator holds in reserve for each.
const RESERVE: u64 = 512 << 20;

/// Bounds the memory of this process by twice what was foreseen: a forecast that is far too low ends the process, and not
/// the machine. Systems other than Linux set no bound.
///
/// # Errors
/// Where the system refuses.
#[cfg(target_os = "linux")]
pub fn bound_process(forecast: Bytes) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let wanted = forecast.0.saturating_mul(2).saturating_add(RESERVE);
    // What was set by others before holds too.
    let hard = getrlimit(Resource::Data).maximum;
    let most = Some(hard.map_or(wanted, |hard| hard.min(wanted)));
    Ok(setrlimit(Resource::Data, Rlimit { current: most, maximum: hard })?)
}

/// Bounds the memory of this process, where the system knows how.
///
/// # Errors
/// None here.
#[cfg(not(target_os = "linux"))]
pub fn bound_process(_: Bytes) -> std::io::Result<()> {
    let _ = RESERVE;
    Ok(())
}

/// Returns the most memory that a process has taken so far; `None` where the system does not tell.
pub fn peak_of(process: u32) -> Option<u64> {
    peak_in(&std::fs::read_to_string(format!("/proc/{process}/status")).ok()?)
}

/// Returns the most memory that this process has taken so far; `None` where the system does not tell.
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
