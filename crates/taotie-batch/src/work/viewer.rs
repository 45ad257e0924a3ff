//! The page that shows an asset in a browser.

use super::{Target, Work};
use std::path::Path;
use taotie::Result;
use taotie::asset::Limits;
use taotie::film::Development;
use taotie::render::{Prepared, RenderSettings};
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};
use taotie_report::viewer::{self, Subject, Viewer};

/// Writes the page of a model.
///
/// # Errors
/// Those of reading and of writing.
pub fn page(model: &Path, (path, files): Target<'_>, work: &Work<'_>) -> Result<()> {
    let limits = Limits { memory: work.limit(), ..Limits::default() };
    let name = model.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let loaded = studio::load_within(model, &MaterialOptions::default(), &limits)?;
    let facts = viewer::facts(&loaded, &name);
    let settings = RenderSettings::default();
    let prepared = Prepared::new(loaded.scene, &settings.surface)?;
    let framing = Framing { size: [1024; 2], all_around: false };
    let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, prepared.scene())?;
    let view = viewpoint.at(0.0);
    let viewer = Viewer::new(&Subject {
        title: &work.stem(),
        facts: &facts,
        bookmarks: &[],
        prepared: &prepared,
        settings: &settings,
        camera: &view.camera(),
        lighting: &LightOptions::default().lighting(None, prepared.scene(), view),
        development: &Development::default(),
        scan: None,
        errors: None,
    })?;
    files.write_text(path, &viewer.html())
}
