//! The limit of what a run may allocate.

use cap::Cap;
use std::alloc::System;

/// Counts what Rust code allocates; beyond its limit there is no memory, as on a machine that has no more.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// The address space of the process beyond twice the limit: code in C++ and the stacks of threads are not counted by the
/// allocator, and the system's own allocator keeps space in reserve for each thread.
#[cfg(target_os = "linux")]
const RESERVE: u64 = 8 << 30;

/// Lets what follows allocate so many bytes more than are taken now; `usize::MAX` is no limit.
pub fn allow(bytes: usize) {
    // Fails only below what is allocated already.
    let _ = ALLOCATOR.set_limit(ALLOCATOR.allocated().saturating_add(bytes));
}

/// Bounds the process as a whole, where the system knows how.
///
/// # Errors
/// Where the system refuses.
#[cfg(target_os = "linux")]
pub fn bound_process(bytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let most = Some(bytes.saturating_mul(2).saturating_add(RESERVE));
    Ok(setrlimit(Resource::As, Rlimit { current: most, maximum: most })?)
}

/// Bounds the process as a whole, where the system knows how.
///
/// # Errors
/// None here.
#[cfg(not(target_os = "linux"))]
pub fn bound_process(_bytes: u64) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other tests allocate beside this one, so the limit is far above what they take.
    #[test]
    fn beyond_the_limit_there_is_no_memory() {
        allow(256 << 20);
        assert!(Vec::<u8>::new().try_reserve_exact(512 << 20).is_err());
        let _ = ALLOCATOR.set_limit(usize::MAX);
        assert!(Vec::<u8>::new().try_reserve_exact(512 << 20).is_ok());
    }
}
