//! `taotie batch --check`: compares the written files with the manifest.

use super::{BatchArgs, worker};
use crate::console::{self, Bar};
use crate::{Outcome, stop};
use anyhow::Result;
use serde_json::json;
use taotie_batch::{Audit, AuditOptions, Collection, Fault, audit};

/// Version of the JSON that `--check --json` prints.
const SCHEMA: u32 = 1;

/// Runs the audit.
pub fn run(args: &BatchArgs, collection: &Collection) -> Result<Outcome> {
    let held = stop::hold();
    let bar = Bar::new("check");
    let options = AuditOptions { proofs: args.proofs };
    let audit = audit(collection, &options, &worker::worker()?, &mut |fraction| {
        bar.set(fraction);
        !stop::is_ending()
    });
    drop(bar);
    drop(held);
    let audit = audit?;
    print(args, &audit)?;
    Ok(if audit.faults.is_empty() { Outcome::Fine } else { Outcome::Different })
}

fn print(args: &BatchArgs, audit: &Audit) -> Result<()> {
    let Audit { assets, files, proofs, faults } = audit;
    if args.json {
        let fault = |fault: &Fault| json!({ "id": fault.id, "what": fault.what });
        let report = json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "collection": console::name_of(&args.collection),
            "assets": assets,
            "files": files,
            "proofs": proofs,
            "faults": faults.iter().map(fault).collect::<Vec<_>>(),
        });
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    for Fault { id, what } in faults {
        console::result(&format!("{id}: {what}"))?;
    }
    let count = faults.len();
    console::result(&format!("{assets} assets: {files} files read, {proofs} re-baked, {count} faults"))
}
