//! Generates files that are committed to the repository, and checks that they are up to date:
//! `cargo run -p xtask -- <task>`.
//!
//! Exit codes: 0 success, 1 a checked file is stale, 2 error.

mod as_printed;
mod asset_table;
mod computed;
mod dependencies;
mod errors;
mod generated;
mod help_pages;
mod schemas;
mod shader_errors;
mod shaders;
mod tables;

use anyhow::Result;
use asset_table::AssetTableArgs;
use clap::{Parser, Subcommand};
use generated::Generated;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Writes or checks generated files.
#[derive(Parser)]
#[command(name = "xtask", disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Generate the help pages in docs/help from the command-line definition.
    HelpPages {
        /// Write nothing; list the stale pages and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// Generate the computed tables and the pictures of docs/as-printed.md.
    AsPrinted {
        /// Write nothing; list the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// Generate the tables of docs/errors.md: each approximation against the reference.
    Errors {
        /// Write nothing; list the stale files and exit with 1.
        #[arg(long)]
        check: bool,
        /// Also update the table of environments with those in this folder.
        #[arg(long, value_name = "FOLDER")]
        environments: Option<PathBuf>,
    },
    /// Check that `deny.toml` allows every dependency; exit with 1 otherwise.
    Dependencies,
    /// Generate the tables of docs/security.md: crates with unsafe code or other languages, and fuzzing.
    Security {
        /// Write nothing; list the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// Generate the tables of directional albedos in crates/taotie-engine/src/shade/dfg.
    Tables {
        /// Write nothing; list the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// Generate the shaders in docs/shaders.
    Shaders {
        /// Write nothing; list the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// Generate the JSON Schemas in docs/schemas from the types that the command serialises.
    Schemas {
        /// Write nothing; list the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// Generate the table of docs/shaders.md: shaders at random points against the pixel program. Needs a Vulkan
    /// driver and Chromium; figures depend on their versions.
    ShaderErrors,
    /// Generate the table of docs/assets-table.md: all glTF models in some folders, baked by the command.
    AssetTable(AssetTableArgs),
}

fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            // A closed stderr is not an error.
            let _ = writeln!(io::stderr().lock(), "xtask: error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(cli: &Cli) -> Result<ExitCode> {
    match &cli.task {
        Task::HelpPages { check } => finish(&help_pages::generated(&root()), *check, "make docs"),
        Task::AsPrinted { check } => finish(&as_printed::generated(&root())?, *check, "make docs"),
        Task::Errors { check, environments } => {
            finish(&errors::generated(&root(), environments.as_deref())?, *check, "make errors")
        }
        Task::Dependencies => refuse(&dependencies::faults(&root())?),
        Task::Security { check } => finish(&dependencies::generated(&root())?, *check, "make security"),
        Task::Tables { check } => finish(&tables::generated(&root()), *check, "make tables"),
        Task::Shaders { check } => finish(&shaders::generated(&root())?, *check, "make shaders"),
        Task::Schemas { check } => finish(&schemas::generated(&root())?, *check, "make schemas"),
        Task::ShaderErrors => finish(&shader_errors::generated(&root())?, false, "make shader-errors"),
        Task::AssetTable(args) => bake_assets(args),
    }
}

/// Bakes the models, and prints their rows or updates the page.
fn bake_assets(args: &AssetTableArgs) -> Result<ExitCode> {
    let rows = asset_table::rows(args)?;
    let Some(text) = asset_table::printed(args, &rows)? else {
        return finish(&asset_table::generated(&root(), &rows)?, false, "make asset-table");
    };
    writeln!(io::stdout().lock(), "{text}")?;
    Ok(ExitCode::SUCCESS)
}

/// Returns the root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask is in the repository").to_path_buf()
}

/// Prints faults; fails if there are any.
fn refuse(faults: &[String]) -> Result<ExitCode> {
    let mut stderr = io::stderr().lock();
    faults.iter().try_for_each(|fault| writeln!(stderr, "{fault}"))?;
    Ok(ExitCode::from(u8::from(!faults.is_empty())))
}

/// Writes the stale files; with `check`, lists them and `remedy` instead.
fn finish(generated: &Generated, check: bool, remedy: &str) -> Result<ExitCode> {
    let stale = generated.stale()?;
    let mut stderr = io::stderr().lock();
    if check {
        for path in &stale {
            writeln!(stderr, "stale: {} (run `{remedy}`)", path.display())?;
        }
        return Ok(ExitCode::from(u8::from(!stale.is_empty())));
    }
    generated.write(&stale)?;
    for path in &stale {
        writeln!(stderr, "updated: {}", path.display())?;
    }
    Ok(ExitCode::SUCCESS)
}
