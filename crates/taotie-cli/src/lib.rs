//! The `taotie` command as a library: a `main`, in Rust or elsewhere, only has to call [`run`].
//!
//! Exit codes: 0 success, 1 a difference above the given threshold or a failed check, 2 error, 130 interrupted, 143
//! terminated. Results go to stdout, messages to stderr; a closed pipe is not an error.

mod bake;
mod batch;
mod compare;
mod completions;
mod console;
mod demo;
mod device;
mod diff;
mod inspect;
#[cfg(feature = "mcp")]
mod lines;
mod manual;
mod materials;
#[cfg(feature = "mcp")]
mod mcp;
mod normals;
mod options;
mod photometric;
mod proof_args;
mod render;
mod running;
mod shader;
mod stop;
mod studio;
mod verify;
mod view;

pub use photometric::Output as PhotometricFiles;

use clap::builder::UnknownArgumentValueParser;
use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// The allocator of static programs and of wheels for musl: musl's own allocator serialises threads.
#[cfg(target_env = "musl")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Bakes high-poly scans to low-poly glTF with normal maps, renders them, and measures the error.
#[derive(Parser)]
#[command(name = "taotie", version, max_term_width = 100, disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Print only results and errors: no progress, messages or warnings
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Print progress to stderr as JSON lines, for programs: stage, fraction done, seconds left if known
    #[arg(long, global = true)]
    progress: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Renders a model to a picture or an animation.
    Render(Box<render::RenderArgs>),
    /// Renders a model with several surface methods and measures their error.
    ///
    /// Pictures are compared over the pixels that show either surface, not the background.
    Compare(Box<compare::CompareArgs>),
    /// Bakes a high-poly scan to low-poly glTF with a normal map, and measures the error.
    Bake(Box<bake::BakeArgs>),
    /// Compares an asset, made with any program, with its scan.
    Verify(Box<verify::VerifyArgs>),
    /// Bakes the scans of a collection, and estimates normals from its photographs.
    Batch(Box<batch::BatchArgs>),
    /// Does the job given on stdin, for `taotie batch`.
    #[command(name = batch::WORKER, hide = true)]
    BatchWorker,
    /// Keeps the manifest of a collection whose processes are started by others.
    #[command(name = batch::BOOK, hide = true)]
    BatchBook(Box<batch::BatchArgs>),
    /// Lists the content of a model file and its defects.
    Inspect(inspect::InspectArgs),
    /// Makes normal maps from height maps, and converts normal maps.
    Normals(Box<normals::NormalsArgs>),
    /// Estimates normals from photographs, each with its uncertainty in degrees.
    Photometric(Box<photometric::PhotometricArgs>),
    /// Measures the difference of two pictures or normal maps.
    Diff(diff::DiffArgs),
    /// Writes the shaders of a model's materials, or of a plain one.
    Shader(Box<shader::ShaderArgs>),
    /// Writes a model as a single offline web page, or opens it in a browser.
    View(Box<view::ViewArgs>),
    /// Lists the material presets for `--material`.
    Materials(materials::MaterialsArgs),
    /// Renders the built-in bronze with every method and model, and measures the error.
    Demo(demo::DemoArgs),
    /// Serves AI assistants over the Model Context Protocol.
    #[cfg(feature = "mcp")]
    Mcp(mcp::McpArgs),
    /// Runs a command for `taotie mcp`.
    #[cfg(feature = "mcp")]
    #[command(name = mcp::WORKER, hide = true)]
    McpWorker(mcp::WorkerArgs),
    /// Prints a shell completion script for subcommands and options.
    Completions(completions::CompletionsArgs),
    /// Writes the manual pages of the command, for packages.
    #[command(hide = true)]
    ManPages(manual::ManPagesArgs),
}

/// The outcome of a run without an error.
enum Outcome {
    /// Success.
    Fine,
    /// A difference was above the given threshold, or a check failed.
    Different,
    /// Part of the work failed, and was reported.
    Failed,
}

/// Returns the definition of the command line, from which help pages are made.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command with its arguments, the program's name first.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(exit_code(args))
}

