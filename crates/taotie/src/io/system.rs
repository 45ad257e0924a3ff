//! The free memory of the machine.

/// Returns the memory available for new work, in bytes: the system's figure, or the rest of its limit on this process
/// group if that is less; file caches count as available. `None` if unknown.
pub fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    // If the system reports nothing, as without /proc, the limits of groups are not queried: that panics.
    if system.total_memory() == 0 {
        return None;
    }
    let limits = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    let free = limits.map_or(system.available_memory(), |group| group.min(system.available_memory()));
    (free > 0).then_some(free)
}
