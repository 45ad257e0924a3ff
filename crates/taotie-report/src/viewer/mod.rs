//! A model as one page that opens from disk: its geometry, textures and lighting, and the shaders that draw it like
//! `taotie render`.
//!
//! The page's script is built from `viewer/` at the root of the repository. It draws with shaders from
//! `taotie_shader` and makes no shading decisions itself.

mod asset_page;
mod data;
mod document;
mod folder;
mod iiif;
mod light;
mod model;
mod scan;
mod still;
mod surfaces;
mod views;

pub use asset_page::{AssetSubject, MOST_TEXTURE_SIDE, Staging, facts, most_page_bytes};
pub use data::Subject;
pub use document::{PageFile, SCRIPT};
pub use folder::FolderFiles;
pub use scan::{MOST_TRIANGLES, MeasuredErrors, ScanSubject, scene_to_show};
pub use views::Bookmark;

use crate::Page;
use document::Blob;
use taotie_engine::{Result, Warnings};
use views::Outline;

/// A page that shows a model in the browser.
pub struct Viewer {
    outline: Outline,
    blobs: Vec<Blob>,
    /// Warnings about content that the page omits or changes.
    pub warnings: Warnings,
}

impl Viewer {
    /// Creates the page for a model.
    ///
    /// # Errors
    /// [`taotie_engine::Error`] if the model cannot be written as glTF or is too large for it.
    pub fn new(subject: &Subject<'_>) -> Result<Self> {
        let mut warnings = Warnings::default();
        let (data, blobs) = data::data(subject, &mut warnings)?;
        let outline = data.outline();
        let data = Blob::new("data", data.json());
        let still = still::still(subject, &mut warnings);
        let blobs = std::iter::once(data).chain(blobs).chain(still).collect();
        Ok(Self { outline, blobs, warnings })
    }

    /// Returns the page as one HTML document that fetches nothing.
    pub fn html(&self) -> String {
        document::single_file(&self.outline.title, &self.blobs)
    }

    /// Returns a report with the model as its first view, as one HTML document that fetches nothing.
    pub fn within(&self, page: &Page) -> String {
        document::within(page, &self.blobs)
    }

    /// Returns the page, `index.html`, followed by the files next to it: the model is `asset.glb`, a still picture for
    /// browsers that cannot draw it `still.jpg`. To be published at `address`, they have manifests of the IIIF
    /// Presentation API: `manifest.json` for version 4, `manifest-3.json` for version 3. The page lists all of them for
    /// [`FolderFiles`].
    pub fn files(&self, address: Option<&str>) -> Vec<PageFile> {
        let manifests = address.into_iter().flat_map(|address| iiif::manifests(&self.outline, address));
        folder::with_page(&self.outline.title, self.blobs.iter().map(Blob::file).chain(manifests).collect())
    }
}
