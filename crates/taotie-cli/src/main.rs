//! The `taotie` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    taotie_cli::run(std::env::args_os())
}
