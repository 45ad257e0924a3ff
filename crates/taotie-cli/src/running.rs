//! Threads and the form of the output: options that subcommands share.

use anyhow::{Context, Result};
use clap::Args;

/// Largest number of threads to start.
const MOST_THREADS: usize = 1024;

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
    /// Runs `work` on the requested number of threads, or on all of the machine's.
    pub fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads.unwrap_or(0))
            .build()
            .context("the threads could not be started; use fewer with --threads")?;
        Ok(pool.install(work))
    }
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("at least one thread is needed; leave it out for all of the machine's".into()),
        Ok(count) if count <= MOST_THREADS => Ok(count),
        Ok(_) => Err(format!("at most {MOST_THREADS} threads; leave it out for all of the machine's")),
        Err(_) => Err("expected a number of threads".into()),
    }
}
