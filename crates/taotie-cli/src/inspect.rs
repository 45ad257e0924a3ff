//! `taotie inspect`: what is in a model and what is wrong with it.

use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Says what is in a model and what is wrong with it.
#[derive(Args)]
pub struct InspectArgs {
    /// The model
    pub model: PathBuf,
}

/// Runs the subcommand.
pub fn run(args: &InspectArgs) -> Result<()> {
    let loaded = taotie::io::load_model(&args.model)?;
    crate::console::say_warnings(&loaded.warnings);
    Ok(())
}
