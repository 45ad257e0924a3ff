//! The heat map of where two files differ, with its scale below.

use super::args::DiffArgs;
use anyhow::Result;
use std::path::Path;
use taotie::comparison::diff::ImagePair;
use taotie_io::FileSet;
use taotie_report::heat_map::HeatMap;

/// Writes the heat map of the requested metric, otherwise of FLIP or the angle, as a file of a set.
pub fn write(set: &FileSet, args: &DiffArgs, path: &Path, pair: &ImagePair) -> Result<()> {
    let shown = pair.difference_map(&args.options())?;
    let top = args.heat_top.map_or(shown.top, |top| top as f32);
    let (title, unit) = (shown.title, shown.unit);
    let sheet = HeatMap { field: &shown.field, title, unit, map: shown.map, top }.with_scale();
    Ok(set.write_png(path, &sheet.png())?)
}
