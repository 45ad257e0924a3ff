//! `taotie batch`: a whole collection.

mod args;
mod book;
mod check;
mod listener;
mod worker;

pub use args::BatchArgs;
pub use book::{BOOK, run as keep};
pub use worker::{WORKER, run as work};

use crate::{Outcome, console, stop};
use anyhow::Result;
use listener::Listener;
use serde_json::json;
use std::path::PathBuf;
use taotie_batch::{Collection, State, Summary, drive, write_page};

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// Runs the subcommand.
pub fn run(args: &BatchArgs) -> Result<Outcome> {
    args.check()?;
    let collection = Collection::read(&args.collection)?;
    if args.check {
        return check::run(args, &collection);
    }
    let summary = match args.page_only {
        true => None,
        false => Some(work_through(args, &collection)?),
    };
    // Shards do not know of one another: a later run without --shard writes the page.
    let pages = if args.shard.is_none() { write_page(&collection)? } else { Vec::new() };
    print(args, summary.as_ref(), &pages)?;
    Ok(summary.map_or(Outcome::Fine, |summary| outcome(&summary)))
}

fn work_through(args: &BatchArgs, collection: &Collection) -> Result<Summary> {
    let held = stop::hold();
    let mut listener = Listener::default();
    let summary = drive(collection, &args.options(), &worker::worker()?, &mut |event| {
        listener.hear(event);
        !stop::is_ending()
    });
    drop(listener);
    drop(held);
    let summary = summary?;
    console::say_warnings(&summary.warnings);
    Ok(summary)
}

fn outcome(summary: &Summary) -> Outcome {
    let has = |state: State| summary.states.contains_key(&state);
    match (has(State::Failed) || has(State::Refused), has(State::RequiredNotMet)) {
        (true, _) => Outcome::Failed,
        (false, true) => Outcome::Different,
        (false, false) => Outcome::Fine,
    }
}

/// Prints the outcome of the collection.
fn print(args: &BatchArgs, summary: Option<&Summary>, pages: &[PathBuf]) -> Result<()> {
    if args.json {
        let report = json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "collection": console::name_of(&args.collection),
            "states": summary.map(states_json),
            "attempts": summary.map(|summary| summary.attempts),
            "known": summary.map(|summary| summary.known),
            "files": pages.iter().map(|page| console::name_of(page)).collect::<Vec<_>>(),
            "warnings": summary.map(|summary| console::json_warnings(&summary.warnings)),
        });
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    if let Some(summary) = summary {
        let counted = State::ALL.iter().filter_map(|state| Some((state, summary.states.get(state)?)));
        let counts: Vec<String> = counted.map(|(state, count)| format!("{count} {}", state.name())).collect();
        console::result(&format!("{} ({} from earlier runs)", counts.join(", "), summary.known))?;
    }
    pages.first().map_or(Ok(()), |page| console::result(&page.display().to_string()))
}

fn states_json(summary: &Summary) -> serde_json::Value {
    let count = |state: State| (state.name().to_owned(), json!(summary.states.get(&state).unwrap_or(&0)));
    State::ALL.into_iter().map(count).collect::<serde_json::Map<_, _>>().into()
}
