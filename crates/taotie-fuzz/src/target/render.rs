//! A small render.

use super::promises::{Held, either, error_is_told_well, limits};
use super::subject::Subject;
use fastrand::Rng;
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};
use taotie_engine::Result;
use taotie_engine::names::Named;
use taotie_engine::render::{Frame, RenderSettings, Shot};
use taotie_engine::scene::Scene;
use taotie_engine::shade::Shading;

/// Pixels along each side.
const SIDE: u32 = 16;

/// Renders the file with settings chosen by its variant.
pub fn render(subject: &Subject<'_>) -> Held {
    let loaded = match studio::load_within(subject.path, &MaterialOptions::default(), &limits()) {
        Ok(loaded) => loaded,
        Err(error) => return error_is_told_well(&error),
    };
    match frame(&loaded.scene, &settings(&mut Rng::with_seed(subject.variant))) {
        Ok(frame) if frame.color.pixels().as_flattened().iter().any(|v| v.is_nan()) => {
            Err("a NaN pixel".into())
        }
        rendered => either(rendered),
    }
}

/// Renders the scene in its own lighting.
fn frame(scene: &Scene, settings: &RenderSettings) -> Result<Frame> {
    let framing = Framing { size: [SIDE; 2], all_around: false };
    let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, scene)?;
    let view = viewpoint.at(0.0);
    let lighting = LightOptions::default().lighting(None, scene, view);
    taotie_engine::render::render(scene, &Shot { camera: &view.camera(), lighting: &lighting, settings })
}

/// Chooses settings.
fn settings(rng: &mut Rng) -> RenderSettings {
    let shading = rng.choice(Shading::NAMES).map_or(Shading::Ggx, |(_, shading)| *shading);
    RenderSettings {
        width: SIDE,
        height: SIDE,
        samples: if rng.bool() { 1 } else { 4 },
        shading: if rng.bool() { shading } else { Shading::Ggx },
        specular_aa: rng.bool(),
        shadows: rng.bool(),
        ground: rng.u8(..4) == 0,
        aovs: rng.bool(),
        ..RenderSettings::default()
    }
}
