//! `taotie compare`: one model by several methods, and a paper's tables recomputed.

mod paper;

use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  taotie compare --paper
  taotie compare --paper -o recomputed";

/// Recomputes the tables of the seed paper.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct CompareArgs {
    /// Recompute Tables 2 and 3 of Guo and Wang 2025 and say what follows from them
    #[arg(long, required = true)]
    pub paper: bool,
    /// Folder to write a page and the numbers to; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print a report as JSON
    #[arg(long)]
    pub json: bool,
}

/// Runs the subcommand.
pub fn run(args: &CompareArgs) -> Result<()> {
    paper::run(args.json, args.out.as_deref())
}
