//! A renderer that reuses its memory renders the same pictures as a new one.

use crate::scenes;
use std::sync::Arc;
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop8};
use taotie_engine::math::Vec3;
use taotie_engine::render::{Lighting, RenderSettings, Renderer, Shot, render};

fn settings(width: u32, height: u32, samples: u32, aovs: bool) -> RenderSettings {
    RenderSettings { width, height, samples, aovs, ..RenderSettings::default() }
}

#[test]
fn what_was_taken_before_changes_no_bit() {
    let scene = Arc::new(scenes::panes());
    let one = Lighting {
        lights: vec![scenes::directional(Vec3::new(0.5, -1.0, -0.4), 2.0)],
        ..Lighting::default()
    };
    let every = Lighting { lights: scenes::every_light(), ..one.clone() };
    // Different sizes, cameras, sample counts and lights, in both directions.
    let pictures = [
        (scenes::camera(20.0, 10.0, 4.0), &every, settings(150, 90, 4, true)),
        (scenes::camera(70.0, 35.0, 3.0), &one, settings(70, 130, 1, false)),
        (scenes::camera(20.0, 10.0, 4.0), &every, settings(150, 90, 4, true)),
    ];
    let development = Development::default();
    let mut renderer = Renderer::new(scene.clone(), &RenderSettings::default().surface).unwrap();
    let mut codes = Vec::new();
    for (camera, lighting, settings) in &pictures {
        let shot = Shot { camera, lighting, settings };
        let fresh = render(&scene, &shot).unwrap();
        assert!(fresh.color.pixels().iter().any(|pixel| pixel[3] > 0.0), "nothing is seen");
        let frame = renderer.render(&shot, Progress::SILENT).unwrap();
        assert!(frame.color.pixels() == fresh.color.pixels());
        if let (Some(kept), Some(fresh)) = (&frame.aovs, &fresh.aovs) {
            for ((name, kept), (_, fresh)) in kept.named().into_iter().zip(fresh.named()) {
                assert!(kept.pixels() == fresh.pixels(), "{name}");
            }
        }
        renderer.develop(&shot, &development, &mut codes, Progress::SILENT).unwrap();
        assert!(codes == develop8(&fresh.color, &development).unwrap());
    }
}
