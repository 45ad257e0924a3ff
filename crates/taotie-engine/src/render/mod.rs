//! Rendering: combines hits and shading, and turns a scene, a camera and lights into an image.
//!
//! [`Prepared`] contains everything that does not depend on the camera: world-space vertices, tangents, the tree of
//! triangles. A [`Pass`] is one image of it, which [`Renderer`] renders in the memory of the previous one. Tiles are
//! independent; in a tile, every sample passes through the same stages: visibility, fragments (interpolation and
//! textures), normals, shadows, lighting, and resolve into the tile.

mod background;
mod batch;
mod camera;
mod draw;
mod fragments;
mod frame;
mod interpolate;
mod lighting;
mod lookups;
mod memory;
mod prepare;
mod reference;
mod renderer;
mod settings;
mod stages;
mod surface_point;
mod tangents;
mod tree;
mod visibility;

pub use background::{fill_backdrop, fill_ground};
pub use batch::Batch;
pub use camera::Eye;
pub use draw::Surface;
pub use frame::{Aovs, Frame};
#[doc(hidden)]
pub use memory::{HeldPixels, framing_bytes, image_bytes, pixel_bytes, scene_bytes};
pub use prepare::{PRINTED_BUMP, Prepared, foreseen_warnings};
pub use reference::{EnvironmentSampling, NormalMapping, ReferenceSettings, reference};
pub use renderer::{Pass, Renderer, render};
pub use settings::{
    CheckedShot, EnvironmentLight, GrazingNormals, Lighting, RenderSettings, Shot, SurfaceSettings,
};
pub use tangents::bind_tangents;
#[doc(hidden)]
pub use {
    stages::Stages,
    visibility::{VisibleBatch, VisibleSpan, batches},
};