/// Like [`run`], but returns the exit code for the process.
pub fn exit_code(args: impl IntoIterator<Item = OsString>) -> u8 {
    let matches = with_renamed_options(Cli::command()).try_get_matches_from(with_help_last(args));
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => {
            // A closed pipe while help is printed is not an error.
            let _ = error.print();
            return if error.use_stderr() { 2 } else { 0 };
        }
    };
    console::set_quiet(cli.quiet);
    console::set_progress_lines(cli.progress);
    stop::listen();
    let result = match cli.command {
        Command::Render(args) => render::run(&args).map(|()| Outcome::Fine),
        Command::Compare(args) => compare::run(&args).map(|()| Outcome::Fine),
        Command::Bake(args) => bake::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Batch(args) => batch::run(&args),
        Command::BatchBook(args) => batch::keep(&args),
        Command::BatchWorker => batch::work().map(|()| Outcome::Fine),
        Command::Inspect(args) => inspect::run(&args),
        Command::Normals(args) => normals::run(&args).map(|()| Outcome::Fine),
        Command::Photometric(args) => photometric::run(&args).map(|()| Outcome::Fine),
        Command::Diff(args) => diff::run(&args),
        Command::Shader(args) => shader::run(&args).map(|()| Outcome::Fine),
        Command::View(args) => view::run(&args).map(|()| Outcome::Fine),
        Command::Materials(args) => materials::run(&args).map(|()| Outcome::Fine),
        Command::Demo(args) => demo::run(&args).map(|()| Outcome::Fine),
        #[cfg(feature = "mcp")]
        Command::Mcp(args) => mcp::run(&args),
        #[cfg(feature = "mcp")]
        Command::McpWorker(args) => mcp::work(&args),
        Command::Completions(args) => completions::run(&args).map(|()| Outcome::Fine),
        Command::ManPages(args) => manual::run(&args).map(|()| Outcome::Fine),
    };
    if stop::is_ending() {
        stop::wait();
    }
    match result {
        Ok(Outcome::Fine) => 0,
        Ok(Outcome::Different) => 1,
        Ok(Outcome::Failed) => 2,
        Err(error) if console::is_broken_pipe(&error) => 0,
        Err(error) => {
            console::complain(&format!("taotie: error: {}", console::causes(&error)));
            2
        }
    }
}

/// Returns the arguments with `help` as an option: `taotie help bake` is `taotie bake --help`.
fn with_help_last(args: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut args: Vec<OsString> = args.into_iter().collect();
    if args.get(1).is_some_and(|first| first == "help") {
        args.remove(1);
        args.push("--help".into());
    }
    args
}

/// Options of `bake` in earlier versions, and what replaces each: using one is an error that states its replacement.
const OPTIONS_OF_BAKE: [(&str, &str); 6] = [
    ("for", "--preset"),
    ("webp", "--images webp"),
    ("webp-quality", "--images webp:QUALITY"),
    ("jpeg", "--images jpeg:QUALITY"),
    ("ktx2", "--images ktx2"),
    ("uastc-rdo", "--images ktx2:LAMBDA"),
];

/// Adds earlier options to the command, hidden from help and completions. Negative numbers are values for every option, so
/// that errors state the accepted range.
fn with_renamed_options(command: clap::Command) -> clap::Command {
    command
        .mut_subcommands(|command| {
            command.mut_args(|arg| {
                match arg.get_action().takes_values() && !arg.is_allow_hyphen_values_set() {
                    true => arg.allow_negative_numbers(true),
                    false => arg,
                }
            })
        })
        .mut_subcommand("bake", |bake| bake.args(OPTIONS_OF_BAKE.iter().map(|(old, new)| renamed(old, new))))
}

fn renamed(old: &'static str, new: &str) -> Arg {
    // A flag has no value, so that the parser sees an empty one.
    Arg::new(old)
        .long(old)
        .hide(true)
        .value_name("VALUE")
        .num_args(0..=1)
        .default_missing_value("")
        .value_parser(UnknownArgumentValueParser::suggest(format!("use `{new}` instead")))
}
