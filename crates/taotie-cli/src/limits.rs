//! Limits on memory and on the files that a model may reference: options that subcommands share.

use crate::options;
use clap::Args;
use taotie::asset::{Bytes, Limits};

/// Memory, and the files that a model may reference.
#[derive(Args)]
#[command(next_help_heading = "Running")]
pub struct LimitArgs {
    /// Maximum memory to use, such as 4G [default: the machine's free memory]
    #[arg(long, value_name = "BYTES", value_parser = options::memory)]
    pub memory_limit: Option<Bytes>,
    /// Also read files that a model references outside its own folder
    #[arg(long)]
    pub allow_outside: bool,
}

impl LimitArgs {
    /// Returns the limits; memory defaults to what the machine has free.
    pub fn limits(&self) -> Limits {
        let (memory, allow_outside) = (self.memory_limit, self.allow_outside);
        Limits { memory, allow_outside, ..Limits::default() }.or_free()
    }
}
