//! `taotie demo`.

use anyhow::Result;
use clap::Args;

/// Renders the built-in bronze.
#[derive(Args)]
pub struct DemoArgs {}

/// Runs the subcommand.
pub fn run(_args: &DemoArgs) -> Result<()> {
    Ok(())
}
