//! A model and its initial view.

use super::{Bookmark, MeasuredErrors, ScanSubject};
use crate::Fact;
use taotie_engine::film::Development;
use taotie_engine::length::Unit;
use taotie_engine::render::{Lighting, Prepared, RenderSettings};
use taotie_engine::scene::Camera;

/// A model and its initial view.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The heading and window title.
    pub title: &'a str,
    /// Source and rights, as shown on the page.
    pub facts: &'a [Fact],
    /// The unit of the coordinates of the model, `scan` and `errors`: metres, or unknown. See
    /// [`taotie::asset::model_unit`].
    pub unit: Option<Unit>,
    /// Views that the page offers.
    pub bookmarks: &'a [Bookmark],
    /// The model.
    pub prepared: &'a Prepared,
    /// The initial reflectance model and surface method, and all settings that affect shaders. The size is ignored.
    pub settings: &'a RenderSettings,
    /// The camera.
    pub camera: &'a Camera,
    /// The light.
    pub lighting: &'a Lighting,
    /// Exposure, tone curve and background.
    pub development: &'a Development,
    /// The scan that the model is measured against.
    pub scan: Option<ScanSubject<'a>>,
    /// The model's errors, if already known; ignored if `scan` is present.
    pub errors: Option<MeasuredErrors<'a>>,
}
