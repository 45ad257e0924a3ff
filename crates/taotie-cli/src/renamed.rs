//! Options of earlier versions: using one is an error that states its replacement.

use clap::builder::UnknownArgumentValueParser;
use clap::{Arg, Command};

/// Earlier options of `bake`, and what replaces each.
const OPTIONS_OF_BAKE: [(&str, &str); 6] = [
    ("for", "--preset"),
    ("webp", "--images webp"),
    ("webp-quality", "--images webp:QUALITY"),
    ("jpeg", "--images jpeg:QUALITY"),
    ("ktx2", "--images ktx2"),
    ("uastc-rdo", "--images ktx2:LAMBDA"),
];

/// Adds earlier options to the command, hidden from help and completions.
pub fn with_renamed_options(command: Command) -> Command {
    command
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
