//! The page that shows an asset in a browser.

use super::context::{Target, Work};
use std::path::Path;
use taotie::asset::Limits;
use taotie_engine::Result;
use taotie_report::viewer::AssetSubject;

/// Writes the page of a model.
///
/// # Errors
/// Read and write errors.
pub fn page(model: &Path, (path, files): Target<'_>, work: &Work<'_>) -> Result<()> {
    let limits = Limits { memory: work.limit(), ..Limits::default() };
    let subject = AssetSubject { path: model, title: &work.stem(), limits: &limits, errors: None };
    let (page, _) = subject.page(&|viewer| viewer.html())?;
    files.write_text(path, &page)
}
