//! The collection's page, and the same data as JSON.

use crate::collection::Collection;
use crate::manifest::History;
use crate::record::{ASSET, OUTDATED, PHOTOGRAPHS, Record, ShortFigures};
use crate::store::Store;
use std::path::PathBuf;
use taotie::asset::RequirementOutcome;
use taotie_engine::Result;
use taotie_io::FileSet;
use taotie_report::collection_page::{self, Entry, Gallery};

/// Writes `index.html`, `collection.json` and the IIIF manifest of a collection; returns their paths.
///
/// # Errors
/// Errors of the manifest and of the collection's sources, and write errors.
pub fn write_page(collection: &Collection) -> Result<Vec<PathBuf>> {
    let store = Store::new(collection.output());
    store.make()?;
    let mut history = History::read(store.root())?;
    let scans = collection.scans()?.scans;
    let entries = scans.iter().map(|scan| match history.last.remove(&scan.id) {
        Some(record) => entry(&record),
        None => waiting(&scan.id, scan.title.clone()),
    });
    let gallery = Gallery { title: collection.title(), assets: entries.collect() };
    let files = FileSet::new();
    let [page, json, iiif] =
        ["index.html", "collection.json", "iiif.json"].map(|name| store.root().join(name));
    files.write_text(&page, &collection_page::html(&gallery))?;
    files.write_text(&json, &collection_page::json(&gallery))?;
    files.write_text(&iiif, &collection_page::iiif(&gallery, collection.address().unwrap_or("")))?;
    files.commit()?;
    Ok(vec![page, json, iiif])
}

/// Returns the page's entry for an asset that has not been attempted yet.
fn waiting(id: &str, title: Option<String>) -> Entry {
    Entry { id: id.into(), title, state: "waiting".into(), ..Entry::default() }
}

fn entry(record: &Record) -> Entry {
    let figures = record.figures.clone().unwrap_or_default();
    let has = record.figures.is_some();
    let ShortFigures { triangles_in, bytes_in, bytes_out, hausdorff, missed, .. } = figures;
    let estimated = record.estimated.as_ref();
    let sizes = has.then_some([bytes_in, bytes_out]);
    let sizes = sizes.or_else(|| estimated.map(|of| [of.bytes_in, of.bytes_out]));
    let one = |kind: &str, ending: &str| link(record, kind, ending);
    let is_unmet = |met: &&RequirementOutcome| !met.met;
    let unmet = |met: &RequirementOutcome| format!("{} {}", met.name(), met.text());
    Entry {
        id: record.id.clone(),
        title: record.title.clone(),
        state: record.state.name().into(),
        error: record.error.clone(),
        unmet: record.required.iter().filter(is_unmet).map(unmet).collect(),
        warnings: warnings(record),
        thumbnail: one("thumbnail", ".webp"),
        turntable: one("turntable", ".png"),
        viewer: one("viewer", ".html"),
        report: one(ASSET, ".report.html").or_else(|| one(PHOTOGRAPHS, "report.html")),
        model: one(ASSET, ".glb").or_else(|| one(PHOTOGRAPHS, "relief.glb")),
        photographs: estimated.map(|of| of.photographs),
        sigma: estimated.and_then(|of| of.sigma_median),
        p95_sigma: estimated.and_then(|of| of.sigma_p95),
        triangles_in: has.then_some(triangles_in),
        triangles: figures.triangles.first().copied(),
        bytes_in: sizes.map(|[input, _]| input),
        bytes_out: sizes.map(|[_, output]| output),
        mean_angle: figures.mean_angle,
        p95_angle: figures.p95_angle,
        max_angle: figures.max_angle,
        mean_color: figures.mean_color,
        hausdorff: has.then_some(hausdorff),
        missed: has.then_some(missed),
        seconds: Some(record.seconds),
        peak_bytes: record.peak_bytes,
    }
}

/// Returns the warnings of a record; first, if so, that its verdict is out of date.
fn warnings(record: &Record) -> Vec<String> {
    let outdated = (!record.is_current()).then(|| OUTDATED.to_owned());
    outdated.into_iter().chain(record.warnings.iter().map(ToString::to_string)).collect()
}

/// Returns the URL of a file, relative to the page.
fn link(record: &Record, kind: &str, ending: &str) -> Option<String> {
    let part = record.part(kind)?;
    let file = part.files.iter().find(|file| file.name.ends_with(ending))?;
    Some(format!("{}/{}", Store::folder(&part.address), escaped(&file.name)))
}

/// Returns a name percent-encoded for URLs.
fn escaped(name: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    let letter =
        |byte: u8| if is_plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
    name.bytes().map(letter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_addresses() {
        assert_eq!(escaped("a b#1%.glb"), "a%20b%231%25.glb");
        assert_eq!(escaped("爵.glb"), "%E7%88%B5.glb");
    }
}
