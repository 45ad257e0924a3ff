//! Rendering: combines hits and shading, and turns a scene, a camera and lights into an image.
//!
//! [`Prepared`] contains everything that does not depend on the camera: world-space vertices, tangents, the tree of
//! triangles. A [`Pass`] is one image of it, which [`Renderer`] renders in the memory of the previous one. Tiles are
//! independent; in a tile, every sample passes through the same stages: visibility, fragments (interpolation and
//! textures), normals, shadows, lighting, and resolve into the tile.

mod albedos;
mod backdrop;
mod batch;
mod checked_shot;
mod columns;
mod corners;
mod draw;
mod environment_lookup;
mod follow;
mod footprint;
mod fragments;
mod frame;
mod geometry;
mod ground;
mod grouping;
mod interpolate;
mod lighting;
mod lookups;
mod memory;
mod normals;
mod pass;
mod placed;
mod point;
mod preparation;
mod prepare;
mod rays;
mod reference;
mod renderer;
mod resolve;
mod settings;
mod shadows;
mod stages;
mod surfaces;
mod tiles;
mod tree;
mod view;
mod visible;

pub use backdrop::fill_backdrop;
pub use batch::Batch;
pub use checked_shot::CheckedShot;
pub use follow::bind_tangents;
pub use frame::{Aovs, Frame};
pub use ground::fill_ground;
#[doc(hidden)]
pub use memory::{HeldPixels, framing_bytes, image_bytes, pixel_bytes, scene_bytes};
pub use pass::Pass;
pub use preparation::PRINTED_BUMP;
pub use prepare::Prepared;
pub(crate) use prepare::foreseen_warnings;
pub use reference::{EnvironmentSampling, NormalMapping, ReferenceSettings, reference};
pub use renderer::Renderer;
pub use settings::{EnvironmentLight, GrazingNormals, Lighting, RenderSettings, Shot, SurfaceSettings};
pub use surfaces::Surface;
pub use view::Eye;
#[doc(hidden)]
pub use {
    stages::Stages,
    visible::{VisibleBatch, VisibleSpan, batches},
};

use crate::error::Result;
use crate::progress::Progress;
use crate::scene::Scene;
use pass::FrameCache;
use prepare::{Parts, Ready};

/// Prepares `scene` and renders one image of it.
///
/// # Errors
/// As for [`Prepared::new`] and [`Pass::new`].
pub fn render(scene: &Scene, shot: &Shot<'_>) -> Result<Frame> {
    let parts = Parts::new(scene, &shot.settings.surface)?;
    Pass::with(FrameCache::default(), Ready { scene, parts: &parts }, shot)?.render(Progress::SILENT)
}
