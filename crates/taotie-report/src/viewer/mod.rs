//! A model as one page that opens from disk: its geometry, its textures, the light on it, and the shaders that draw it
//! as `taotie render` does.
//!
//! The page's script is built from `viewer/` at the root of the repository. It draws with the texts of
//! `taotie_shader` and decides nothing about shading itself.

mod about;
mod asset;
mod asset_page;
mod blob;
mod bookmark;
mod camera;
mod data;
mod document;
mod halves;
mod iiif;
mod light;
mod scan;
mod shaders;
mod surfaces;
mod textures;

pub use about::facts;
pub use asset_page::{AssetSubject, MOST_TEXTURE_SIDE, most_page_bytes};
pub use bookmark::Bookmark;
pub use document::SCRIPT;
pub use scan::{MOST_TRIANGLES, MeasuredErrors, ScanSubject, scene_to_show};

use crate::{Fact, Page};
use blob::Blob;
use iiif::Outline;
use taotie::film::Development;
use taotie::length::Unit;
use taotie::render::{Lighting, Prepared, RenderSettings};
use taotie::scene::Camera;
use taotie::{Result, Warnings};

/// A model and how it is first seen.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The heading, and the name of the window.
    pub title: &'a str,
    /// Source and rights, as the page tells them.
    pub facts: &'a [Fact],
    /// The unit of the model's coordinates, and of `scan` and `errors`: the metre, or unknown. [`taotie::asset::model_unit`]
    /// returns it.
    pub unit: Option<Unit>,
    /// Views that the page offers.
    pub bookmarks: &'a [Bookmark],
    /// The model.
    pub prepared: &'a Prepared,
    /// The reflectance model and the surface method shown first, and all settings that shaders depend on. The size is not
    /// read.
    pub settings: &'a RenderSettings,
    /// The camera.
    pub camera: &'a Camera,
    /// The light.
    pub lighting: &'a Lighting,
    /// Exposure, tone curve and background.
    pub development: &'a Development,
    /// The scan that the model is measured against.
    pub scan: Option<ScanSubject<'a>>,
    /// The model's errors where they are known already; not read with `scan`.
    pub errors: Option<MeasuredErrors<'a>>,
}

/// A file beside the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageFile {
    /// Its name.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// A page that shows a model in a browser.
pub struct Viewer {
    outline: Outline,
    blobs: Vec<Blob>,
    /// Content that the page lacks or changes.
    pub warnings: Warnings,
}

impl Viewer {
    /// Makes the page of a model.
    ///
    /// # Errors
    /// [`taotie::Error`] where the model cannot be written as glTF, or is too large for that.
    pub fn new(subject: &Subject<'_>) -> Result<Self> {
        let mut warnings = Warnings::default();
        let (data, blobs) = data::data(subject, &mut warnings)?;
        let outline = data.outline();
        let blobs = std::iter::once(Blob::new("data", data.json())).chain(blobs).collect();
        Ok(Self { outline, blobs, warnings })
    }

    /// Returns the page as one HTML document, which fetches nothing.
    pub fn html(&self) -> String {
        document::alone(&self.outline.title, &self.blobs)
    }

    /// Returns a report whose first view is the model, as one HTML document, which fetches nothing.
    pub fn within(&self, page: &Page) -> String {
        document::within(page, &self.blobs)
    }

    /// Returns the page and the files that it fetches from beside it, `index.html` first; the model is `asset.glb`.
    pub fn files(&self) -> Vec<PageFile> {
        let page =
            PageFile { name: "index.html".into(), bytes: document::beside(&self.outline.title).into_bytes() };
        std::iter::once(page).chain(self.blobs.iter().map(Blob::file)).collect()
    }

    /// Returns the manifests that lie beside these files where they are published at `address`: `manifest.json` by version
    /// 4 of the IIIF Presentation API, `manifest-3.json` by version 3.
    pub fn manifests(&self, address: &str) -> [PageFile; 2] {
        iiif::manifests(&self.outline, address)
    }
}
