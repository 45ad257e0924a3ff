//! A renderer that reuses its memory renders the same pictures as a new one.

use crate::scenes;
use std::sync::Arc;
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop8};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::render::{
    Aovs, Lighting, Prepared, ReferenceSettings, RenderSettings, Renderer, Shot, reference, render,
};
use taotie_engine::scene::Projection;

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

/// Positions that are projected back must land on the centres of their pixels.
#[test]
fn output_variables_are_at_the_centre_of_each_pixel() {
    let scene = Arc::new(scenes::panes());
    let camera = scenes::camera(20.0, 10.0, 4.0);
    let Projection::Perspective { fov_y, .. } = camera.projection else {
        panic!("the view is in perspective")
    };
    let lighting = Lighting::default();
    let (width, height) = (90.0, 60.0);
    let of = |samples: u32| settings(width as u32, height as u32, samples, true);
    let seen = |samples: u32| {
        let settings = of(samples);
        render(&scene, &Shot { camera: &camera, lighting: &lighting, settings: &settings })
            .unwrap()
            .aovs
            .unwrap()
    };
    let one = seen(1);
    let columns = camera.world_from_view.columns.map(|[x, y, z, _]| Vec3::new(x, y, z));
    let per_unit = height / 2.0 / scalar::tan(0.5 * fov_y);
    let mut hits = 0;
    for (i, [x, y, z, alpha]) in one.position.pixels().iter().enumerate().filter(|(_, p)| p[3] > 0.0) {
        let way = Vec3::new(*x, *y, *z).to_f64() - columns[3];
        let [right, up, back] = [0, 1, 2].map(|k| way.dot(columns[k]));
        let at = [width / 2.0 - right / back * per_unit, height / 2.0 + up / back * per_unit];
        let center = [(i % width as usize) as f64 + 0.5, (i / width as usize) as f64 + 0.5];
        assert!((0..2).all(|k| (at[k] - center[k]).abs() < 0.01), "{at:?} for {center:?}, {alpha}");
        hits += 1;
    }
    assert!(hits > 500, "{hits}");
    let same = |other: &Aovs, what: &str| {
        for ((name, a), (_, b)) in one.named().into_iter().zip(other.named()) {
            assert!(a.pixels() == b.pixels(), "{name} with {what}");
        }
    };
    same(&seen(4), "4 samples");
    same(&seen(16), "16 samples");
    let settings = of(4);
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let prepared = Prepared::new(scene.clone(), &settings.surface).unwrap();
    let paths = ReferenceSettings { spp: 1, ..ReferenceSettings::default() };
    let traced = reference(&prepared, &shot, &paths, Progress::SILENT).unwrap();
    same(&traced.aovs.unwrap(), "paths of light");
}
