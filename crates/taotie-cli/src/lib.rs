//! The `taotie` command as a library: [`run`] is all that a `main`, in Rust or elsewhere, has to call.
//!
//! Exit codes: 0 fine, 1 difference above the threshold asked for, 2 error, 130 interrupted. Results go to stdout, talk to stderr; a
//! closed pipe is no error.

mod bake;
mod compare;
mod console;
mod demo;
mod diff;
mod inspect;
mod materials;
mod normals;
mod options;
mod render;
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
    /// Renders a model by several surface methods and measures how they differ.
    Compare(Box<compare::CompareArgs>),
    /// Bakes a scan's relief onto a light mesh and proves that it looks the same.
    Bake(Box<bake::BakeArgs>),
    /// Says what is in a model and what is wrong with it.
    Inspect(inspect::InspectArgs),
    /// Makes normal maps from heights, and converts them.
    Normals(Box<normals::NormalsArgs>),
    /// Says how two pictures or normal maps differ.
    Diff(diff::DiffArgs),
    /// Lists the materials that `--material` knows.
    Materials(materials::MaterialsArgs),
    /// Renders the built-in bronze jue by every method and model, and measures them.
    Demo(demo::DemoArgs),
}

/// How a run without an error ended.
enum Outcome {
    /// As wanted.
    Fine,
    /// A difference was above the threshold asked for.
    Different,
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
        Command::Render(args) => render::run(&args).map(|()| Outcome::Fine),
        Command::Compare(args) => compare::run(&args).map(|()| Outcome::Fine),
        Command::Bake(args) => bake::run(&args),
        Command::Inspect(args) => inspect::run(&args).map(|()| Outcome::Fine),
        Command::Normals(args) => normals::run(&args).map(|()| Outcome::Fine),
        Command::Diff(args) => diff::run(&args),
        Command::Materials(args) => materials::run(&args).map(|()| Outcome::Fine),
        Command::Demo(args) => demo::run(&args).map(|()| Outcome::Fine),
    };
    match result {
        Ok(Outcome::Fine) => ExitCode::SUCCESS,
        Ok(Outcome::Different) => ExitCode::from(1),
        Err(error) if console::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) if console::is_cancelled(&error) => {
            console::say("taotie: interrupted; no file is left");
            ExitCode::from(130)
        }
        Err(error) => {
            console::say(&format!("taotie: error: {}", console::causes(&error)));
            ExitCode::from(2)
        }
    }
}
