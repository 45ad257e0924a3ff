//! Options for running that subcommands share: memory and files, threads, the SIMD level, the form of the output.

use crate::options;
use anyhow::{Context, Result};
use clap::Args;
use taotie::{Bytes, Limits};
use taotie_engine::math::SimdLevel;
use taotie_engine::progress::HAS_THREADS;

/// Memory, and the files that a model may reference.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct LimitArgs {
    #[command(flatten)]
    pub memory: MemoryArgs,
    /// Also read files that a model references outside its own folder
    #[arg(long)]
    pub allow_outside: bool,
}

impl LimitArgs {
    /// Returns the limits; memory defaults to what the machine has free.
    pub fn limits(&self) -> Limits {
        Limits { allow_outside: self.allow_outside, ..self.memory.limits() }
    }
}

/// Limits of commands whose files reference no others.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct MemoryArgs {
    /// Maximum memory to use, such as 4G [default: the machine's free memory]
    #[arg(long, value_name = "BYTES", value_parser = options::memory)]
    pub memory_limit: Option<Bytes>,
}

impl MemoryArgs {
    /// Returns the limits; memory defaults to what the machine has free.
    pub fn limits(&self) -> Limits {
        Limits { memory: self.memory_limit, ..Limits::default() }.or_free()
    }
}

/// Largest number of threads to start.
const MOST_THREADS: usize = if HAS_THREADS { 1024 } else { 1 };

/// Threads and output.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct RunArgs {
    /// Number of threads, 1 to 1024; results do not depend on it [default: all of the machine's]
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,
    /// Print a report as JSON
    #[arg(long)]
    pub json: bool,
}

impl RunArgs {
    /// Runs `work` on the requested number of threads.
    pub fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T> {
        in_pool(self.threads, work)
    }
}

/// Runs `work` on `threads` threads, in WebAssembly on the only one. By default, these are all of the machine's, or
/// fewer under a limit on the process's memory.
pub fn in_pool<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    if !HAS_THREADS {
        return Ok(work());
    }
    let count = threads.or_else(taotie_io::most_threads);
    let started = |count: usize| rayon::ThreadPoolBuilder::new().num_threads(count).build();
    let pool = match started(count.unwrap_or(0)) {
        // The system may allow fewer threads, by `ulimit -u` or a cgroup.
        Err(_) if threads.is_none() => started(1),
        pool => pool,
    };
    let pool = pool.with_context(|| {
        format!("the threads could not be started; use fewer with --threads{}", taotie_io::limits_note())
    })?;
    Ok(pool.install(work))
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("at least one thread is needed; leave it out for all of the machine's".into()),
        Ok(count) if count <= MOST_THREADS => Ok(count),
        Ok(_) => Err(format!("at most {MOST_THREADS} threads; leave it out for all of the machine's")),
        Err(_) => Err("expected a number of threads".into()),
    }
}

/// Threads, SIMD level and output.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct RunningArgs {
    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub run: RunArgs,
    /// SIMD level: auto, scalar, sse2, avx2, avx512, neon, simd128. Pixels do not depend on it
    #[arg(long, value_parser = options::named::<SimdLevel>, default_value = "auto")]
    pub simd: SimdLevel,
}

impl RunningArgs {
    /// Rejects invalid values, before any work is done.
    pub fn check(&self) -> Result<()> {
        self.simd.check()?;
        Ok(())
    }
}
