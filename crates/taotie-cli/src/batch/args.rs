//! The options of `taotie batch`.

use crate::options;
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;
use taotie::asset::Bytes;
use taotie_batch::{DriveOptions, Shard, duration};

const EXAMPLES: &str = "\
Examples:
  taotie batch collection.toml
  taotie batch collection.toml --retry-failed --time-limit 30m
  taotie batch collection.toml --shard 3/8
  taotie batch collection.toml --check --proofs 5

collection.toml specifies the scans and what to make from them: docs/collections.md. Finished assets are not made \
again, so an interrupted run continues where it stopped. Exit codes: 0 all done, 1 a requirement is not met, 2 an \
asset failed or was refused.";

/// Bakes a whole collection: each scan in its own process, and nothing twice.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct BatchArgs {
    /// The collection's file
    pub collection: PathBuf,

    /// Retry assets that failed or were refused before
    #[arg(long, help_heading = "Work")]
    pub retry_failed: bool,
    /// Do only the I-th of N parts, for job arrays on a cluster: each writes its own manifest
    #[arg(long, value_name = "I/N", value_parser = shard, help_heading = "Work")]
    pub shard: Option<Shard>,
    /// Bake nothing new: compare all written files with the manifest, and re-bake some assets
    #[arg(long, conflicts_with_all = ["retry_failed", "shard", "page_only", "jobs", "time_limit", "memory_limit"], help_heading = "Work")]
    pub check: bool,
    /// With --check: the number of assets to re-bake; their files must be identical bit for bit
    #[arg(long, value_name = "N", default_value_t = 2, requires = "check", help_heading = "Work")]
    pub proofs: usize,
    /// Bake nothing: write the collection's page with what is done
    #[arg(long, conflicts_with_all = ["retry_failed", "shard"], help_heading = "Work")]
    pub page_only: bool,

    /// Maximum number of concurrent processes; fewer run if memory is short [default: one per hardware thread]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Running")]
    pub jobs: Option<u32>,
    /// Maximum memory of all processes together, such as 16G [default: the machine's free memory]
    #[arg(long, value_name = "BYTES", value_parser = options::memory, help_heading = "Running")]
    pub memory_limit: Option<Bytes>,
    /// Maximum time per asset, such as 90s, 15m or 2h [default: many times the estimate from its size]
    #[arg(long, value_name = "TIME", value_parser = duration, help_heading = "Running")]
    pub time_limit: Option<Duration>,
    /// Also read files that a model references outside its own folder
    #[arg(long, help_heading = "Running")]
    pub allow_outside: bool,
    /// Print the outcome of the collection as JSON
    #[arg(long, help_heading = "Running")]
    pub json: bool,
}

fn shard(text: &str) -> Result<Shard, String> {
    text.parse().map_err(|error: taotie_engine::Error| error.to_string())
}

impl BatchArgs {
    /// Rejects invalid options, before any work is done.
    pub fn check(&self) -> Result<()> {
        match self.collection.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("toml") => Ok(()),
            _ => bail!("{}: expected a collection as a .toml file", self.collection.display()),
        }
    }

    /// Returns the options of the work.
    pub fn options(&self) -> DriveOptions {
        DriveOptions {
            jobs: self.jobs.map(|jobs| jobs as usize),
            memory: self.memory_limit,
            time_limit: self.time_limit,
            shard: self.shard,
            retry_failed: self.retry_failed,
            allow_outside: self.allow_outside,
        }
    }
}
