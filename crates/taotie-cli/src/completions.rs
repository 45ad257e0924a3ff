//! `taotie completions`: shell completion scripts.

use crate::console;
use anyhow::Result;
use clap::Args;
use clap_complete::{Shell, generate};

const EXAMPLES: &str = "\
Examples:
  taotie completions bash > ~/.local/share/bash-completion/completions/taotie
  taotie completions zsh > ~/.zfunc/_taotie
  taotie completions fish > ~/.config/fish/completions/taotie.fish";

/// Prints a shell completion script for subcommands and options.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Runs the subcommand.
pub fn run(args: &CompletionsArgs) -> Result<()> {
    let (mut command, mut script) = (crate::command(), Vec::new());
    let name = command.get_name().to_owned();
    generate(args.shell, &mut command, name, &mut script);
    console::own_text(String::from_utf8(script)?.trim_end())
}
