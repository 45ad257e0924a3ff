//! The limit on what a run may allocate.

use cap::Cap;
use std::alloc::System;

/// Counts the allocations of Rust code; beyond the limit they fail, as on a machine without more memory.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// The address space of the process beyond twice the limit: the allocator does not count C++ code and thread stacks,
/// and the system's own allocator keeps reserves for each thread.
#[cfg(target_os = "linux")]
const RESERVE: u64 = 8 << 30;

/// Allows allocating up to `bytes` more than is allocated now; `usize::MAX` means no limit.
pub fn allow(bytes: usize) {
    // Fails only if the limit is below the current allocation.
    let _ = ALLOCATOR.set_limit(ALLOCATOR.allocated().saturating_add(bytes));
}

/// Limits the process as a whole, if the system supports it.
///
/// # Errors
/// If the system refuses.
#[cfg(target_os = "linux")]
pub fn bound_process(bytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let most = Some(bytes.saturating_mul(2).saturating_add(RESERVE));
    Ok(setrlimit(Resource::As, Rlimit { current: most, maximum: most })?)
}

/// Limits the process as a whole, if the system supports it.
///
/// # Errors
/// Never fails here.
#[cfg(not(target_os = "linux"))]
pub fn bound_process(_bytes: u64) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other tests allocate at the same time, so the limit is far above what they take.
    #[test]
    fn beyond_the_limit_there_is_no_memory() {
        allow(256 << 20);
        assert!(Vec::<u8>::new().try_reserve_exact(512 << 20).is_err());
        let _ = ALLOCATOR.set_limit(usize::MAX);
        assert!(Vec::<u8>::new().try_reserve_exact(512 << 20).is_ok());
    }
}
