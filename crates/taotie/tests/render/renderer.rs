//! A renderer that keeps its memory takes the pictures that a new one would take.

use crate::scenes;
use std::sync::Arc;
use taotie::Progress;
use taotie::film::{Development, develop8};
use taotie::math::Vec3;
use taotie::render::{Lighting, RenderSettings, Renderer, Shot, render};

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
    // Other sizes, cameras, numbers of samples and lights, in both directions.
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
        let alone = render(&scene, &shot).unwrap();
        assert!(alone.color.pixels().iter().any(|pixel| pixel[3] > 0.0), "nothing is seen");
        let frame = renderer.render(&shot, Progress::SILENT).unwrap();
        assert!(frame.color.pixels() == alone.color.pixels());
        if let (Some(kept), Some(alone)) = (&frame.aovs, &alone.aovs) {
            for ((name, kept), (_, alone)) in kept.named().into_iter().zip(alone.named()) {
                assert!(kept.pixels() == alone.pixels(), "{name}");
            }
        }
        renderer.develop(&shot, &development, &mut codes, Progress::SILENT).unwrap();
        assert!(codes == develop8(&alone.color, &development).unwrap());
    }
}
