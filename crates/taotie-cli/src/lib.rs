//! The `taotie` command as a library: [`run`] is all that a `main`, in Rust or elsewhere, has to call.
//!
//! Exit codes: 0 fine, 2 error. Results go to stdout, talk to stderr; a closed pipe is no error.

mod console;
mod demo;
mod inspect;
pub mod jue;
mod options;
mod render;
pub mod report;
mod sheet;
mod studio;

use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Puts a scan's relief on a light mesh and shades it by physics.
#[derive(Parser)]
#[command(name = "taotie", version, max_term_width = 100, disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Renders a model to a picture.
    Render(Box<render::RenderArgs>),
    /// Says what is in a model and what is wrong with it.
    Inspect(inspect::InspectArgs),
    /// Renders the built-in bronze jue by every surface method and shading model.
    Demo(demo::DemoArgs),
}

/// The definition of the command line, from which help pages are made.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command with its arguments, the program's name first.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => {
            // A closed pipe while help is printed is no error.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    let result = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Demo(args) => demo::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if console::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            console::say(&format!("taotie: error: {}", console::causes(&error)));
            ExitCode::from(2)
        }
    }
}
