//! `docs/errors.md`: the error of each approximation compared with the reference integrator or with exact integrals.

mod energy;
mod relief;
mod split_sum;

use crate::computed;
use crate::generated::Generated;
use anyhow::Result;
use split_sum::Sky;
use std::path::Path;

const PAGE: &str = "docs/errors.md";

/// Returns the page with its tables updated, below the repository's `root`. The table of environments from files is
/// updated only if their folder is given.
///
/// # Errors
/// If the page or an environment cannot be read.
pub fn generated(root: &Path, environments: Option<&Path>) -> Result<Generated> {
    let kept = std::fs::read_to_string(root.join(PAGE)).unwrap_or_default();
    let studio = split_sum::table(&[Sky::studio()?])?;
    let files = match environments {
        Some(folder) => split_sum::table(&Sky::all_in(folder)?)?,
        None => computed::part(&kept, "split-sum-files").unwrap_or_default(),
    };
    let (energy, relief) = (energy::table(), relief::table()?);
    computed::page(root, PAGE, |name| match name {
        "split-sum" => Some(studio.clone()),
        "split-sum-files" => Some(files.clone()),
        "energy" => Some(energy.clone()),
        "relief" => Some(relief.clone()),
        _ => None,
    })
}
