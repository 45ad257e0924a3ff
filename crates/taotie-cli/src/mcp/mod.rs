//! `taotie mcp`: inspects, bakes, verifies and renders for AI assistants, over the Model Context Protocol on stdin and
//! stdout.

mod arguments;
mod child;
mod folders;
mod server;
mod tools;

pub use child::{WORKER, WorkerArgs, work};

use crate::Outcome;
use anyhow::{Context, Result};
use clap::Args;
use folders::Folders;
use rmcp::ServiceExt;
use rmcp::transport::io::stdio_pipes;
use server::Server;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  taotie mcp
  taotie mcp ~/scans ~/assets

A client starts this program and talks to it over stdin and stdout: docs/mcp.md shows how to register it.";

/// Serves AI assistants over the Model Context Protocol.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct McpArgs {
    /// The folders that tools may read and write. If the client declares roots, only files in both may be used
    /// [default: the client's roots, otherwise the current folder]
    #[arg(value_name = "FOLDER")]
    folders: Vec<PathBuf>,
}

/// Runs the subcommand.
pub fn run(args: &McpArgs) -> Result<Outcome> {
    let folders = Folders::of_command(&args.folders, Path::new("."))?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.context("cannot start the server")?.block_on(serve(Server::new(folders)))?;
    Ok(Outcome::Fine)
}

/// Answers requests until the client closes the connection.
async fn serve(server: Server) -> Result<()> {
    let running = server.serve(stdio_pipes()).await.context("no MCP client on stdin")?;
    running.waiting().await.context("the connection to the client failed")?;
    Ok(())
}
