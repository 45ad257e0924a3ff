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

collection.toml says where scans lie and what is made of them: docs/collections.md. What is done already is not done again, so \
that a run which was cut off goes on where it was. Exit codes: 0 all is done, 1 a requirement is not met, 2 an asset failed or \
was refused.";

/// Bakes a whole collection: each scan in a process of its own, and nothing twice.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct BatchArgs {
    /// The collection's file
    pub collection: PathBuf,

    /// Attempt again what failed or was refused before
    #[arg(long, help_heading = "Work")]
    pub retry_failed: bool,
    /// Do the I-th of N parts alone, for arrays of jobs on a cluster: each writes a manifest of its own
    #[arg(long, value_name = "I/N", value_parser = shard, help_heading = "Work")]
    pub shard: Option<Shard>,
    /// Bake nothing: read all files that were written, hold them against the manifest, and bake some assets anew
    #[arg(long, conflicts_with_all = ["retry_failed", "shard", "page_only", "jobs", "time_limit", "memory_limit"], help_heading = "Work")]
    pub check: bool,
    /// With --check: the number of assets to bake anew, whose files must be the same to the bit
    #[arg(long, value_name = "N", default_value_t = 2, requires = "check", help_heading = "Work")]
    pub proofs: usize,
    /// Bake nothing: write the collection's page of what is done
    #[arg(long, conflicts_with_all = ["retry_failed", "shard"], help_heading = "Work")]
    pub page_only: bool,

    /// Most processes at once; one for each of the machine's threads if not given. Fewer run where memory is short
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Running")]
    pub jobs: Option<u32>,
    /// Most memory of all processes together, such as 16G; the machine's free memory if not given
    #[arg(long, value_name = "BYTES", value_parser = options::memory, help_heading = "Running")]
    pub memory_limit: Option<Bytes>,
    /// Longest time for an asset, such as 90s, 15m or 2h; many times what its size lets expect if not given
    #[arg(long, value_name = "TIME", value_parser = duration, help_heading = "Running")]
    pub time_limit: Option<Duration>,
    /// Read the files that a model names outside its own folder too
    #[arg(long, help_heading = "Running")]
    pub allow_outside: bool,
    /// Print what became of the collection as JSON
    #[arg(long, help_heading = "Running")]
    pub json: bool,
}

fn shard(text: &str) -> Result<Shard, String> {
    text.parse().map_err(|error: taotie::Error| error.to_string())
}

impl BatchArgs {
    /// Refuses what cannot be, before any work is done.
    pub fn check(&self) -> Result<()> {
        match self.collection.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("toml") => Ok(()),
            _ => bail!("{}: a collection is described by a .toml file", self.collection.display()),
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
