//! What a run may take of the machine, and what a file may make it read: options that subcommands share.

use crate::options;
use clap::Args;
use taotie::asset::{Bytes, Limits};

/// Memory, and the files that a model may name.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct LimitArgs {
    /// Largest amount of memory to use, such as 4G; the machine's free memory if not given
    #[arg(long, value_name = "BYTES", value_parser = options::memory)]
    pub memory_limit: Option<Bytes>,
    /// Read the files that a model names outside its own folder too
    #[arg(long)]
    pub allow_outside: bool,
}

impl LimitArgs {
    /// Returns the limits, with what the machine has free where none is set.
    pub fn limits(&self) -> Limits {
        let (memory, allow_outside) = (self.memory_limit, self.allow_outside);
        Limits { memory, allow_outside, ..Limits::default() }.or_free()
    }
}
