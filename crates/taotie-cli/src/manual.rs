//! `taotie man-pages`: manual pages for packages, made from the definition of the command line.

use crate::{console, stop};
use anyhow::Result;
use clap::{Args, Command};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use std::path::PathBuf;

/// Writes the manual pages of the command and its subcommands.
#[derive(Args)]
pub struct ManPagesArgs {
    /// The folder to write to
    #[arg(value_name = "FOLDER")]
    pub output: PathBuf,
}

/// Runs the subcommand.
pub fn run(args: &ManPagesArgs) -> Result<()> {
    let files = stop::files();
    files.claim_folder(&args.output)?;
    let mut command = crate::command();
    // Passes the program name on to the subcommands.
    command.build();
    let version = command.render_version().trim_end().to_owned();
    let shown = command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set());
    let mut paths = Vec::new();
    for command in std::iter::once(&command).chain(shown) {
        let man = Man::new(command.clone()).source(&version);
        let path = args.output.join(man.get_filename());
        files.write_bytes(&path, &page(&man, command)?)?;
        paths.push(path);
    }
    files.commit()?;
    paths.iter().try_for_each(|path| console::result(&path.display().to_string()))
}

/// Returns a page in roff: the sections of `clap_mangen`, and the examples that open the help page.
fn page(man: &Man, command: &Command) -> Result<Vec<u8>> {
    let mut page = Vec::new();
    man.render(&mut page)?;
    let Some(examples) = command.get_before_help() else { return Ok(page) };
    let mut roff = Roff::new();
    roff.control("SH", ["EXAMPLES"]);
    for block in examples.to_string().trim_start_matches("Examples:\n").split("\n\n") {
        roff.control("PP", []);
        // Commands are indented; what follows them is text.
        if !block.starts_with(' ') {
            roff.text([roman(block.trim())]);
            continue;
        }
        roff.control("nf", []);
        for line in block.lines() {
            roff.text([roman(line)]);
        }
        roff.control("fi", []);
    }
    roff.to_writer(&mut page)?;
    Ok(page)
}
