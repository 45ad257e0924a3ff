//! Generators of files that are kept in the repository, and checks that they are fresh:
//! `cargo run -p xtask -- <task>`.
//!
//! Exit codes: 0 fine, 1 a checked file is stale, 2 error.

mod as_printed;
mod asset_table;
mod computed;
mod dependencies;
mod errors;
mod generated;
mod help_pages;
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

/// Writes or checks the files that are made from others.
#[derive(Parser)]
#[command(name = "xtask", disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// The pages in docs/help, from the definition of the command line.
    HelpPages {
        /// Write nothing; name the stale pages and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// The computed tables of docs/as-printed.md, and its pictures.
    AsPrinted {
        /// Write nothing; name the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// The tables of docs/errors.md: each approximation against the reference.
    Errors {
        /// Write nothing; name the stale files and exit with 1.
        #[arg(long)]
        check: bool,
        /// Also renew the table of environments, by those in this folder.
        #[arg(long, value_name = "FOLDER")]
        environments: Option<PathBuf>,
    },
    /// Whether `deny.toml` allows every dependency; exits with 1 where not.
    Dependencies,
    /// The tables of docs/security.md: crates that are not safe Rust alone, and what was fuzzed.
    Security {
        /// Write nothing; name the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// The tables of directional albedos in crates/taotie/src/shade/dfg.
    Tables {
        /// Write nothing; name the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// The shaders in docs/shaders.
    Shaders {
        /// Write nothing; name the stale files and exit with 1.
        #[arg(long)]
        check: bool,
    },
    /// The table of docs/shaders.md: shaders at random points against the pixel program. Needs a Vulkan driver and
    /// Chromium; other ones have other figures.
    ShaderErrors,
    /// The table of docs/assets-table.md: every glTF model below some folders, baked by the command.
    AssetTable(AssetTableArgs),
}

fn main() -> ExitCode {
    match run(&Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            // Nobody listening is no error.
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
        Task::ShaderErrors => finish(&shader_errors::generated(&root())?, false, "make shader-errors"),
        Task::AssetTable(args) => bake_assets(args),
    }
}

/// Bakes the models, and prints their rows or renews the page.
fn bake_assets(args: &AssetTableArgs) -> Result<ExitCode> {
    let rows = asset_table::rows(args)?;
    let Some(text) = asset_table::printed(args, &rows)? else {
        return finish(&asset_table::generated(&root(), &rows)?, false, "make asset-table");
    };
    writeln!(io::stdout().lock(), "{text}")?;
    Ok(ExitCode::SUCCESS)
}

/// The repository's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository").to_path_buf()
}

/// Names what is wrong.
fn refuse(faults: &[String]) -> Result<ExitCode> {
    let mut stderr = io::stderr().lock();
    faults.iter().try_for_each(|fault| writeln!(stderr, "{fault}"))?;
    Ok(ExitCode::from(u8::from(!faults.is_empty())))
}

/// Writes the stale files, or names them, and `remedy`, where `check` is set.
fn finish(generated: &Generated, check: bool, remedy: &str) -> Result<ExitCode> {
    let stale = generated.stale()?;
    let mut stderr = io::stderr().lock();
    if check {
        for path in &stale {
            writeln!(stderr, "stale: {} (`{remedy}` renews it)", path.display())?;
        }
        return Ok(ExitCode::from(u8::from(!stale.is_empty())));
    }
    generated.write(&stale)?;
    for path in &stale {
        writeln!(stderr, "renewed: {}", path.display())?;
    }
    Ok(ExitCode::SUCCESS)
}
