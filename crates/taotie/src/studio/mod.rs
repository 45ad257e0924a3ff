//! The setting of a model: its materials, its lighting, its camera, and the images to take.
//!
//! Options are plain structs: `Default` with fields set by hand. Angles are radians and lengths model units.
//!
//! ```no_run
//! use taotie::render::{RenderSettings, Shot, render};
//! use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};
//!
//! # fn main() -> taotie::Result<()> {
//! let bronze = MaterialOptions { material: Some("bronze".into()), ..MaterialOptions::default() };
//! let scene = studio::load("vessel.glb".as_ref(), &bronze)?.scene;
//! let framing = Framing { size: [800, 600], all_around: false };
//! let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, &scene)?;
//! let view = viewpoint.at(0.0);
//! let lighting = LightOptions::default().lighting(None, &scene, view);
//! let settings = RenderSettings { width: 800, height: 600, ..RenderSettings::default() };
//! let frame = render(&scene, &Shot { camera: &view.camera(), lighting: &lighting, settings: &settings })?;
//! # Ok(())
//! # }
//! ```

mod change;
mod environment;
mod factors;
mod light_spec;
mod lights;
mod maps;
mod material;
mod material_file;
mod model;
mod motion;
mod parameters;
pub mod parse;
mod sequence;
mod viewpoint;

pub use environment::{EnvironmentOptions, EnvironmentSource};
pub use factors::MaterialFactors;
pub use light_spec::{LightForm, LightSpec};
pub use lights::LightOptions;
pub use maps::MapOptions;
pub use material::MaterialOptions;
pub use material_file::MaterialFile;
pub use model::{load, load_within};
pub use motion::Motion;
pub use parameters::{
    CameraParameters, FalloffParameters, LightKindParameters, LightParameters, ProjectionParameters,
};
pub use sequence::{Sequence, SequenceFrame};
pub use viewpoint::{CameraOptions, Framing, View, Viewpoint};
