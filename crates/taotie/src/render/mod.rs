//! The one place where hits meet shading: a scene, a camera and lights become a picture.
//!
//! [`Prepared`] holds what does not change with the camera: world-space vertices, tangents, the BVH for shadows. A
//! [`Pass`] is one picture of it. Tiles are independent; in a tile every sample goes through the same stages:
//! visibility, fragments (interpolation and textures), normals, shadows, lighting, and resolve into the tile.

mod albedos;
mod backdrop;
mod batch;
mod corners;
mod follow;
mod footprint;
mod fragments;
mod frame;
mod geometry;
mod ground;
mod grouping;
mod interpolate;
mod layers;
mod lighting;
mod lookups;
mod normals;
mod pass;
mod point;
mod prepare;
mod rays;
mod reference;
mod renderer;
mod resolve;
mod settings;
mod shadows;
mod substance;
mod surround;
mod tiles;
mod view;

pub use batch::{BATCH, Batch};
pub use follow::bind_tangents;
pub use fragments::Key;
pub use frame::{Aovs, Frame};
pub use pass::Pass;
pub use prepare::Prepared;
pub use reference::{EnvironmentSampling, NormalMapping, ReferenceSettings, reference};
pub use renderer::Renderer;
pub use settings::{EnvironmentLight, GrazingNormals, Lighting, RenderSettings, SurfaceSettings};

use crate::error::Result;
use crate::progress::Progress;
use crate::scene::{Camera, Scene};

/// Prepares `scene` and takes one picture of it.
///
/// # Errors
/// As [`Prepared::new`] and [`Pass::new`].
pub fn render(
    scene: &Scene,
    camera: &Camera,
    lighting: &Lighting,
    settings: &RenderSettings,
) -> Result<Frame> {
    let prepared = Prepared::new(scene, &settings.surface)?;
    Pass::new(&prepared, camera, lighting, settings)?.render(Progress::SILENT)
}
