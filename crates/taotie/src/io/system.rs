//! The free memory of the machine.

/// Returns the memory free for new work, bytes: the system's number, or what its limit on this group of processes leaves
/// where that is less; files that it keeps in memory go when others need it. `None` where the system does not say.
pub fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    // Where the system tells nothing, as without /proc, the limits of groups are not asked for: that panics.
    if system.total_memory() == 0 {
        return None;
    }
    let limits = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    let free = limits.map_or(system.available_memory(), |group| group.min(system.available_memory()));
    (free > 0).then_some(free)
}
